#include "identify/fopdt_fit.h"

#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "identify/fopdt_judge.h"
#include "identify/response.h"

#define GRID_TIMES  16
#define GRID_SHARES 6
#define TRIES       24

#define DAMPING_FIRST REAL_C(1e-3)
#define DAMPING_LEAST REAL_C(1e-7)
#define DAMPING_MOST  REAL_C(1e7)
#define LAG_STEP      REAL_C(0.01) /* of ln T, for its difference quotient */
#define STRENGTH_MIN  REAL_C(1e-20)

#define BEND_STARTS 5u /* times to begin from */
#define BEND_TRIES  5u /* steps with a bend in each of the places */

_Static_assert(GRID_TIMES *GRID_SHARES + 1 + 3 * TRIES + 8 +
                       (FOPDT_FIT_PLACES - 1) * (BEND_STARTS + 3 * BEND_TRIES) +
                       2 * RECORD_POINTS / (FOPDT_FIT_PLACES - 1) + 4 + 3 * TRIES <=
                   FOPDT_FIT_UNITS_MAX,
               "the search is bounded");

enum phase {
    PHASE_GRID,
    PHASE_START,
    PHASE_SLOPES,
    PHASE_TRY,
    PHASE_PLAIN,
    PHASE_PLACE,
    PHASE_BEND,
    PHASE_JUDGE,
    PHASE_DONE
};

/* dead time over L + T */
static const real_t shares[GRID_SHARES] = {REAL_C(0.0), REAL_C(0.2), REAL_C(0.45),
                                           REAL_C(0.7), REAL_C(0.9), REAL_C(0.98)};

/* Weight of an observation of standard deviation sd, in a time unit of scale, beside points of noise. */
static real_t weight_of(real_t noise, real_t sd, real_t scale)
{
    real_t row = sd > ZERO ? noise / (sd * scale) : ZERO;
    return row < REAL_C(1e4) ? row : REAL_C(1e4);
}

enum err fopdt_fit_begin(struct fopdt_fit *f, const struct record *r, uint32_t output,
                         const struct fopdt_fit_options *options)
{
    REFLUX_ASSERT(r->outputs <= CHANNEL_MAX && r->points <= RECORD_POINTS);
    const struct fopdt_fit_options free_line = {.free_offset = true, .free_slope = true};
    const struct fopdt_fit_options *o = options ? options : &free_line;
    enum err err = baseline_validate(&o->baseline);
    if (!err)
        err = check_real(o->time_max_s, ZERO, REAL_C(1e9));
    if (!err && o->start)
        err = check_real(o->start->time_constant_s, ZERO, REAL_C(1e9));
    if (!err && o->start)
        err = check_real(o->start->dead_time_s, ZERO, REAL_C(1e9));
    if (err)
        return err;
    if (output >= r->outputs)
        return ERR_RANGE;
    uint32_t taken = r->points * r->block, first = record_first_edge(r);
    if (r->points < FOPDT_FIT_POINTS_MIN || r->input.edges == 0 || first + 2 * r->block > taken)
        return ERR_EMPTY;
    err = check_real(excitation_peak(&r->input), REAL_C(1e-6), REAL_C(1e6));
    for (uint32_t i = 0; i < r->points && !err; i++)
        err = check_real(r->y[output][i], -VALUE_MAX, VALUE_MAX);
    if (err)
        return err;

    f->input = r->input;
    f->baseline = o->baseline;
    if (o->free_offset)
        f->baseline.offset = ZERO;
    if (o->free_slope)
        f->baseline.slope_per_s = ZERO;
    f->h_s = r->h_s;
    f->block = r->block;
    f->points = r->points;
    real_t noise = o->baseline.noise_sd / real_sqrt((real_t)r->block);
    real_t length_s = (real_t)taken * r->h_s;
    f->line = (struct fit_line){
        .points = r->points,
        .offset = o->free_offset || o->baseline.offset_sd > ZERO,
        .slope = o->free_slope || o->baseline.slope_sd_per_s > ZERO,
        .row_0 = o->free_offset ? ZERO : weight_of(noise, o->baseline.offset_sd, ONE),
        .row_1 = o->free_slope ? ZERO : weight_of(noise, o->baseline.slope_sd_per_s, length_s),
    };
    fit_line_prepare(&f->line);
    for (uint32_t i = 0; i < r->points; i++)
        f->y[i] =
            r->y[output][i] - f->baseline.offset - f->baseline.slope_per_s * record_time(r, i);
    f->y[r->points] = f->y[r->points + 1] = ZERO;
    fit_line_remove(&f->line, f->y, &f->line_offset, &f->line_slope);
    f->total = fit_line_dot(&f->line, f->y, f->y);

    real_t horizon = (real_t)(taken - first);
    f->lag_max = o->time_max_s > ZERO ? o->time_max_s / r->h_s : REAL_C(4.0) * horizon;
    f->dead_max = REAL_C(0.8) * horizon < f->lag_max ? REAL_C(0.8) * horizon : f->lag_max;
    f->shortest = REAL_C(0.02);
    if (f->lag_max < ONE)
        f->lag_max = ONE;
    f->has_start = o->start != NULL;
    f->start_lag = f->has_start ? o->start->time_constant_s / r->h_s : ZERO;
    f->start_dead = f->has_start ? o->start->dead_time_s / r->h_s : ZERO;
    f->next = f->tries = f->evaluations = 0;
    f->lag = f->lag_max;
    f->dead = ZERO;
    f->squares = f->total;
    f->damping = DAMPING_FIRST;
    f->phase = PHASE_GRID;
    f->bend.on = false;
    f->bend_part[0] = f->bend_part[1] = ZERO;
    f->bent = o->bent;
    f->bend_place = 0;
    f->result = (struct fopdt_fit_result){.points = r->points};
    return ERR_OK;
}

