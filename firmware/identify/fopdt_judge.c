#include "identify/fopdt_judge.h"

#include <stddef.h>

#include "identify/common.h"
#include "identify/response.h"

/* Least that a significant response explains, in variances of a point: 3 parameters, 0.1 %. */
#define SIGNIFICANT     REAL_C(16.0)
#define EXCESS          REAL_C(1.5) /* variance of 128 points, of noise alone: +- 0.13 */
#define CORRELATION_MAX REAL_C(0.9)
/* Standard deviation of ln T from which on a slow lag may as well be an integrator. */
#define LAG_UNSURE   REAL_C(0.4)
#define SETTLED_PART REAL_C(0.05) /* of the largest response, that may be left at the end */
#define SETTLED_LAGS REAL_C(4.0)  /* after which a level counts as reached */
#define DIP_PART     REAL_C(0.02) /* of the gain's response, the wrong way */
#define DIP_SDS      REAL_C(4.0)
#define SWING_PART   REAL_C(0.1)
#define SWING_SDS    REAL_C(10.0)

static real_t larger_of(real_t a, real_t b)
{
    return a > b ? a : b;
}

/* Sample count of the longest level; of a single step: to the end. */
static real_t longest_level(const struct fopdt_fit *f)
{
    uint32_t longest = 0, end = f->points * f->block;
    for (uint32_t j = 0; j < f->input.edges; j++) {
        uint32_t from = f->input.edge[j].sample;
        uint32_t to = j + 1 < f->input.edges ? f->input.edge[j + 1].sample : end;
        bool returned = j > 0 && j + 1 == f->input.edges;
        if (to > from && to - from > longest && !returned)
            longest = to - from;
    }
    return (real_t)longest;
}

/* Noise of a point by the median of second differences, which a drift does not enter, a response little, and the
 * corners of it not at all. Median by halving, largest to start from. */
static real_t rough_noise(const struct fopdt_fit *f)
{
    real_t lo = ZERO, hi = ZERO;
    for (uint32_t i = 1; i + 1 < f->points; i++)
        hi = larger_of(hi, real_abs(f->y[i - 1] - TWO * f->y[i] + f->y[i + 1]));
    for (int n = 0; n < 24; n++) {
        real_t middle = REAL_C(0.5) * (lo + hi);
        uint32_t below = 0;
        for (uint32_t i = 1; i + 1 < f->points; i++)
            below += real_abs(f->y[i - 1] - TWO * f->y[i] + f->y[i + 1]) <= middle;
        if (2 * below < f->points - 2)
            lo = middle;
        else
            hi = middle;
    }
    return hi / (REAL_C(0.6745) * REAL_C(2.449490)); /* of a normal variable; sqrt(1 + 4 + 1) */
}

/* Counts how often a curve turns by more than swing. */
static uint32_t turns(const real_t *curve, uint32_t points, real_t swing)
{
    real_t lowest = curve[0], highest = curve[0];
    int direction = 0;
    uint32_t n = 0;
    for (uint32_t i = 1; i < points; i++) {
        highest = larger_of(highest, curve[i]);
        lowest = curve[i] < lowest ? curve[i] : lowest;
        bool up = direction <= 0 && curve[i] - lowest > swing;
        bool down = direction >= 0 && highest - curve[i] > swing;
        if (up || down) {
            n += direction != 0;
            direction = up ? 1 : -1;
            lowest = highest = curve[i];
        }
    }
    return n;
}

/* Variance of a point, residuals' own or the noise that is known, whichever is larger; in *correlation how much they
 * hang together. Column 0 is the model. */
static real_t residual_variance(const struct fopdt_fit *f, real_t *correlation)
{
    real_t square = ZERO, product = ZERO, before = ZERO;
    for (uint32_t i = 0; i < f->points; i++) {
        real_t r = f->y[i] - f->gain * f->column[0][i];
        square += r * r;
        product += r * before;
        before = r;
    }
    uint32_t parameters = 3u + f->line.offset + f->line.slope + (f->bend.on ? f->bend.used : 0u);
    real_t own = f->squares / (real_t)(f->points - parameters);
    real_t known = f->baseline.noise_sd * f->baseline.noise_sd / (real_t)f->block;
    real_t rho = square > ZERO ? product / square : ZERO;
    *correlation = rho < ZERO ? ZERO : (rho > CORRELATION_MAX ? CORRELATION_MAX : rho);
    return larger_of(own, known);
}

