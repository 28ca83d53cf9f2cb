#include "identify/shape_fit.h"

#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "identify/shape_choice.h"
#include "identify/shape_curve.h"
#include "identify/shape_search.h"

#define GRID_SHAPES 7u
#define GRID_TIMES  9u
#define GRID_DEADS  5u
#define GRID_SIZE   (GRID_SHAPES * GRID_TIMES * GRID_DEADS)
#define RAMP_TIMES  6u
/* Error of a point that a model of a few digits leaves, share of the root mean square of the response. */
#define ROUNDING  REAL_C(1e-4)
#define RAMP_SIZE (RAMP_TIMES * GRID_DEADS)

enum shape_phase {
    GRID,
    RAMP,
    START,
    SLOPES,
    STEP,
    JUDGE,
    JUDGE_SLOPES,
    BEST,
    CURVE,
    CHOOSE,
    DONE
};

enum { NONE_FITTED = -1 };

/* A search begins at a start that the grid has found, at the lag that was given, or at the result of another formula. */
enum start_place { FROM_GRID, FROM_ONE, FROM_TWO, FROM_ZERO };

struct search_run {
    uint8_t formula, from, start;
};

static const struct search_run runs[] = {
    {SHAPE_FORMULA_ONE, FROM_ONE, 0},
    {SHAPE_FORMULA_TWO, FROM_GRID, 0},
    {SHAPE_FORMULA_TWO, FROM_ONE, 0},
    {SHAPE_FORMULA_ZERO, FROM_GRID, 1},
    {SHAPE_FORMULA_ZERO, FROM_GRID, 2},
    {SHAPE_FORMULA_ZERO, FROM_GRID, 3},
    {SHAPE_FORMULA_ZERO, FROM_TWO, 0},
    {SHAPE_FORMULA_TWO, FROM_ZERO, 0},
    {SHAPE_FORMULA_INTEGRATING, FROM_GRID, 4},
    /* once more with a curved part, from what the linear ones have come to */
    {SHAPE_FORMULA_ONE, FROM_ONE, 0},
    {SHAPE_FORMULA_TWO, FROM_ONE, 0},
    {SHAPE_FORMULA_TWO, FROM_GRID, 0},
    {SHAPE_FORMULA_ZERO, FROM_GRID, 1},
    {SHAPE_FORMULA_ZERO, FROM_TWO, 0},
    {SHAPE_FORMULA_INTEGRATING, FROM_GRID, 4},
};

#define RUNS        ((uint32_t)(sizeof runs / sizeof runs[0]))
#define RUNS_CURVED 6u

_Static_assert(GRID_SIZE + RAMP_SIZE + RUNS * (1u + 4u * SHAPE_SEARCH_TRIES) +
                       2u * (4u * SHAPE_FORMULAS + 2u * SHAPE_TAILS) + 9u <=
                   SHAPE_FIT_UNITS_MAX,
               "the search is bounded");

/* Damping 0.12, 0.25, 0.5; lags of a ratio of 0.8, 0.3, 0.1, 0.03. */
static const real_t grid_ratios[GRID_SHAPES] = {REAL_C(17.36),  REAL_C(4.0),    REAL_C(1.0),
                                                REAL_C(0.2469), REAL_C(0.1775), REAL_C(0.0826),
                                                REAL_C(0.0283)};
/* Starts of formula ZERO that they belong to: damped, alike, fast and slow. */
static const uint8_t grid_starts[GRID_SHAPES] = {1, 1, 1, 2, 2, 3, 3};
/* dead time over the largest that is tried */
static const real_t grid_deads[GRID_DEADS] = {REAL_C(0.0), REAL_C(0.4), REAL_C(0.7), REAL_C(0.9),
                                              REAL_C(1.0)};

static uint32_t last_sample(const struct shape_fit *f)
{
    return f->points * f->block;
}

/* The longest level; one that ends the test by a return does not count, as in fopdt_judge.c. */
static void find_level(struct shape_fit *f)
{
    uint32_t longest = 0;
    real_t height = ZERO;
    for (uint32_t j = 0; j < f->input.edges; j++) {
        uint32_t from = f->input.edge[j].sample;
        uint32_t to = j + 1u < f->input.edges ? f->input.edge[j + 1u].sample : last_sample(f);
        bool returned = j > 0 && j + 1u == f->input.edges;
        height += f->input.edge[j].change;
        if (to > from && to - from > longest && !returned) {
            longest = to - from;
            f->level_from = from;
            f->level_height = height;
        }
    }
    f->level = longest > 0 ? (real_t)longest : ONE;
}

