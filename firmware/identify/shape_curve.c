#include "identify/shape_curve.h"

#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "identify/shape_response.h"

#define OTHER_WAY REAL_C(0.5) /* least level down over that up, or the other way round */
#define OVER_SHARE                                                                                 \
    REAL_C(0.5) /* longest lag over the longest level: all but an eighth has been seen */
#define APART_MIN REAL_C(1e-4) /* share of its square that a term has apart from the others */
#define BEYOND    REAL_C(9.0)  /* variances of a point beyond the logarithm of the points */

enum term { SQUARE, SQUARE_LATE, INPUT_SQUARE };

static bool has_levels_both_ways(const struct shape_fit *f)
{
    real_t level = ZERO, lo = ZERO, hi = ZERO;
    for (uint32_t j = 0; j < f->input.edges; j++) {
        level += f->input.edge[j].change;
        lo = level < lo ? level : lo;
        hi = level > hi ? level : hi;
    }
    return -lo > OTHER_WAY * hi && hi > OTHER_WAY * -lo;
}

/* Response of one lag, for the peak of the input. */
static void respond(const struct shape_fit *f, const struct excitation *input, real_t peak,
                    real_t *value)
{
    struct shape_modes modes;
    const struct shape_column want = {value, ONE / peak, ZERO, false};
    shape_modes_find(f->one.time, ZERO, &modes);
    shape_response(input, &modes, f->one.dead, f->block, f->points, &want, 1);
}

static void square_levels(struct excitation *u)
{
    real_t level = ZERO;
    for (uint32_t j = 0; j < u->edges; j++) {
        real_t before = level;
        level += u->edge[j].change;
        u->edge[j].change = level * level - before * before;
    }
}

/* The terms, without the line. */
static void fill_terms(struct shape_fit *f)
{
    struct excitation squared = f->input;
    square_levels(&squared);
    respond(f, &f->input, f->peak, f->curve[SQUARE]);
    respond(f, &squared, f->peak * f->peak, f->curve[INPUT_SQUARE]);
    real_t late = ZERO, keeps = real_exp(-(real_t)f->block / f->one.time);
    for (uint32_t i = 0; i < f->points; i++) {
        real_t square = f->curve[SQUARE][i] * f->curve[SQUARE][i];
        f->curve[SQUARE][i] = square;
        late = keeps * late + (ONE - keeps) * square;
        f->curve[SQUARE_LATE][i] = late;
    }
    for (unsigned k = 0; k < SHAPE_CURVES; k++) {
        for (uint32_t i = 0; i < FIT_LINE_ROWS; i++)
            f->curve[k][f->points + i] = ZERO;
        fit_line_remove(&f->line, f->curve[k], NULL, NULL);
    }
    f->evaluations++;
}

static void add_part(const struct shape_fit *f, const real_t *basis, real_t part, real_t *column)
{
    for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++)
        column[i] += part * basis[i];
}

/* Takes a basis of length 1 out of a column; returns what it was. */
static real_t remove_part(const struct shape_fit *f, const real_t *basis, real_t *column)
{
    real_t part = fit_line_dot(&f->line, basis, column);
    add_part(f, basis, -part, column);
    return part;
}

/* Makes the length 1; false where hardly anything of the square of its length is left. */
static bool make_unit(const struct shape_fit *f, real_t *column, real_t whole)
{
    real_t square = fit_line_dot(&f->line, column, column);
    if (!(square > APART_MIN * whole) || !(square > ZERO))
        return false;
    real_t scale = ONE / real_sqrt(square);
    for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++)
        column[i] *= scale;
    return true;
}

void shape_curve_take_out(const struct shape_fit *f, real_t *column)
{
    for (unsigned k = 0; k < SHAPE_CURVES; k++)
        if (f->curve_terms & (1u << k))
            (void)remove_part(f, f->curve[k], column);
}

uint8_t shape_curve_terms(struct shape_fit *f, const uint8_t *basis, uint32_t count)
{
    REFLUX_ASSERT(f->curve_terms == 0 && f->formula < SHAPE_FORMULAS && count <= SHAPE_COLUMNS);
    uint8_t terms = 0;
    real_t left = f->candidate[f->formula].squares, points = (real_t)f->points;
    if (!has_levels_both_ways(f) || f->one.time > OVER_SHARE * f->level)
        return 0;
    fill_terms(f);
    for (unsigned k = 0; k < SHAPE_CURVES; k++) {
        real_t whole = fit_line_dot(&f->line, f->curve[k], f->curve[k]);
        for (uint32_t n = 0; n < count; n++)
            (void)remove_part(f, f->column[basis[n]], f->curve[k]);
        for (unsigned n = 0; n < k; n++)
            if (terms & (1u << n))
                (void)remove_part(f, f->curve[n], f->curve[k]);
        if (!make_unit(f, f->curve[k], whole))
            continue;
        real_t along = fit_line_dot(&f->line, f->curve[k], f->y), explained = along * along;
        real_t variance = (left - explained) / points;
        variance = variance > f->noise_variance ? variance : f->noise_variance;
        if (!(explained > (BEYOND + real_log(points)) * variance))
            continue;
        left -= explained;
        terms = (uint8_t)(terms | 1u << k);
    }
    return terms;
}

void shape_curve_place(struct shape_fit *f, uint8_t terms)
{
    for (unsigned k = 0; k < SHAPE_CURVES; k++)
        if (f->curve_terms & (1u << k))
            add_part(f, f->curve[k], f->curve_part[k], f->y);
    f->curve_terms = 0;
    fill_terms(f);
    for (unsigned k = 0; k < SHAPE_CURVES; k++) {
        real_t whole = fit_line_dot(&f->line, f->curve[k], f->curve[k]);
        shape_curve_take_out(f, f->curve[k]);
        if (!(terms & (1u << k)) || !make_unit(f, f->curve[k], whole))
            continue;
        f->curve_part[k] = remove_part(f, f->curve[k], f->y);
        f->curve_terms = (uint8_t)(f->curve_terms | 1u << k);
    }
    f->total = fit_line_dot(&f->line, f->y, f->y);
}