/* Model of gain 1 at lag and dead, line taken out, into a column; its derivative by the dead time into another. */
static void evaluate_model(struct fopdt_fit *f, real_t lag, real_t dead, real_t *model,
                           real_t *by_dead)
{
    REFLUX_ASSERT(f->points <= RECORD_POINTS);
    response_model(&f->input, lag, dead, f->block, f->points, model, by_dead);
    model[f->points] = model[f->points + 1] = ZERO;
    fit_bend_take_out(&f->bend, &f->line, model);
    if (by_dead) {
        by_dead[f->points] = by_dead[f->points + 1] = ZERO;
        fit_bend_take_out(&f->bend, &f->line, by_dead);
    }
    f->evaluations++;
}

/* Sum of squares that is left with the best gain for column 0; computed as such, without cancellation. */
static real_t residual_squares(const struct fopdt_fit *f, real_t *gain)
{
    real_t strength = fit_line_dot(&f->line, f->column[0], f->column[0]);
    *gain = ZERO;
    if (!(strength > STRENGTH_MIN))
        return f->total;
    *gain = fit_line_dot(&f->line, f->column[0], f->y) / strength;
    real_t sum = ZERO;
    for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++) {
        real_t off = f->y[i] - *gain * f->column[0][i];
        sum += off * off;
    }
    return sum;
}

static void consider_start(struct fopdt_fit *f, real_t lag, real_t dead)
{
    real_t gain;
    evaluate_model(f, lag, dead, f->column[0], NULL);
    real_t squares = residual_squares(f, &gain);
    if (squares < f->squares * REAL_C(0.99999)) {
        f->squares = squares;
        f->lag = lag;
        f->dead = dead;
    }
}

/* Not from a lag so short that nothing depends on it: no step leads out of there. */
static real_t shortest_to_begin_from(const struct fopdt_fit *f)
{
    return REAL_C(0.5) * real_clamp(REAL_C(0.5) * (real_t)f->block, ONE, f->lag_max);
}

static void grid(struct fopdt_fit *f)
{
    uint32_t row = f->next / GRID_SHARES;
    real_t step = (real_t)row / (real_t)(GRID_TIMES - 1);
    real_t lo = TWO * shortest_to_begin_from(f);
    real_t time = lo * real_pow(f->lag_max / lo, step), share = shares[f->next % GRID_SHARES];
    f->next++;
    real_t lag = real_clamp(time * (ONE - share), REAL_C(0.5) * lo, f->lag_max);
    if (time * share <= f->dead_max)
        consider_start(f, lag, time * share);
    else
        f->evaluations++; /* a unit is a unit */
}

/* Normal equations of the step in ln T and L, by Kaufman: derivatives without their part along the model. */
static void slopes(struct fopdt_fit *f)
{
    evaluate_model(f, f->lag, f->dead, f->column[0], f->column[2]);
    evaluate_model(f, f->lag * (ONE + LAG_STEP), f->dead, f->column[1], NULL);
    for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++)
        f->column[1][i] = (f->column[1][i] - f->column[0][i]) / LAG_STEP;
    f->squares = residual_squares(f, &f->gain);
    f->strength = fit_line_dot(&f->line, f->column[0], f->column[0]);
    for (int k = 0; k < 2; k++) {
        real_t *column = f->column[k + 1];
        real_t along = f->strength > STRENGTH_MIN
                           ? fit_line_dot(&f->line, column, f->column[0]) / f->strength
                           : ZERO;
        for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++)
            column[i] = f->gain * (column[i] - along * f->column[0][i]);
        f->along[k] = f->gain * along;
    }
    f->normal[0] = fit_line_dot(&f->line, f->column[1], f->column[1]);
    f->normal[1] = fit_line_dot(&f->line, f->column[1], f->column[2]);
    f->normal[2] = fit_line_dot(&f->line, f->column[2], f->column[2]);
    /* y needs no part taken off: the columns have none along the model */
    f->right[0] = fit_line_dot(&f->line, f->column[1], f->y);
    f->right[1] = fit_line_dot(&f->line, f->column[2], f->y);
}

