#include "identify/shape_search.h"

#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "identify/shape_curve.h"
#include "identify/shape_response.h"
#include "num/solve_small.h"

#define DAMPING_FIRST REAL_C(1e-2)
#define DAMPING_LEAST REAL_C(1e-6)
#define DAMPING_MOST  REAL_C(1e6)
#define QUOTIENT_STEP REAL_C(0.01) /* of a logarithm, for a difference quotient */
#define STRENGTH_MIN  REAL_C(1e-20)
#define APART_MIN     REAL_C(1e-7) /* share of its square that a column has apart from another */
#define LENGTH_LEFT   REAL_C(1e-3) /* the least share of a column that counts as left */
#define LOG_STEP_MAX  REAL_C(0.7)
#define STEP_SMALL    REAL_C(5e-4)
#define TIME_MIN      REAL_C(0.05) /* samples */

enum column { MODEL, CHANGE, BY_DEAD, BY_TIME, BY_RATIO };

static bool has_zero(enum shape_formula formula)
{
    return formula == SHAPE_FORMULA_ZERO;
}

static bool has_ratio(enum shape_formula formula)
{
    return formula == SHAPE_FORMULA_TWO || formula == SHAPE_FORMULA_ZERO;
}

uint32_t shape_search_columns(enum shape_formula formula, uint8_t *columns)
{
    uint32_t n = 0;
    columns[n++] = MODEL;
    if (has_zero(formula))
        columns[n++] = CHANGE;
    columns[n++] = BY_DEAD;
    columns[n++] = BY_TIME;
    if (has_ratio(formula))
        columns[n++] = BY_RATIO;
    return n;
}

void shape_search_lags(const struct shape_fit *f, enum shape_formula formula,
                       const struct shape_place *place, real_t *lag, real_t *square)
{
    *lag = place->time;
    *square = ZERO;
    if (has_ratio(formula)) {
        *square = place->ratio * place->time * place->time;
    } else if (formula == SHAPE_FORMULA_INTEGRATING) {
        *lag = f->integrator + place->time;
        *square = f->integrator * place->time;
    }
}

/* Responses at a place, line taken out. */
static void fill_columns(struct shape_fit *f, enum shape_formula formula,
                         const struct shape_place *place, const struct shape_column *columns,
                         uint32_t count)
{
    struct shape_modes modes;
    real_t lag, square;
    shape_search_lags(f, formula, place, &lag, &square);
    shape_modes_find(lag, square, &modes);
    shape_response(&f->input, &modes, place->dead, f->block, f->points, columns, count);
    for (uint32_t k = 0; k < count; k++) {
        for (uint32_t i = 0; i < FIT_LINE_ROWS; i++)
            columns[k].value[f->points + i] = ZERO;
        fit_line_remove(&f->line, columns[k].value, NULL, NULL);
        shape_curve_take_out(f, columns[k].value);
    }
    f->evaluations++;
}

void shape_search_response(struct shape_fit *f, const struct shape_place *place, real_t *column)
{
    const struct shape_column want = {column, ONE, ZERO, false};
    fill_columns(f, SHAPE_FORMULA_ONE, place, &want, 1);
}

/* Squares that gain times the model and gain_zero times its derivative leave; computed as such, without cancellation. */
static real_t squares_left(const struct shape_fit *f, real_t gain, real_t gain_zero)
{
    real_t sum = ZERO;
    for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++) {
        real_t left = f->y[i] - gain * f->column[MODEL][i] - gain_zero * f->column[CHANGE][i];
        sum += left * left;
    }
    return sum;
}

void shape_search_squares(struct shape_fit *f, enum shape_formula formula,
                          const struct shape_place *place, real_t *squares, real_t *linear)
{
    const struct shape_column columns[2] = {{f->column[MODEL], ONE, ZERO, false},
                                            {f->column[CHANGE], ZERO, ONE, false}};
    fill_columns(f, formula, place, columns, 2);
    real_t mm = fit_line_dot(&f->line, f->column[MODEL], f->column[MODEL]);
    real_t my = fit_line_dot(&f->line, f->column[MODEL], f->y);
    squares[0] = squares[1] = f->total;
    linear[0] = linear[1] = linear[2] = ZERO;
    if (!(mm > STRENGTH_MIN))
        return;
    linear[0] = linear[1] = my / mm;
    squares[0] = squares[1] = squares_left(f, linear[0], ZERO);
    if (formula == SHAPE_FORMULA_ONE || formula == SHAPE_FORMULA_INTEGRATING)
        return;
    real_t cc = fit_line_dot(&f->line, f->column[CHANGE], f->column[CHANGE]);
    real_t mc = fit_line_dot(&f->line, f->column[MODEL], f->column[CHANGE]);
    real_t apart = cc - mc * mc / mm;
    if (!(cc > ZERO) || !(apart > APART_MIN * cc))
        return;
    /* against what the gain alone leaves */
    real_t left = ZERO;
    for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++)
        left += f->column[CHANGE][i] * (f->y[i] - linear[0] * f->column[MODEL][i]);
    linear[2] = left / apart;
    linear[1] = linear[0] - linear[2] * mc / mm;
    squares[1] = squares_left(f, linear[1], linear[2]);
}