/* Returns what the residuals have beyond the noise, be it known or read from the record itself, and beyond what their
 * own scatter may add. */
static real_t misfit(const struct fopdt_fit *f, real_t white, real_t rough)
{
    real_t known = f->baseline.noise_sd * f->baseline.noise_sd / (real_t)f->block;
    real_t beyond = white - EXCESS * larger_of(known, rough * rough);
    return beyond > ZERO ? real_sqrt(beyond) : ZERO;
}

/* A bend in other places may explain the record as well, with other gains: by so much they stray about the one found,
 * each weighted with its likelihood. */
static real_t variance_of_places(const struct fopdt_fit *f, real_t variance)
{
    real_t weights = ONE, sum = ZERO, least = f->squares;
    if (!f->bend.on || !(variance > ZERO))
        return ZERO;
    for (unsigned k = 0; k < FOPDT_FIT_PLACES; k++)
        least = f->place_squares[k] < least ? f->place_squares[k] : least;
    for (unsigned k = 0; k < FOPDT_FIT_PLACES; k++) {
        real_t worse = REAL_C(0.5) * (f->place_squares[k] - least) / variance;
        real_t weight = worse < REAL_C(30.0) ? real_exp(-worse) : ZERO;
        real_t apart = f->place_gain[k] - f->gain;
        weights += weight;
        sum += weight * apart * apart;
    }
    return sum / weights;
}

/* Covariance of K, ln T and L by the inverse of the normal equations, into K, T, L in seconds. */
static void covariance(struct fopdt_fit *f, real_t variance)
{
    struct fopdt_fit_result *r = &f->result;
    real_t a = f->normal[0], b = f->normal[1], c = f->normal[2], det = a * c - b * b;
    real_t tt = ZERO, tl = ZERO, ll = ZERO;
    bool lag = a > ZERO && f->lag > f->shortest, dead = c > ZERO && f->lag > f->shortest;
    if (lag && dead && det > REAL_C(1e-6) * a * c) {
        tt = c / det;
        tl = -b / det;
        ll = a / det;
    } else if (lag) {
        tt = ONE / a;
    }
    real_t k1 = f->along[0], k2 = f->along[1];
    real_t kk = k1 * k1 * tt + TWO * k1 * k2 * tl + k2 * k2 * ll;
    if (f->strength > ZERO)
        kk += ONE / f->strength;
    real_t t = f->lag * f->h_s; /* dT = T d ln T */
    r->covariance[0] = variance * kk + variance_of_places(f, variance);
    r->covariance[1] = -variance * (k1 * tt + k2 * tl) * t;
    r->covariance[2] = variance * tt * t * t;
    r->covariance[3] = -variance * (k1 * tl + k2 * ll) * f->h_s;
    r->covariance[4] = variance * tl * t * f->h_s;
    r->covariance[5] = variance * ll * f->h_s * f->h_s;
    r->element.gain_sd = real_sqrt(larger_of(r->covariance[0], ZERO));
    r->element.time_constant_sd_s = real_sqrt(larger_of(r->covariance[2], ZERO));
    r->element.dead_time_sd_s = real_sqrt(larger_of(r->covariance[5], ZERO));
}

