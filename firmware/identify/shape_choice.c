#include "identify/shape_choice.h"

#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "identify/shape_curve.h"
#include "identify/shape_response.h"
#include "identify/shape_search.h"
#include "identify/shape_tail.h"

#define CORRELATION_MAX REAL_C(0.9)
/* Share of the whole that no formula meets better: equal lags are kept apart, and no plant is a formula. */
#define SQUARES_LEAST REAL_C(1e-7)
/* Deviations of the searched parameters before any record: of the dead time over dead time and lag, of the zero over the
 * lag, of the logarithms of lag and ratio. */
#define PRIOR_DEAD    REAL_C(0.5)
#define PRIOR_ZERO    REAL_C(0.25)
#define PRIOR_TIME    REAL_C(1.5)
#define PRIOR_RATIO   REAL_C(1.0)
#define RAMP_SD_MAX   REAL_C(0.1) /* deviation of the ramp's slope over it, to count as seen */
#define RAMP_LAGS     REAL_C(4.0) /* least level in slowest lags */
#define EFFECTIVE_MIN REAL_C(8.0) /* points that count at least */
#define SDS           REAL_C(2.0)
#define TAIL_ODDS     REAL_C(0.1)  /* of a slow tail before any record */
#define TAIL_LEAST    REAL_C(0.15) /* least weight of a tail that counts */

static const uint8_t parameter_counts[SHAPE_FORMULAS] = {3, 4, 5, 3};

static uint32_t curve_terms(const struct shape_fit *f)
{
    return (f->curve_terms & 1u) + (f->curve_terms >> 1 & 1u) + (uint32_t)(f->curve_terms >> 2);
}

static uint32_t degrees_of_freedom(const struct shape_fit *f, enum shape_formula formula)
{
    uint32_t used = parameter_counts[formula] + (uint32_t)f->line.offset + (uint32_t)f->line.slope +
                    curve_terms(f);
    return f->points > used + 4u ? f->points - used : 4u;
}

static real_t inflation(real_t correlation)
{
    return (ONE + correlation) / (ONE - correlation);
}

/* Variance of a point by the residuals of a formula, at least the noise that is known, times what their correlation costs. */
static real_t variance_of_point(const struct shape_fit *f, enum shape_formula formula)
{
    const struct shape_candidate *c = &f->candidate[formula];
    real_t own = c->squares / (real_t)degrees_of_freedom(f, formula);
    own = own > f->noise_variance ? own : f->noise_variance;
    return own * inflation(c->correlation);
}

void shape_choice_residuals(struct shape_fit *f)
{
    real_t square = ZERO, product = ZERO, before = ZERO;
    for (uint32_t i = 0; i < f->points; i++) {
        real_t r = f->y[i] - f->gain * f->column[0][i] - f->gain_zero * f->column[1][i];
        square += r * r;
        product += r * before;
        before = r;
    }
    real_t rho = square > ZERO ? product / square : ZERO;
    rho = rho < ZERO ? ZERO : (rho > CORRELATION_MAX ? CORRELATION_MAX : rho);
    f->candidate[f->formula].correlation = rho;
}

void shape_choice_shape(const struct shape_fit *f, enum shape_formula formula, struct shape *s)
{
    const struct shape_candidate *c = &f->candidate[formula];
    real_t lag, square;
    shape_search_lags(f, formula, &c->place, &lag, &square);
    real_t zero = real_abs(c->gain) > ZERO ? c->gain_zero / c->gain : ZERO;
    *s = (struct shape){.gain = c->gain,
                        .dead_time_s = c->place.dead * f->h_s,
                        .lag_s = lag * f->h_s,
                        .square_s2 = square * f->h_s * f->h_s,
                        .zero_s = zero * f->h_s};
}

