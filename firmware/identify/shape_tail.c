#include "identify/shape_tail.h"

#include "base/assertion.h"
#include "identify/common.h"
#include "identify/shape_search.h"

/* Deviation of a tail's gain before any record, over the gain. */
#define TAIL_SHARE REAL_C(0.3)
#define APART_MIN                                                                                  \
    REAL_C(1e-6) /* share of its square that a tail has apart from the other columns */

/* Lags of the tails over the longest level. */
static const real_t tail_lags[SHAPE_TAILS] = {REAL_C(0.75), REAL_C(1.5), REAL_C(2.5)};

/* Takes what the basis explains off the tail's column; the parts are kept. */
static void take_basis_off(struct shape_fit *f, const uint8_t *columns, uint32_t count,
                           real_t *part)
{
    real_t *tail = f->column[SHAPE_TAIL_COLUMN];
    for (uint32_t k = 0; k < count; k++) {
        const real_t *basis = f->column[columns[k]];
        part[k] = fit_line_dot(&f->line, basis, tail);
        for (uint32_t i = 0; i < f->points + FIT_LINE_ROWS; i++)
            tail[i] -= part[k] * basis[i];
    }
}

static real_t product(const real_t *a, const real_t *b, uint32_t count)
{
    real_t sum = ZERO;
    for (uint32_t k = 0; k < count; k++)
        sum += a[k] * b[k];
    return sum;
}

static void find_one(struct shape_fit *f, struct shape_tail *t, real_t lag, const real_t *gain,
                     const real_t *residence, real_t variance)
{
    const struct shape_candidate *c = &f->candidate[f->formula];
    uint8_t columns[SHAPE_COLUMNS];
    real_t part[SHAPE_COLUMNS];
    uint32_t count = shape_search_columns((enum shape_formula)f->formula, columns);
    struct shape_place place = {.dead = c->place.dead, .time = lag};
    shape_search_response(f, &place, f->column[SHAPE_TAIL_COLUMN]);
    const real_t *tail = f->column[SHAPE_TAIL_COLUMN];
    real_t whole = fit_line_dot(&f->line, tail, tail);
    take_basis_off(f, columns, count, part);
    real_t apart = fit_line_dot(&f->line, tail, tail);
    *t = (struct shape_tail){.odds = ZERO};
    if (!(apart > APART_MIN * whole) || !(variance > ZERO))
        return;
    /* The record says `seen` with this variance; before any record it is 0 with the other. */
    real_t seen = fit_line_dot(&f->line, tail, f->y) / apart, seen_variance = variance / apart;
    real_t before = TAIL_SHARE * TAIL_SHARE * c->gain * c->gain;
    real_t part_seen = before / (before + seen_variance), size = part_seen * seen;
    real_t size_variance = part_seen * seen_variance;
    real_t of_gain = ONE - product(gain, part, count), own = product(residence, part, count);
    real_t all = c->gain + size * of_gain;
    if (!(all * c->gain > REAL_C(0.1) * c->gain * c->gain))
        return;
    /* The mean of the times, weighted by the gains. */
    real_t by_size = (lag - c->place.time) * f->h_s / all - own * (ONE - size / all);
    t->gain = size * of_gain;
    t->residence_s = size * by_size;
    t->gain_variance = variance * product(gain, gain, count) + size_variance * of_gain * of_gain;
    t->residence_variance =
        variance * product(residence, residence, count) + size_variance * by_size * by_size;
    t->squares = c->squares - part_seen * seen * seen * apart;
    t->odds = real_sqrt(ONE - part_seen);
}

void shape_tail_find(struct shape_fit *f, const real_t *gain, const real_t *residence,
                     real_t variance)
{
    REFLUX_ASSERT(f->formula <= SHAPE_FORMULA_TWO);
    f->tail_base = f->formula;
    for (unsigned k = 0; k < SHAPE_TAILS; k++)
        find_one(f, &f->tail[k], tail_lags[k] * f->level, gain, residence, variance);
}

real_t shape_tail_squares(const struct shape_fit *f)
{
    real_t least = f->total;
    for (unsigned k = 0; k < SHAPE_TAILS; k++)
        if (f->tail[k].odds > ZERO && f->tail[k].squares < least)
            least = f->tail[k].squares;
    return least;
}