static real_t prior_weight(real_t noise, real_t sd, real_t scale)
{
    real_t row = sd > ZERO ? noise / (sd * scale) : ZERO;
    return row < REAL_C(1e4) ? row : REAL_C(1e4);
}

static enum err check_begin(const struct record *r, uint32_t output,
                            const struct fopdt_fit_options *o, const struct fopdt_fit_result *one)
{
    enum err err = baseline_validate(&o->baseline);
    if (!err)
        err = check_real(o->time_max_s, ZERO, REAL_C(1e9));
    if (!err)
        err = check_real(one->element.time_constant_s, ZERO, REAL_C(1e9));
    if (!err)
        err = check_real(one->element.dead_time_s, ZERO, REAL_C(1e9));
    if (err)
        return err;
    if (output >= r->outputs || o->bent)
        return ERR_RANGE;
    if (r->points < SHAPE_FIT_POINTS_MIN || r->input.edges == 0 ||
        record_first_edge(r) + 2u * r->block > r->points * r->block)
        return ERR_EMPTY;
    err = check_real(excitation_peak(&r->input), REAL_C(1e-6), REAL_C(1e6));
    for (uint32_t i = 0; i < r->points && !err; i++)
        err = check_real(r->y[output][i], -VALUE_MAX, VALUE_MAX);
    return err;
}

/* Takes the record of an output, and its line off. */
static void take_record(struct shape_fit *f, const struct record *r, uint32_t output,
                        const struct fopdt_fit_options *o)
{
    REFLUX_ASSERT(output < CHANNEL_MAX && r->points <= RECORD_POINTS);
    f->input = r->input;
    f->h_s = r->h_s;
    f->block = r->block;
    f->points = r->points;
    real_t noise = o->baseline.noise_sd / real_sqrt((real_t)r->block);
    real_t length_s = (real_t)last_sample(f) * r->h_s;
    f->noise_variance = noise * noise;
    f->line = (struct fit_line){
        .points = r->points,
        .offset = o->free_offset || o->baseline.offset_sd > ZERO,
        .slope = o->free_slope || o->baseline.slope_sd_per_s > ZERO,
        .row_0 = o->free_offset ? ZERO : prior_weight(noise, o->baseline.offset_sd, ONE),
        .row_1 = o->free_slope ? ZERO : prior_weight(noise, o->baseline.slope_sd_per_s, length_s),
    };
    fit_line_prepare(&f->line);
    real_t offset = o->free_offset ? ZERO : o->baseline.offset;
    real_t slope = o->free_slope ? ZERO : o->baseline.slope_per_s;
    for (uint32_t i = 0; i < r->points; i++)
        f->y[i] = r->y[output][i] - offset - slope * record_time(r, i);
    f->y[r->points] = f->y[r->points + 1u] = ZERO;
    fit_line_remove(&f->line, f->y, NULL, NULL);
    f->total = fit_line_dot(&f->line, f->y, f->y);
    real_t rounding = ROUNDING * ROUNDING * f->total / (real_t)f->points;
    if (f->noise_variance < rounding)
        f->noise_variance = rounding;
}

