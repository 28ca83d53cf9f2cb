#include "interact/assignment.h"

#include <stdbool.h>
#include <stddef.h>

#include "base/assertion.h"

/* A square problem: what is missing on a side is filled with rows or columns that cost nothing. */
struct work {
    const struct assignment *a;
    size_t n;
    int64_t u[INTERACT_MAX], v[INTERACT_MAX]; /* dual: u[i] + v[j] <= cost, equal where assigned */
    uint8_t row_of[INTERACT_MAX], col_of[INTERACT_MAX];
};

static int64_t cost(const struct work *w, size_t i, size_t j)
{
    return i < w->a->rows && j < w->a->cols ? w->a->cost[i][j] : 0;
}

/* Gives row `start` a column by the shortest augmenting path, and keeps the dual feasible. */
static void augment(struct work *w, size_t start)
{
    REFLUX_ASSERT(start < w->n && w->n <= INTERACT_MAX);
    int64_t distance[INTERACT_MAX];
    uint8_t before[INTERACT_MAX]; /* row from which the column was reached */
    bool done[INTERACT_MAX] = {false};
    for (size_t j = 0; j < w->n; j++) {
        distance[j] = cost(w, start, j) - w->u[start] - w->v[j];
        before[j] = (uint8_t)start;
    }
    size_t last = 0;
    for (size_t round = 0; round < w->n; round++) {
        size_t best = w->n;
        for (size_t j = 0; j < w->n; j++)
            if (!done[j] && (best == w->n || distance[j] < distance[best]))
                best = j;
        REFLUX_ASSERT(best < w->n);
        last = best;
        if (w->row_of[best] == INTERACT_NONE)
            break;
        done[best] = true;
        size_t i = w->row_of[best];
        for (size_t j = 0; j < w->n; j++) {
            int64_t through = distance[best] + cost(w, i, j) - w->u[i] - w->v[j];
            if (!done[j] && through < distance[j]) {
                distance[j] = through;
                before[j] = (uint8_t)i;
            }
        }
    }
    w->u[start] += distance[last];
    for (size_t j = 0; j < w->n; j++)
        if (done[j]) {
            w->u[w->row_of[j]] += distance[last] - distance[j];
            w->v[j] -= distance[last] - distance[j];
        }
    for (size_t j = last;;) {
        size_t i = before[j];
        uint8_t next = w->col_of[i];
        w->row_of[j] = (uint8_t)i;
        w->col_of[i] = (uint8_t)j;
        if (i == start)
            return;
        j = next;
    }
}

static bool tight(const struct work *w, size_t i, size_t j)
{
    return w->u[i] + w->v[j] == cost(w, i, j);
}

/* Gives row i the first column it can have at no cost, rows before it staying as they are: every optimal assignment is
 * made of tight elements, so the others must be able to hand on along tight ones until somebody takes i's old column. */
static void prefer_first(struct work *w, size_t i)
{
    REFLUX_ASSERT(i < w->n && w->col_of[i] < w->n);
    uint8_t old = w->col_of[i];
    uint8_t takes[INTERACT_MAX]; /* row: the column it would take, INTERACT_NONE: no way to `old` */
    uint8_t reached[INTERACT_MAX];
    size_t found = 0;
    for (size_t k = 0; k < w->n; k++)
        takes[k] = INTERACT_NONE;
    reached[found++] = old;
    for (size_t at = 0; at < found; at++)
        for (size_t k = i + 1; k < w->n; k++)
            if (takes[k] == INTERACT_NONE && tight(w, k, reached[at])) {
                takes[k] = reached[at];
                reached[found++] = w->col_of[k];
            }
    for (size_t j = 0; j < old; j++) {
        size_t k = w->row_of[j];
        if (k <= i || takes[k] == INTERACT_NONE || !tight(w, i, j))
            continue;
        size_t taken_from = i, column = j;
        for (size_t hop = 0; hop < w->n; hop++) {
            size_t loser = w->row_of[column];
            w->col_of[taken_from] = (uint8_t)column;
            w->row_of[column] = (uint8_t)taken_from;
            if (column == old)
                return;
            taken_from = loser;
            column = takes[loser];
        }
        return;
    }
}

enum err assignment_solve(const struct assignment *a, uint8_t *partner, int32_t *total)
{
    if (a->rows < 1 || a->rows > INTERACT_MAX || a->cols < 1 || a->cols > INTERACT_MAX)
        return ERR_RANGE;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t j = 0; j < a->cols; j++)
            if (a->cost[i][j] != ASSIGNMENT_FORBIDDEN &&
                (a->cost[i][j] < 0 || a->cost[i][j] > ASSIGNMENT_COST_MAX))
                return ERR_RANGE;
    struct work w = {.a = a, .n = a->rows > a->cols ? a->rows : a->cols};
    for (size_t k = 0; k < w.n; k++)
        w.row_of[k] = w.col_of[k] = INTERACT_NONE;
    for (size_t i = 0; i < w.n; i++)
        augment(&w, i);
    for (size_t i = 0; i < w.n; i++)
        prefer_first(&w, i);
    int32_t sum = 0;
    for (size_t i = 0; i < a->rows; i++) {
        uint8_t j = w.col_of[i];
        partner[i] = j < a->cols ? j : INTERACT_NONE;
        if (j >= a->cols)
            continue;
        if (a->cost[i][j] == ASSIGNMENT_FORBIDDEN)
            return ERR_EMPTY;
        sum += a->cost[i][j];
    }
    *total = sum;
    return ERR_OK;
}

void assignment_by_relative_gains(const struct matrix *lambda, const struct pairs *channels,
                                  const uint16_t *apart, real_t smallest_lambda,
                                  struct assignment *a)
{
    REFLUX_ASSERT(channels->n <= INTERACT_MAX);
    a->rows = a->cols = channels->n;
    for (size_t i = 0; i < channels->n; i++)
        for (size_t j = 0; j < channels->n; j++) {
            real_t l = lambda->value[i][j];
            a->cost[i][j] = ASSIGNMENT_FORBIDDEN;
            if (((unsigned)apart[channels->output[i]] >> channels->input[j] & 1u) != 0u ||
                l < smallest_lambda)
                continue;
            real_t cost = real_abs(real_log(l)) * ASSIGNMENT_COST_UNIT + REAL_C(0.5);
            a->cost[i][j] =
                cost < (real_t)ASSIGNMENT_COST_MAX ? (int32_t)cost : ASSIGNMENT_COST_MAX;
        }
}