/* Column 1: the model with its line; column 2: the response as measured, offset and drift taken off. */
static void response(struct fopdt_fit *f)
{
    real_t *raw = f->column[1], *seen = f->column[2], offset, slope;
    real_t part[2], change, step, more_offset, more_slope;
    response_model(&f->input, f->lag, f->dead, f->block, f->points, seen, NULL);
    for (uint32_t i = 0; i < f->points; i++)
        raw[i] = seen[i];
    seen[f->points] = seen[f->points + 1] = ZERO;
    fit_line_remove(&f->line, seen, &offset, &slope);
    fit_bend_remove(&f->bend, &f->line, seen, part);
    f->evaluations++;
    for (unsigned k = 0; k < 2; k++)
        part[k] = f->bend_part[k] - f->gain * part[k];
    fit_bend_explain(&f->bend, part, &change, &step, &more_offset, &more_slope);
    offset = f->line_offset - f->gain * offset + more_offset;
    slope = f->line_slope - f->gain * slope + more_slope;
    /* fit_line_time() of a point is (samples to its middle + 1/2)/(all samples) */
    real_t all = (real_t)(f->points * f->block);
    f->result.offset = f->baseline.offset + offset + REAL_C(0.5) * slope / all;
    f->result.slope_per_s = f->baseline.slope_per_s + slope / (all * f->h_s);
    f->result.bend_at_s = f->bend.on ? (real_t)(f->bend.point * f->block) * f->h_s : ZERO;
    f->result.bend_per_s = change / (all * f->h_s);
    f->result.bend_step = step;
    for (uint32_t i = 0; i < f->points; i++) {
        seen[i] = f->y[i] - f->gain * seen[i] + f->gain * raw[i];
        if (real_abs(seen[i]) > real_abs(f->result.moved))
            f->result.moved = seen[i];
    }
}

/* Does what the model leaves still climb in the last eighth? */
static bool climbs_at_end(const struct fopdt_fit *f, real_t sd, real_t peak)
{
    uint32_t n = f->points / 8 > 4 ? f->points / 8 : 4, from = f->points - n;
    real_t middle = REAL_C(0.5) * (real_t)(n - 1), cross = ZERO, spread = ZERO;
    for (uint32_t i = 0; i < n; i++) {
        real_t t = (real_t)i - middle;
        cross += t * (f->column[2][from + i] - f->gain * f->column[1][from + i]);
        spread += t * t;
    }
    real_t climb = real_abs(cross / spread) * (real_t)n;
    return climb > SETTLED_PART * peak && climb > REAL_C(4.0) * sd * (real_t)n / real_sqrt(spread);
}

static uint16_t shape_flags(const struct fopdt_fit *f, real_t sd, real_t rough)
{
    uint16_t flags = 0;
    const real_t *raw = f->column[1], *seen = f->column[2];
    real_t peak = ZERO, top = real_abs(f->gain) * excitation_peak(&f->input);
    for (uint32_t i = 0; i < f->points; i++)
        peak = larger_of(peak, real_abs(f->gain * raw[i]));
    real_t rest = real_abs(f->gain * (excitation_level(&f->input) - raw[f->points - 1]));
    if (rest > SETTLED_PART * peak || climbs_at_end(f, sd, peak))
        flags |= IDENTIFIED_NOT_SETTLED;

    /* The wrong way, before the time the model needs. */
    real_t sign = f->gain * f->input.edge[0].change < ZERO ? -ONE : ONE;
    real_t limit = larger_of(DIP_SDS * rough, DIP_PART * larger_of(peak, REAL_C(0.2) * top));
    uint32_t first = f->input.edge[0].sample;
    real_t until = (real_t)first + f->lag + f->dead;
    if (f->input.edges > 1 && until > (real_t)f->input.edge[1].sample)
        until = (real_t)f->input.edge[1].sample;
    for (uint32_t i = first / f->block; i < f->points && (real_t)(i * f->block) <= until; i++)
        if (sign * seen[i] < -limit)
            flags |= IDENTIFIED_INVERSE;

    real_t swing = larger_of(SWING_SDS * rough, SWING_PART * peak);
    real_t expected = REAL_C(0.5) * swing / real_abs(f->gain);
    if (turns(seen, f->points, swing) >= turns(raw, f->points, expected) + 2u)
        flags |= IDENTIFIED_OSCILLATORY;
    return flags;
}