/* Derivative of parameter `which` of the shape by each column's parameter. */
static void parameter_slopes(const struct shape_fit *f, uint32_t which, real_t *row)
{
    enum shape_formula formula = (enum shape_formula)f->formula;
    const struct shape_candidate *c = &f->candidate[formula];
    struct shape s;
    shape_choice_shape(f, formula, &s);
    bool zero = formula == SHAPE_FORMULA_ZERO, ramp = formula == SHAPE_FORMULA_INTEGRATING;
    uint32_t dead = zero ? 2u : 1u, time = dead + 1u, ratio = dead + 2u;
    for (uint32_t k = 0; k < SHAPE_COLUMNS; k++)
        row[k] = ZERO;
    switch (which) {
    case SHAPE_GAIN:
        row[0] = ONE;
        break;
    case SHAPE_DEAD:
        row[dead] = f->h_s;
        break;
    case SHAPE_LAG:
        row[time] = c->place.time * f->h_s;
        break;
    case SHAPE_SQUARE:
        if (ramp)
            row[time] = s.square_s2;
        else if (formula != SHAPE_FORMULA_ONE)
            row[time] = TWO * s.square_s2;
        if (formula == SHAPE_FORMULA_TWO || zero)
            row[ratio] = s.square_s2;
        break;
    default:
        if (zero && real_abs(c->gain) > ZERO) {
            row[0] = -s.zero_s / c->gain;
            row[1] = f->h_s / c->gain;
        }
        break;
    }
}

/* row := row times the inverse of the triangle. */
static void by_inverse_triangle(const struct shape_fit *f, uint32_t count, real_t *row)
{
    for (uint32_t k = 0; k < count; k++) {
        const real_t *column = &f->triangle[k * (k + 1u) / 2u];
        for (uint32_t i = 0; i < k; i++)
            row[k] -= row[i] * column[i];
        row[k] = column[k] > ZERO ? row[k] / column[k] : ZERO;
    }
}

/* Adds what is known of a parameter before any record: an observation of weight `weight` of column j's parameter, rotated into
 * the triangle (Givens). */
static void add_prior(struct shape_fit *f, uint32_t count, uint32_t j, real_t weight)
{
    real_t row[SHAPE_COLUMNS];
    for (uint32_t k = 0; k < SHAPE_COLUMNS; k++)
        row[k] = k == j ? weight : ZERO;
    for (uint32_t k = j; k < count; k++) {
        real_t *column = &f->triangle[k * (k + 1u) / 2u];
        real_t length = real_sqrt(column[k] * column[k] + row[k] * row[k]);
        if (!(length > ZERO))
            continue;
        real_t cosine = column[k] / length, sine = row[k] / length;
        for (uint32_t i = k; i < count; i++) {
            real_t *above = &f->triangle[i * (i + 1u) / 2u + k], kept = *above;
            *above = cosine * kept + sine * row[i];
            row[i] = cosine * row[i] - sine * kept;
        }
    }
}

/* Lags that a record cannot tell from dead time would have deviations of many times their size. */
static void add_priors(struct shape_fit *f, uint32_t count, real_t variance)
{
    const struct shape_place *p = &f->candidate[f->formula].place;
    uint32_t dead = f->formula == SHAPE_FORMULA_ZERO ? 2u : 1u;
    real_t sd = real_sqrt(variance);
    add_prior(f, count, dead, sd / (PRIOR_DEAD * (p->dead + p->time) + ONE));
    add_prior(f, count, dead + 1u, sd / PRIOR_TIME);
    if (dead + 2u < count)
        add_prior(f, count, dead + 2u, sd / PRIOR_RATIO);
    if (f->formula == SHAPE_FORMULA_ZERO)
        add_prior(f, count, 1, sd / (PRIOR_ZERO * p->time * real_abs(f->gain) + REAL_C(1e-12)));
}