enum err shape_fit_begin(struct shape_fit *f, const struct record *r, uint32_t output,
                         const struct fopdt_fit_options *options,
                         const struct fopdt_fit_result *one)
{
    REFLUX_ASSERT(r->outputs <= CHANNEL_MAX && r->points <= RECORD_POINTS);
    const struct fopdt_fit_options free_line = {.free_offset = true, .free_slope = true};
    const struct fopdt_fit_options *o = options ? options : &free_line;
    f->phase = START;
    enum err err = check_begin(r, output, o, one);
    if (err)
        return err;
    take_record(f, r, output, o);
    real_t horizon = (real_t)(last_sample(f) - record_first_edge(r));
    find_level(f);
    f->peak = excitation_peak(&f->input);
    f->integrator = SHAPE_INTEGRATOR_TIMES * horizon;
    f->time_max = o->time_max_s > ZERO ? o->time_max_s / r->h_s : REAL_C(4.0) * horizon;
    f->time_max = f->time_max > ONE ? f->time_max : ONE;
    f->dead_max = REAL_C(0.8) * horizon < f->time_max ? REAL_C(0.8) * horizon : f->time_max;
    f->one.time = real_clamp(one->element.time_constant_s / r->h_s, REAL_C(0.25), f->time_max);
    f->one.dead = real_clamp(one->element.dead_time_s / r->h_s, ZERO, f->dead_max);
    f->one.ratio = REAL_C(0.1);
    for (unsigned k = 0; k < SHAPE_STARTS; k++) {
        f->start[k] = f->one;
        f->start_squares[k] = REAL_C(3e38);
    }
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++)
        f->candidate[k] = (struct shape_candidate){.squares = (real_t)NONE_FITTED};
    f->next = f->tries = f->evaluations = 0;
    f->run = 0;
    f->curve_terms = 0;
    f->phase = GRID;
    return ERR_OK;
}

static void keep_start(struct shape_fit *f, unsigned k, const struct shape_place *place,
                       real_t squares)
{
    REFLUX_ASSERT(k < SHAPE_STARTS);
    if (squares < f->start_squares[k]) {
        f->start_squares[k] = squares;
        f->start[k] = *place;
    }
}

/* The largest dead time that is tried: that of one lag takes in what further lags delay, or what a zero does. */
static real_t dead_to_try(const struct shape_fit *f)
{
    real_t dead = f->one.dead + REAL_C(0.15) * real_clamp(f->one.time, ZERO, f->level) +
                  REAL_C(0.25) * (real_t)f->block;
    return dead < f->dead_max ? dead : f->dead_max;
}

/* Place number `row` of `rows` times from a part of a block to a few levels. */
static real_t grid_time(const struct shape_fit *f, uint32_t row, uint32_t rows, real_t longest)
{
    real_t lo = REAL_C(0.7) * (real_t)f->block, hi = longest > TWO * lo ? longest : TWO * lo;
    hi = hi < f->time_max ? hi : f->time_max;
    return lo * real_pow(hi / lo, (real_t)row / (real_t)(rows - 1u));
}

static void try_grid(struct shape_fit *f)
{
    uint32_t shape = f->next / (GRID_TIMES * GRID_DEADS), row = f->next / GRID_DEADS % GRID_TIMES;
    real_t ratio = grid_ratios[shape], squares[2], linear[3];
    bool damped = ratio > ONE;
    real_t time = grid_time(f, row, GRID_TIMES, damped ? f->level / REAL_C(3.0) : f->level);
    struct shape_place p = {
        .dead = grid_deads[f->next % GRID_DEADS] * dead_to_try(f),
        .time = ratio > REAL_C(0.5) ? time / real_sqrt(ratio) : time,
        .ratio = ratio,
    };
    f->next++;
    shape_search_squares(f, SHAPE_FORMULA_ZERO, &p, squares, linear);
    keep_start(f, 0, &p, squares[0]);
    keep_start(f, grid_starts[shape], &p, squares[1]);
}

static void try_ramp(struct shape_fit *f)
{
    real_t squares[2], linear[3];
    struct shape_place p = {
        .dead = grid_deads[f->next % GRID_DEADS] * dead_to_try(f),
        .time = grid_time(f, f->next / GRID_DEADS, RAMP_TIMES, REAL_C(0.5) * f->level),
        .ratio = ONE,
    };
    f->next++;
    shape_search_squares(f, SHAPE_FORMULA_INTEGRATING, &p, squares, linear);
    keep_start(f, 4, &p, squares[0]);
}

static void start_run(struct shape_fit *f)
{
    REFLUX_ASSERT(f->run < RUNS);
    const struct search_run *r = &runs[f->run];
    f->formula = r->formula;
    if (r->from == FROM_GRID)
        shape_search_begin(f, &f->start[r->start]);
    else if (r->from == FROM_ONE)
        shape_search_begin(f, &f->one);
    else if (r->from == FROM_TWO)
        shape_search_begin(f, &f->candidate[SHAPE_FORMULA_TWO].place);
    else
        shape_search_begin(f, &f->candidate[SHAPE_FORMULA_ZERO].place);
    f->phase = SLOPES;
}