/* Regression on the input's level where the response has had L + 4 T to arrive. Uses all three columns. */
static void plateau(struct fopdt_fit *f, real_t inflation)
{
    real_t *weight = f->column[0], *level = f->column[1], *y = f->column[2];
    real_t reach = f->dead + SETTLED_LAGS * f->lag, squares = ZERO;
    uint32_t used = 0;
    for (uint32_t i = 0; i < f->points; i++) {
        uint32_t from = i * f->block, to = from + f->block - 1;
        level[i] = weight[i] = ZERO;
        y[i] = f->y[i] + f->line_offset + f->line_slope * fit_line_time(&f->line, i);
        bool settled = true;
        for (uint32_t j = 0; j < f->input.edges && to > f->input.edge[j].sample; j++) {
            real_t since = (real_t)from - (real_t)f->input.edge[j].sample;
            settled = since >= reach; /* of the last edge before it, in the end */
            level[i] += f->input.edge[j].change;
        }
        if (settled) {
            weight[i] = ONE;
            squares += level[i] * level[i];
            used++;
        }
    }
    struct fit_line line = f->line;
    line.weight = weight;
    fit_line_prepare(&line);
    uint32_t parameters = 1u + line.offset + line.slope;
    for (uint32_t k = 0; k < FIT_LINE_ROWS; k++)
        level[f->points + k] = y[f->points + k] = ZERO;
    fit_line_remove(&line, level, NULL, NULL);
    fit_line_remove(&line, y, NULL, NULL);
    real_t strength = fit_line_dot(&line, level, level);
    if (used < parameters + 4u || !(strength > REAL_C(0.01) * squares))
        return;
    real_t gain = fit_line_dot(&line, level, y) / strength, left = ZERO;
    for (uint32_t i = 0; i < f->points; i++) {
        real_t r = y[i] - gain * level[i];
        left += weight[i] * r * r;
    }
    real_t known = f->baseline.noise_sd * f->baseline.noise_sd / (real_t)f->block;
    real_t variance = larger_of(left / (real_t)(used - parameters), known) * inflation;
    f->result.plateau_gain = gain;
    f->result.plateau_gain_sd = real_sqrt(variance / strength);
}

/* The plain proportion: an unbiased figure for a gain that is lost in the noise, whatever its times might be. */
static void proportion(struct fopdt_fit *f, real_t variance)
{
    f->lag = f->dead = ZERO;
    response_model(&f->input, ZERO, ZERO, f->block, f->points, f->column[0], NULL);
    f->column[0][f->points] = f->column[0][f->points + 1] = ZERO;
    fit_bend_take_out(&f->bend, &f->line, f->column[0]);
    f->evaluations++;
    f->strength = fit_line_dot(&f->line, f->column[0], f->column[0]);
    f->gain = f->strength > ZERO ? fit_line_dot(&f->line, f->column[0], f->y) / f->strength : ZERO;
    f->result.element.gain = f->gain;
    f->result.element.gain_sd = f->strength > ZERO ? real_sqrt(variance / f->strength) : ZERO;
    f->result.covariance[0] = f->result.element.gain_sd * f->result.element.gain_sd;
}

void fopdt_judge(struct fopdt_fit *f)
{
    struct fopdt_fit_result *r = &f->result;
    real_t white = residual_variance(f, &r->correlation);
    real_t inflation = (ONE + r->correlation) / (ONE - r->correlation);
    real_t variance = white * inflation, gained = f->total - f->squares;
    r->residual_sd = real_sqrt(white);
    r->squares = f->squares;
    r->significance = variance > ZERO ? gained / variance : REAL_C(1e30);
    if (!(gained > ZERO) || r->significance < SIGNIFICANT) {
        r->element.flags = IDENTIFIED_NO_GAIN;
        real_t left = f->total / (real_t)f->points;
        proportion(f, larger_of(variance, left));
        r->misfit = misfit(f, left, rough_noise(f));
        response(f);
        return;
    }
    r->element.gain = f->gain;
    bool lag = f->lag > REAL_C(1.05) * f->shortest;
    r->element.time_constant_s = lag ? f->lag * f->h_s : ZERO;
    /* Without a lag, dead times within the first sample look alike. */
    r->element.dead_time_s = lag || f->dead > REAL_C(0.75) ? f->dead * f->h_s : ZERO;
    covariance(f, variance);
    real_t level = longest_level(f), sd_ln = r->element.time_constant_sd_s / (f->lag * f->h_s);
    response(f);
    real_t rough = rough_noise(f);
    r->misfit = misfit(f, white, rough);
    r->element.flags = shape_flags(f, r->residual_sd, rough);
    if (f->lag + f->dead > level)
        r->element.flags |= IDENTIFIED_SHORT;
    if (f->lag >= REAL_C(0.95) * f->lag_max || (f->lag > level && sd_ln > LAG_UNSURE))
        r->element.flags |= IDENTIFIED_INTEGRATING;
    if (!f->bend.on) /* levels of a drift that turns are none */
        plateau(f, inflation);
}