/* Another bend takes the place of the one before, which goes back into y. */
static void place_bend(struct fopdt_fit *f, uint32_t at)
{
    REFLUX_ASSERT(at < f->points && f->bend.used <= 2);
    for (uint8_t k = 0; f->bend.on && k < f->bend.used; k++)
        for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++)
            f->y[i] += f->bend_part[k] * f->bend.basis[k][i];
    f->bend.on = false;
    f->bend_part[0] = f->bend_part[1] = ZERO;
    if (at > 0) {
        fit_bend_place(&f->bend, &f->line, at);
        fit_bend_remove(&f->bend, &f->line, f->y, f->bend_part);
    }
    f->total = fit_line_dot(&f->line, f->y, f->y);
}

/* Begins again with the present bend, one place a time: from the best times so far, from those without a
 * bend, unless it has made them look like an integrator's, or from some that a record can show. The nearest stays. */
static void begin_with_bend(struct fopdt_fit *f)
{
    static const real_t parts[BEND_STARTS] = {REAL_C(4.0), REAL_C(4.0), REAL_C(12.0), REAL_C(32.0),
                                              REAL_C(96.0)};
    REFLUX_ASSERT(f->next < BEND_STARTS);
    real_t lag = real_clamp((real_t)(f->points * f->block) / parts[f->next],
                            shortest_to_begin_from(f), f->lag_max);
    real_t dead = REAL_C(0.3) * lag;
    if (f->next == 0) {
        dead = f->bend_dead;
        lag = f->bend_lag < lag ? f->bend_lag : lag;
    } else if (f->next == 1) {
        dead = f->straight_dead;
        lag = f->straight_lag < lag ? f->straight_lag : lag;
    }
    consider_start(f, lag, real_clamp(dead, ZERO, f->dead_max));
    if (++f->next < BEND_STARTS)
        return;
    f->tries = TRIES - BEND_TRIES;
    f->damping = DAMPING_FIRST;
    f->phase = PHASE_SLOPES;
}

/* A search for the times has ended. Where the drift turns nobody knows: the search goes on from the times without a bend
 * with one in each of some places, then point by point about the best of them. */
static void end_search(struct fopdt_fit *f)
{
    REFLUX_ASSERT(f->bend_place < FOPDT_FIT_PLACES);
    uint32_t apart = f->points / (FOPDT_FIT_PLACES - 1u);
    f->place_squares[f->bend_place] = f->squares;
    f->place_gain[f->bend_place] = f->gain;
    if (f->bend_place == 0) {
        f->straight_lag = f->lag;
        f->straight_dead = f->dead;
    }
    if (f->bend_place <= 1u || f->squares < f->bend_squares) {
        f->bend_squares = f->squares;
        f->bend_best = f->bend.point;
        f->bend_lag = f->lag;
        f->bend_dead = f->dead;
    }
    if (f->bend_place + 1u < FOPDT_FIT_PLACES) {
        /* The first is at the beginning: it may have turned before the step, unseen. */
        place_bend(f, f->bend_place * apart + 1u);
        f->bend_place++;
        f->squares = REAL_C(1e38);
        f->next = 0;
        f->phase = PHASE_PLACE;
        return;
    }
    f->lag = f->bend_lag;
    f->dead = f->bend_dead;
    f->bend_next = f->bend_best > apart ? f->bend_best - apart + 1u : 1u;
    f->bend_last = f->bend_best + apart < f->points ? f->bend_best + apart : f->points - 1u;
    f->bend_squares = REAL_C(1e38);
    place_bend(f, 0);
    evaluate_model(f, f->lag, f->dead, f->column[0], NULL);
    f->phase = PHASE_BEND;
}

/* The instant of the bend, with the times as they are. column[0] is the model, column[1] is free. */
static void look_for_bend(struct fopdt_fit *f)
{
    real_t squares = fit_bend_squares(&f->line, f->bend_next, f->y, f->column[0], f->column[1]);
    f->evaluations++;
    if (squares < f->bend_squares) {
        f->bend_squares = squares;
        f->bend_best = f->bend_next;
    }
    if (f->bend_next++ < f->bend_last)
        return;
    place_bend(f, f->bend_best);
    f->bent = false; /* found */
    f->tries = 0;
    f->damping = DAMPING_FIRST;
    f->phase = PHASE_SLOPES;
}