void shape_search_begin(struct shape_fit *f, const struct shape_place *place)
{
    real_t squares[2], linear[3];
    bool zero = has_zero((enum shape_formula)f->formula);
    f->place = *place;
    shape_search_squares(f, (enum shape_formula)f->formula, place, squares, linear);
    f->squares = squares[zero];
    f->gain = linear[zero];
    f->gain_zero = zero ? linear[2] : ZERO;
    f->damping = DAMPING_FIRST;
    f->tries = 0;
    f->part = 0;
}

/* A difference quotient of the model by the logarithm of its time or ratio. */
static void quotient_column(struct shape_fit *f, enum column which)
{
    struct shape_place moved = f->place;
    if (which == BY_TIME)
        moved.time *= ONE + QUOTIENT_STEP;
    else
        moved.ratio *= ONE + QUOTIENT_STEP;
    if (which == BY_TIME && has_ratio((enum shape_formula)f->formula))
        moved.ratio = f->place.ratio;
    real_t *column = f->column[which];
    const struct shape_column want = {column, f->gain, f->gain_zero, false};
    fill_columns(f, (enum shape_formula)f->formula, &moved, &want, 1);
    for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++)
        column[i] =
            (column[i] - f->gain * f->column[MODEL][i] - f->gain_zero * f->column[CHANGE][i]) /
            QUOTIENT_STEP;
}

/* Element (i, j), i <= j, of an upper triangle kept by columns. */
static uint32_t upper(uint32_t i, uint32_t j)
{
    return j * (j + 1u) / 2u + i;
}

/* Orthogonal factors by modified Gram and Schmidt: the columns become a basis, f->triangle what they were in it, f->right
 * what y is in it. A column of which nothing is left keeps a small length, so that its parameter is unsure, not infinite. */
static void orthogonal_factors(struct shape_fit *f, const uint8_t *columns, uint32_t count)
{
    uint32_t rows = f->points + FIT_LINE_ROWS;
    for (uint32_t j = 0; j < count; j++) {
        real_t *column = f->column[columns[j]];
        real_t before = real_sqrt(fit_line_dot(&f->line, column, column));
        for (uint32_t i = 0; i < j; i++) {
            const real_t *basis = f->column[columns[i]];
            real_t part = fit_line_dot(&f->line, basis, column);
            f->triangle[upper(i, j)] = part;
            for (uint32_t k = 0; k < rows; k++)
                column[k] -= part * basis[k];
        }
        real_t length = real_sqrt(fit_line_dot(&f->line, column, column));
        real_t least = LENGTH_LEFT * before;
        f->triangle[upper(j, j)] = length > least ? length : least;
        real_t scale = length > least && length > ZERO ? ONE / length : ZERO;
        for (uint32_t k = 0; k < rows; k++)
            column[k] *= scale;
        f->right[j] = fit_line_dot(&f->line, column, f->y);
    }
}

bool shape_search_slopes(struct shape_fit *f)
{
    uint8_t columns[SHAPE_COLUMNS];
    enum shape_formula formula = (enum shape_formula)f->formula;
    const struct shape_column want[3] = {{f->column[MODEL], ONE, ZERO, false},
                                         {f->column[CHANGE], ZERO, ONE, false},
                                         {f->column[BY_DEAD], f->gain, f->gain_zero, true}};
    uint8_t part = f->part++;
    if (part == 0) {
        fill_columns(f, formula, &f->place, want, 3);
        return false;
    }
    quotient_column(f, part == 1 ? BY_TIME : BY_RATIO);
    if (part == 1 && has_ratio(formula))
        return false;
    orthogonal_factors(f, columns, shape_search_columns(formula, columns));
    f->part = 0;
    return true;
}

