#include "model/column_implicit.h"

#include "model/column_inside.h"
#include "num/solve_small.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define M_MAX (COLUMN_COMPONENTS_MAX - 1)

/* Functions for a stage take m, the number of mole fractions, and are expanded where they are called: for two of them, which is what a column
 * on a board mostly has, and for any number. Loops of two turns cost more than what is in them; without them a step of this file takes
 * half of the instructions. */

/* One stage's equations: unknowns are its own changes; the right sides are the changes of the stage above, then numbers. */
#define WIDTH (2 * M_MAX + 1)
struct rows {
    real_t row[M_MAX][WIDTH];
};

/* The change of the vapour that comes from below: slope times that of this stage's liquid, and a number. */
struct vapour_change {
    real_t slope[M_MAX * M_MAX], number[M_MAX];
};

/* dT/dx and dy/dx of a stage in equilibrium. On a truncated stage the temperature is given: there is no dT/dx, and y of every
 * component goes with its own mole fraction. */
static ALWAYS_INLINE void slopes_of(size_t m, const struct column *column, bool truncated,
                                    const real_t *x, size_t s, real_t *dt, real_t *dy)
{
    size_t c = m + 1;
    real_t full[COLUMN_COMPONENTS_MAX];

    if (!truncated) {
        column_full_composition(column, x, s, full);
        vle_slopes(c, full, &column->k[s * c], &column->dk[s * c], dt, dy);
        return;
    }
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            dy[i * m + j] = i == j ? column->k[s * c + j] : ZERO;
}

/* Component balances of stage s, times its holdup. */
static ALWAYS_INLINE void balances(size_t m, const struct column *column, const real_t *rates,
                                   real_t h, size_t s, real_t efficiency, const real_t *dy,
                                   const struct vapour_change *below, struct rows *rows)
{
    const struct column_config *config = column->config;
    size_t top = config->stages - 1;
    real_t liquid = s == top ? ZERO : column_downward(column->liquid[s + 1]);
    real_t vapour_in = s == 0 ? ZERO : column->vapour_flow[s - 1], out = column->vapour_flow[s];
    real_t feed = s + 1 == config->feed_stage ? column->flows.feed : ZERO;
    real_t own = column->holdup[s] / h + liquid + vapour_in + feed - out;
    real_t from_below = out * (ONE - efficiency) - vapour_in;

    for (size_t i = 0; i < m; i++) {
        real_t *row = rows->row[i];
        for (size_t j = 0; j < m; j++) {
            row[j] = (i == j ? own : ZERO) + out * efficiency * dy[i * m + j] +
                     from_below * below->slope[i * m + j];
            row[m + j] = i == j ? liquid : ZERO;
        }
        row[2 * m] = column->holdup[s] * rates[s * m + i] - from_below * below->number[i];
    }
}

static ALWAYS_INLINE void draw(size_t m, const struct column *column, const struct column_pull *p,
                               const real_t *dt, struct rows *rows)
{
    real_t *row = rows->row[p->component];
    real_t part = column->holdup[p->stage] / dt[p->component];

    for (size_t j = 0; j < m; j++)
        row[j] += part * p->gain * dt[j];
    row[2 * m] += part * (p->gain * p->deviation + p->rate);
}

/* (6.4) differentiated takes the place of a balance. */
static ALWAYS_INLINE void close_rows(size_t m, const struct column *column, size_t s,
                                     struct rows *rows)
{
    const real_t *k = &column->k[s * (m + 1)];
    real_t *row = rows->row[m - 1];

    for (size_t j = 0; j < m; j++) {
        row[j] = (k[j] - k[m]) / (k[m - 1] - k[m]);
        row[m + j] = ZERO;
    }
    row[2 * m] = ZERO;
}