/* A damped step; a parameter that would leave its range stays, and the other moves alone. */
static void attempt(struct fopdt_fit *f)
{
    real_t a = f->normal[0] * (ONE + f->damping), c = f->normal[2] * (ONE + f->damping);
    real_t b = f->normal[1], det = a * c - b * b;
    real_t by_lag = ZERO, by_dead = ZERO;
    if (det > REAL_C(1e-6) * a * c) {
        by_lag = (c * f->right[0] - b * f->right[1]) / det;
        by_dead = (a * f->right[1] - b * f->right[0]) / det;
    } else if (a > ZERO) {
        by_lag = f->right[0] / a;
    }
    bool stuck_dead =
        (f->dead <= ZERO && by_dead < ZERO) || (f->dead >= f->dead_max && by_dead > ZERO);
    bool stuck_lag =
        (f->lag <= f->shortest && by_lag < ZERO) || (f->lag >= f->lag_max && by_lag > ZERO);
    if (stuck_dead) /* the other moves alone; the clip below keeps this one */
        by_lag = a > ZERO ? f->right[0] / a : ZERO;
    else if (stuck_lag)
        by_dead = c > ZERO ? f->right[1] / c : ZERO;
    by_lag = real_clamp(by_lag, -ONE, ONE);
    real_t lag = real_clamp(f->lag * real_exp(by_lag), f->shortest, f->lag_max);
    real_t dead = real_clamp(f->dead + by_dead, ZERO, f->dead_max);
    real_t moved = real_abs(lag - f->lag) + real_abs(dead - f->dead), gain;
    evaluate_model(f, lag, dead, f->column[0], NULL);
    real_t squares = residual_squares(f, &gain);
    bool better = squares < f->squares;
    bool small = !(moved > REAL_C(1e-4) * (f->lag + f->dead));
    f->tries++;
    if (better) {
        f->lag = lag;
        f->dead = dead;
        f->damping = real_clamp(f->damping * REAL_C(0.2), DAMPING_LEAST, DAMPING_MOST);
    } else {
        f->damping *= REAL_C(8.0);
    }
    if (!small && f->tries < TRIES && f->damping <= DAMPING_MOST)
        f->phase = better ? PHASE_SLOPES : PHASE_TRY;
    else if (f->bent)
        end_search(f);
    else
        f->phase = f->lag < ONE ? PHASE_PLAIN : PHASE_JUDGE;
}

bool fopdt_fit_run(struct fopdt_fit *f, uint32_t units)
{
    uint32_t until = f->evaluations + units;
    while (f->phase != PHASE_DONE && f->evaluations < until) {
        switch (f->phase) {
        case PHASE_GRID:
            grid(f);
            if (f->next == GRID_TIMES * GRID_SHARES)
                f->phase = f->has_start ? PHASE_START : PHASE_SLOPES;
            break;
        case PHASE_START:
            consider_start(f, real_clamp(f->start_lag, shortest_to_begin_from(f), f->lag_max),
                           real_clamp(f->start_dead, ZERO, f->dead_max));
            f->phase = PHASE_SLOPES;
            break;
        case PHASE_SLOPES:
            slopes(f);
            f->phase = PHASE_TRY;
            break;
        case PHASE_TRY:
            attempt(f);
            break;
        case PHASE_PLACE:
            begin_with_bend(f);
            break;
        case PHASE_BEND:
            look_for_bend(f);
            break;
        case PHASE_PLAIN: {
            /* no lag at all: a valley without slope, between two samples, where no step leads */
            real_t middle = (real_t)(uint32_t)(f->dead + f->lag) + REAL_C(0.5);
            consider_start(f, f->shortest, real_clamp(middle, ZERO, f->dead_max));
            consider_start(f, f->shortest, real_clamp(middle - ONE, ZERO, f->dead_max));
            f->phase = PHASE_JUDGE;
            break;
        }
        default:
            slopes(f); /* columns of the best place, for the covariance */
            fopdt_judge(f);
            f->result.evaluations = f->evaluations;
            f->phase = PHASE_DONE;
            break;
        }
    }
    return f->phase == PHASE_DONE;
}

enum err fopdt_fit_result(const struct fopdt_fit *f, struct fopdt_fit_result *result)
{
    if (f->phase != PHASE_DONE)
        return ERR_STATE;
    *result = f->result;
    return ERR_OK;
}