/* The step of the parameters that may move, by the last `count` rows of the triangle. */
static void damped_step(const struct shape_fit *f, uint32_t first, uint32_t count, const bool *held,
                        real_t *step)
{
    real_t rows[3 * 4];
    for (uint32_t i = 0; i < 3; i++)
        for (uint32_t j = 0; j < 4; j++)
            rows[4 * i + j] = i == j ? ONE : ZERO;
    for (uint32_t i = 0; i < count; i++) {
        if (held[i])
            continue;
        for (uint32_t j = 0; j < count; j++) {
            real_t sum = ZERO;
            for (uint32_t k = 0; k <= i && k <= j; k++)
                sum += f->triangle[upper(first + k, first + i)] *
                       f->triangle[upper(first + k, first + j)];
            if (!held[j])
                rows[4 * i + j] = i == j ? sum * (ONE + f->damping) : sum;
        }
        for (uint32_t k = 0; k <= i; k++)
            rows[4 * i + 3] += f->triangle[upper(first + k, first + i)] * f->right[first + k];
    }
    bool solved = solve_small(3, 4, 4, rows);
    for (uint32_t i = 0; i < 3; i++)
        step[i] = solved && i < count && !held[i] ? rows[4 * i + 3] : ZERO;
}

/* The longest lag that is looked for. With a zero it is the level: a slower tail looks like a drift. */
static real_t longest_time(const struct shape_fit *f)
{
    real_t longest = has_zero((enum shape_formula)f->formula) ? f->level : f->time_max;
    return longest < f->time_max ? longest : f->time_max;
}

/* The place after a step; a parameter that would leave its range is held, and the others move alone. */
static struct shape_place stepped(const struct shape_fit *f)
{
    enum shape_formula formula = (enum shape_formula)f->formula;
    uint32_t first = has_zero(formula) ? 2u : 1u, count = has_ratio(formula) ? 3u : 2u;
    bool held[3] = {false, false, false};
    real_t step[3], time_max = longest_time(f);
    for (int n = 0; n < 3; n++) {
        damped_step(f, first, count, held, step);
        bool dead = (f->place.dead <= ZERO && step[0] < ZERO) ||
                    (f->place.dead >= f->dead_max && step[0] > ZERO);
        bool time = (f->place.time <= TIME_MIN && step[1] < ZERO) ||
                    (f->place.time >= time_max && step[1] > ZERO);
        bool ratio = (f->place.ratio <= SHAPE_RATIO_MIN && step[2] < ZERO) ||
                     (f->place.ratio >= SHAPE_RATIO_MAX && step[2] > ZERO);
        if (!dead && !time && !ratio)
            break;
        held[0] = held[0] || dead;
        held[1] = held[1] || time;
        held[2] = held[2] || ratio;
    }
    struct shape_place p = f->place;
    p.dead = real_clamp(p.dead + step[0], ZERO, f->dead_max);
    p.time *= real_exp(real_clamp(step[1], -LOG_STEP_MAX, LOG_STEP_MAX));
    p.time = real_clamp(p.time, TIME_MIN, time_max);
    if (has_ratio(formula)) {
        p.ratio *= real_exp(real_clamp(step[2], -TWO * LOG_STEP_MAX, TWO * LOG_STEP_MAX));
        p.ratio = real_clamp(p.ratio, SHAPE_RATIO_MIN, SHAPE_RATIO_MAX);
    }
    return p;
}

bool shape_search_step(struct shape_fit *f, bool *better)
{
    struct shape_place p = stepped(f);
    real_t squares[2], linear[3];
    bool zero = has_zero((enum shape_formula)f->formula);
    real_t by_dead = real_abs(p.dead - f->place.dead), by_time = real_abs(p.time - f->place.time);
    real_t by_ratio = real_abs(p.ratio - f->place.ratio);
    bool small = !(by_dead > STEP_SMALL * (f->place.dead + f->place.time)) &&
                 !(by_time > STEP_SMALL * f->place.time) &&
                 !(by_ratio > STEP_SMALL * f->place.ratio);
    shape_search_squares(f, (enum shape_formula)f->formula, &p, squares, linear);
    *better = squares[zero] < f->squares;
    if (*better) {
        f->place = p;
        f->squares = squares[zero];
        f->gain = linear[zero];
        f->gain_zero = zero ? linear[2] : ZERO;
        f->damping = real_clamp(f->damping * REAL_C(0.2), DAMPING_LEAST, DAMPING_MOST);
    } else {
        f->damping *= REAL_C(8.0);
    }
    f->tries++;
    return small || f->tries >= SHAPE_SEARCH_TRIES || f->damping > DAMPING_MOST;
}
