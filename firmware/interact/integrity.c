#include "interact/integrity.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"

#define PIECE 4000u /* elements computed in one call, about */

static bool is_included(uint16_t mask, unsigned bit)
{
    return (mask & (1u << bit)) != 0u;
}

enum err integrity_begin(struct integrity *w, const struct matrix *gains, const struct pairs *pairs)
{
    if (pairs->n < 1 || pairs->n > INTERACT_MAX)
        return ERR_RANGE;
    memset(w, 0, offsetof(struct integrity, element));
    w->n = pairs->n;
    unsigned from = 0;
    for (unsigned d = 0; d < w->n; d++) {
        w->from[d] = (uint16_t)from;
        from += (w->n - d) * (w->n - d);
    }
    for (unsigned i = 0; i < w->n; i++)
        for (unsigned j = 0; j < w->n; j++) {
            if (pairs->output[i] >= gains->rows || pairs->input[j] >= gains->cols)
                return ERR_RANGE;
            real_t own = gains->value[pairs->output[i]][pairs->input[i]];
            if (real_abs(own) <= REAL_C(0.0))
                return ERR_SINGULAR;
            w->element[i * w->n + j] = gains->value[pairs->output[i]][pairs->input[j]] / own;
        }
    return ERR_OK;
}

/* The level's own pair goes into the subset (its pivot is eliminated from those after it) or stays out. */
static void descend(struct integrity *w, bool with)
{
    REFLUX_ASSERT(w->n <= INTERACT_MAX && w->level + 1u < w->n);
    size_t d = w->level, size = w->n - d;
    const real_t *m = &w->element[w->from[d]];
    real_t *next = &w->element[w->from[d + 1u]];
    for (size_t i = 1; i < size; i++) {
        real_t factor = with ? m[i * size] / m[0] : REAL_C(0.0);
        for (size_t j = 1; j < size; j++)
            next[(i - 1u) * (size - 1u) + j - 1u] = m[i * size + j] - factor * m[j];
    }
    w->level++;
    w->tried[w->level] = 0;
}

/* The pivots of the pairs in it, multiplied. */
static real_t index_of(const struct integrity *w)
{
    real_t product = REAL_C(1.0);
    for (unsigned d = 0; d <= w->level; d++)
        if (is_included(w->included, d))
            product *= w->element[w->from[d]];
    return product;
}

/* One step down, or one up; what it costs in elements. ERR_OK: all seen. */
static enum err walk(struct integrity *w, unsigned *cost)
{
    REFLUX_ASSERT(w->n <= INTERACT_MAX && w->level < w->n);
    unsigned d = w->level, left = w->n - d - 1u;
    uint16_t own = (uint16_t)(1u << d);
    *cost = 4u + left * left;
    if (w->tried[d] == 0) {
        w->included = (uint16_t)(w->included | own);
        if (!(w->element[w->from[d]] > REAL_C(0.0))) { /* the index with it, over that without it */
            w->negative = w->included;
            w->index = index_of(w);
            return ERR_OK;
        }
    }
    if (w->tried[d] < 2u && left > 0u) {
        bool with = w->tried[d] == 0;
        if (!with)
            w->included = (uint16_t)(w->included & ~own);
        w->tried[d]++;
        descend(w, with);
        return ERR_BUSY;
    }
    w->included = (uint16_t)(w->included & ~own);
    if (d == 0)
        return ERR_OK;
    w->level--;
    return ERR_BUSY;
}

enum err integrity_step(struct integrity *w)
{
    enum err err = ERR_BUSY;
    unsigned cost;
    for (unsigned done = 0; err == ERR_BUSY && done < PIECE; done += cost)
        err = walk(w, &cost);
    return err;
}

bool integrity_of_two(const struct matrix *gains, const struct pairs *pairs)
{
    REFLUX_ASSERT(pairs->n <= INTERACT_MAX);
    for (unsigned k = 0; k < pairs->n; k++)
        for (unsigned l = 0; l < k; l++) {
            real_t own = gains->value[pairs->output[k]][pairs->input[k]] *
                         gains->value[pairs->output[l]][pairs->input[l]];
            real_t cross = gains->value[pairs->output[k]][pairs->input[l]] *
                           gains->value[pairs->output[l]][pairs->input[k]];
            if (!(cross / own < REAL_C(1.0)))
                return false;
        }
    return true;
}