void shape_choice_covariance(struct shape_fit *f)
{
    REFLUX_ASSERT(f->formula < SHAPE_FORMULAS);
    struct shape_candidate *c = &f->candidate[f->formula];
    real_t row[SHAPE_PARAMETERS][SHAPE_COLUMNS], lag = ZERO;
    uint8_t columns[SHAPE_COLUMNS];
    uint32_t count = shape_search_columns((enum shape_formula)f->formula, columns), n = 0;
    real_t variance = variance_of_point(f, (enum shape_formula)f->formula);
    add_priors(f, count, variance);
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++) {
        parameter_slopes(f, i, row[i]);
        by_inverse_triangle(f, count, row[i]);
    }
    /* Residence time takes the place of the lag: a record knows it best, and the correlations stay small. */
    for (uint32_t k = 0; k < count; k++) {
        lag += row[SHAPE_LAG][k] * row[SHAPE_LAG][k];
        row[SHAPE_LAG][k] += row[SHAPE_DEAD][k] - row[SHAPE_ZERO][k];
    }
    c->lag_variance = variance * lag;
    /* Tails stand beside two lags where these are better than one by a point. */
    if (f->formula == SHAPE_FORMULA_ONE ||
        (f->formula == SHAPE_FORMULA_TWO &&
         c->squares < f->candidate[SHAPE_FORMULA_ONE].squares - variance))
        shape_tail_find(f, row[SHAPE_GAIN], row[SHAPE_LAG], variance);
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++)
        for (uint32_t j = 0; j <= i; j++) {
            real_t sum = ZERO;
            for (uint32_t k = 0; k < count; k++)
                sum += row[i][k] * row[j][k];
            c->covariance[n++] = variance * sum;
        }
}

/* Weights exp(-(misfit + penalty of each parameter)/2) of sum 1; redundant formulas have none. */
static void weights_of(const real_t *misfit, const bool *redundant, real_t penalty, real_t *weight)
{
    real_t least = REAL_C(3e38), sum = ZERO;
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++) {
        weight[k] = misfit[k] + penalty * (real_t)parameter_counts[k];
        least = !redundant[k] && weight[k] < least ? weight[k] : least;
    }
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++) {
        real_t worse = REAL_C(0.5) * (weight[k] - least);
        weight[k] = !redundant[k] && worse < REAL_C(30.0) ? real_exp(-worse) : ZERO;
        sum += weight[k];
    }
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++)
        weight[k] /= sum;
}

/* Weights of the tails beside the mixture. Two accounts: a tail where none may be has its odds; where a zero is plausible, it is
 * another place of that formula, as plausible as the squares say. */
static void weigh_tails(const struct shape_fit *f, real_t effective, real_t floor,
                        struct shape_weights *w)
{
    const struct shape_candidate *zero = &f->candidate[SHAPE_FORMULA_ZERO];
    const struct shape_candidate *base = &f->candidate[f->tail_base];
    for (unsigned k = 0; k < SHAPE_TAILS; k++) {
        const struct shape_tail *t = &f->tail[k];
        w->tail[k] = ZERO;
        if (shape_curve_is_on(f) || !(t->odds > ZERO) || !(t->squares > ZERO))
            continue;
        real_t left = effective * real_log(t->squares > floor ? t->squares : floor);
        real_t of_zero = effective * real_log(zero->squares > floor ? zero->squares : floor);
        real_t of_base = effective * real_log(base->squares > floor ? base->squares : floor);
        real_t worse = REAL_C(0.5) * (left - of_zero), better = REAL_C(0.5) * (of_base - left);
        worse = worse > ZERO ? worse : ZERO;
        better = better < REAL_C(30.0) ? better : REAL_C(30.0);
        if (worse < REAL_C(30.0))
            w->tail[k] += w->mixture[SHAPE_FORMULA_ZERO] * real_exp(-worse) / (real_t)SHAPE_TAILS;
        w->tail[k] +=
            w->mixture[f->tail_base] * TAIL_ODDS * t->odds * real_exp(better) / (real_t)SHAPE_TAILS;
        if (w->tail[k] < TAIL_LEAST)
            w->tail[k] = ZERO;
    }
}