/* Keeps what a search has come to, and begins the next. */
static void end_run(struct shape_fit *f)
{
    REFLUX_ASSERT(f->formula < SHAPE_FORMULAS);
    struct shape_candidate *c = &f->candidate[f->formula];
    if (c->squares < ZERO || f->squares < c->squares) {
        c->place = f->place;
        c->gain = f->gain;
        c->gain_zero = f->gain_zero;
        c->squares = f->squares;
    }
    if (f->formula == SHAPE_FORMULA_ONE) {
        f->one.time = f->place.time;
        f->one.dead = f->place.dead;
    }
    if (shape_curve_is_on(f) && f->formula == SHAPE_FORMULA_ONE)
        shape_curve_place(f, f->curve_terms); /* by the lag as it is with it */
    f->run++;
    f->phase = f->run == RUNS || f->run == RUNS - RUNS_CURVED ? JUDGE : START;
    f->next = 0;
}

/* Residuals of the next candidate; its covariance follows. */
static void judge_formula(struct shape_fit *f)
{
    f->formula = (uint8_t)f->next++;
    shape_search_begin(f, &f->candidate[f->formula].place);
    shape_choice_residuals(f);
    f->phase = JUDGE_SLOPES;
}

static void judge_slopes(struct shape_fit *f)
{
    if (!shape_search_slopes(f))
        return;
    shape_choice_covariance(f);
    f->phase = f->next < SHAPE_FORMULAS ? JUDGE : (shape_curve_is_on(f) ? CHOOSE : BEST);
}

/* Begins with the columns of the best formula, beside which a curved part is looked for. */
static void look_at_best(struct shape_fit *f)
{
    unsigned best = SHAPE_FORMULA_ONE;
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++)
        if (f->candidate[k].squares < f->candidate[best].squares)
            best = k;
    f->formula = (uint8_t)best;
    shape_search_begin(f, &f->candidate[best].place);
    f->phase = CURVE;
}

/* Fits all formulas once more with a curved part, where it explains enough. */
static void look_for_curve(struct shape_fit *f)
{
    if (!shape_search_slopes(f))
        return;
    f->phase = CHOOSE;
    uint8_t columns[SHAPE_COLUMNS];
    uint32_t count = shape_search_columns((enum shape_formula)f->formula, columns);
    uint8_t terms = shape_curve_terms(f, columns, count);
    if (terms == 0)
        return;
    shape_curve_place(f, terms);
    if (!shape_curve_is_on(f))
        return;
    f->start[0] = f->candidate[SHAPE_FORMULA_TWO].place;
    f->start[1] = f->candidate[SHAPE_FORMULA_ZERO].place;
    f->start[4] = f->candidate[SHAPE_FORMULA_INTEGRATING].place;
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++)
        f->candidate[k] = (struct shape_candidate){.squares = (real_t)NONE_FITTED};
    f->phase = START;
}

static void do_stage(struct shape_fit *f)
{
    bool better;
    switch (f->phase) {
    case GRID:
        try_grid(f);
        if (f->next == GRID_SIZE) {
            f->phase = RAMP;
            f->next = 0;
        }
        break;
    case RAMP:
        try_ramp(f);
        f->phase = f->next == RAMP_SIZE ? START : RAMP;
        break;
    case START:
        start_run(f);
        break;
    case SLOPES:
        f->phase = shape_search_slopes(f) ? STEP : SLOPES;
        break;
    case STEP:
        if (shape_search_step(f, &better))
            end_run(f);
        else if (better)
            f->phase = SLOPES;
        break;
    case JUDGE:
        judge_formula(f);
        break;
    case JUDGE_SLOPES:
        judge_slopes(f);
        break;
    case BEST:
        look_at_best(f);
        break;
    case CURVE:
        look_for_curve(f);
        break;
    default:
        shape_choice_prepare(f);
        f->phase = DONE;
        break;
    }
}

bool shape_fit_run(struct shape_fit *f, uint32_t units)
{
    uint32_t until = f->evaluations + units;
    while (f->phase != DONE && f->evaluations < until)
        do_stage(f);
    return f->phase == DONE;
}

enum err shape_fit_result(const struct shape_fit *f, struct shape_found *found)
{
    if (f->phase != DONE)
        return ERR_STATE;
    shape_choice_find(f, found);
    return ERR_OK;
}