/* Finds the change of the vapour leaving the stage, by the change of the liquid on the stage above. */
static ALWAYS_INLINE void leave(size_t m, real_t efficiency, const real_t *dy,
                                const struct rows *rows, struct vapour_change *v)
{
    real_t by_own[M_MAX * M_MAX];

    for (size_t i = 0; i < m * m; i++)
        by_own[i] = (ONE - efficiency) * v->slope[i] + efficiency * dy[i];
    for (size_t i = 0; i < m; i++) {
        real_t number = (ONE - efficiency) * v->number[i];
        for (size_t j = 0; j < m; j++) {
            real_t slope = ZERO;
            for (size_t l = 0; l < m; l++)
                slope += by_own[i * m + l] * rows->row[l][m + j];
            v->slope[i * m + j] = slope;
            number += by_own[i * m + j] * rows->row[j][2 * m];
        }
        v->number[i] = number;
    }
}

static ALWAYS_INLINE void keep_rows(size_t m, const struct rows *rows, size_t s,
                                    struct column_blocks *blocks)
{
    for (size_t i = 0; i < m; i++) {
        for (size_t j = 0; j < m; j++)
            blocks->ratio[(s * m + i) * m + j] = rows->row[i][m + j];
        blocks->change[s * m + i] = rows->row[i][2 * m];
    }
}

static ALWAYS_INLINE enum err way_down(size_t m, const struct column *column,
                                       struct column_blocks *blocks)
{
    for (size_t s = column->config->stages; s-- > 0;)
        for (size_t i = 0; i < m; i++) {
            real_t *change = &blocks->change[s * m];
            if (s + 1 < column->config->stages)
                for (size_t j = 0; j < m; j++)
                    change[i] += blocks->ratio[(s * m + i) * m + j] * change[m + j];
            if (!isfinite(change[i]))
                return ERR_NOT_FINITE;
        }
    return ERR_OK;
}

static ALWAYS_INLINE enum err step(size_t m, const struct column *column, const bool *truncated,
                                   const real_t *x, const real_t *rates, real_t h,
                                   const struct column_pull *pull, size_t pulls,
                                   struct column_blocks *blocks)
{
    real_t dt[M_MAX] = {ZERO}, dy[M_MAX * M_MAX];
    struct vapour_change below = {.number = {ZERO}};
    struct rows rows;

    for (size_t s = 0; s < column->config->stages; s++) {
        real_t efficiency = column_efficiency_of(column, s);
        slopes_of(m, column, truncated[s], x, s, dt, dy);
        balances(m, column, rates, h, s, efficiency, dy, &below, &rows);
        for (size_t k = 0; k < pulls; k++)
            if (pull[k].stage == s)
                draw(m, column, &pull[k], dt, &rows);
        if (truncated[s])
            close_rows(m, column, s, &rows);
        if (!solve_small(m, 2 * m + 1, WIDTH, &rows.row[0][0]))
            return ERR_RANGE;
        keep_rows(m, &rows, s, blocks);
        leave(m, efficiency, dy, &rows, &below);
    }
    return way_down(m, column, blocks);
}

enum err column_implicit_step(const struct column *column, const bool *truncated, const real_t *x,
                              const real_t *rates, real_t h, const struct column_pull *pull,
                              size_t pulls, struct column_blocks *blocks)
{
    size_t m = column->config->components - 1;

    return m == 2 ? step(2, column, truncated, x, rates, h, pull, pulls, blocks)
                  : step(m, column, truncated, x, rates, h, pull, pulls, blocks);
}

size_t column_move(const struct column *column, real_t *x, real_t *change)
{
    size_t m = column->config->components - 1, moved = 0;

    for (size_t s = 0; s < column->config->stages; s++) {
        real_t room = ONE;
        for (size_t j = 0; j < m; j++) {
            real_t wanted = x[s * m + j] + change[s * m + j];
            real_t kept = column_within(wanted, room);
            if (kept != wanted) {
                change[s * m + j] = kept - x[s * m + j];
                moved++;
            }
            x[s * m + j] = kept;
            room -= kept;
        }
    }
    return moved;
}