void shape_choice_weights(const struct shape_fit *f, struct shape_weights *w)
{
    real_t floor = SQUARES_LEAST * f->total + REAL_C(1e-37), best = f->total;
    real_t effective = (real_t)f->points, misfit[SHAPE_FORMULAS];
    bool redundant[SHAPE_FORMULAS] = {false, false, false, false};
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++) {
        const struct shape_candidate *c = &f->candidate[k];
        if (c->squares <= best) {
            best = c->squares;
            effective = (real_t)f->points / inflation(c->correlation);
        }
    }
    effective = effective > EFFECTIVE_MIN ? effective : EFFECTIVE_MIN;
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++) {
        real_t squares = f->candidate[k].squares;
        misfit[k] = effective * real_log(squares > floor ? squares : floor);
    }
    /* One more parameter that explains nothing says nothing, either. */
    real_t point = (best > floor ? best : floor) / effective;
    for (unsigned k = SHAPE_FORMULA_TWO; k <= SHAPE_FORMULA_ZERO; k++)
        redundant[k] = f->candidate[k].squares > f->candidate[k - 1u].squares - point;
    /* The even part leaves a rest of a curve, which looks like a tail without an end. */
    const struct shape_place *zero = &f->candidate[SHAPE_FORMULA_ZERO].place;
    if (shape_curve_is_on(f) && zero->time >= SHAPE_AT_BOUND * f->level)
        redundant[SHAPE_FORMULA_ZERO] = true;
    weights_of(misfit, redundant, real_log(effective), w->choice);
    weights_of(misfit, redundant, TWO, w->mixture);
    weigh_tails(f, effective, floor, w);
}

/* Noise of a point by the median of second differences, which a drift does not enter and a response little. */
static real_t variance_of_differences(const struct shape_fit *f)
{
    real_t lo = ZERO, hi = ZERO;
    for (uint32_t i = 1; i + 1u < f->points; i++) {
        real_t d = real_abs(f->y[i - 1u] - TWO * f->y[i] + f->y[i + 1u]);
        hi = d > hi ? d : hi;
    }
    for (int n = 0; n < 20; n++) {
        real_t middle = REAL_C(0.5) * (lo + hi);
        uint32_t below = 0;
        for (uint32_t i = 1; i + 1u < f->points; i++)
            below += real_abs(f->y[i - 1u] - TWO * f->y[i] + f->y[i + 1u]) <= middle;
        if (2u * below < f->points - 2u)
            lo = middle;
        else
            hi = middle;
    }
    real_t noise = hi / (REAL_C(0.6745) * REAL_C(2.449490));
    return noise * noise;
}

/* The slope of the ramp over the last half of the longest level: what the residuals leave of it is within two deviations. */
static bool ramp_holds(struct shape_fit *f)
{
    const struct shape_candidate *c = &f->candidate[SHAPE_FORMULA_INTEGRATING];
    real_t squares[2], linear[3], times = ZERO, count = ZERO, cross = ZERO, spread = ZERO;
    shape_search_squares(f, SHAPE_FORMULA_INTEGRATING, &c->place, squares, linear);
    real_t from = (real_t)f->level_from + REAL_C(0.5) * (f->level + c->place.dead);
    real_t to = (real_t)f->level_from + f->level, block = (real_t)f->block;
    for (uint32_t i = 0; i < f->points; i++)
        if ((real_t)i * block >= from && (real_t)(i + 1u) * block <= to) {
            times += (real_t)i;
            count += ONE;
        }
    if (!(count >= REAL_C(4.0)))
        return false;
    for (uint32_t i = 0; i < f->points; i++)
        if ((real_t)i * block >= from && (real_t)(i + 1u) * block <= to) {
            real_t t = (real_t)i - times / count;
            cross += t * (f->y[i] - linear[0] * f->column[0][i]);
            spread += t * t;
        }
    real_t slope = linear[0] * f->level_height * block / f->integrator;
    real_t sd = real_sqrt(variance_of_point(f, SHAPE_FORMULA_INTEGRATING) / spread);
    return real_abs(cross / spread) < SDS * sd && sd < RAMP_SD_MAX * real_abs(slope) &&
           f->level >= RAMP_LAGS * c->place.time;
}

void shape_choice_prepare(struct shape_fit *f)
{
    real_t squares[2], linear[3];
    f->ramp_agrees = ramp_holds(f);
    f->rough_variance = variance_of_differences(f);
    const struct shape_place quarter = {.time = REAL_C(0.25) * f->level};
    shape_search_squares(f, SHAPE_FORMULA_ONE, &quarter, squares, linear);
    real_t strength = fit_line_dot(&f->line, f->column[0], f->column[0]);
    real_t variance = variance_of_point(f, SHAPE_FORMULA_ONE);
    f->plain_gain = linear[0];
    f->plain_sd = strength > ZERO ? real_sqrt(variance / strength) : ZERO;
}
