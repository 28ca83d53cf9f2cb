/* Golden section: searches the minimum of a function of one variable. It takes one value at a time, so a search can pause between any
 * two. */
#ifndef REFLUX_NUM_GOLDEN_H
#define REFLUX_NUM_GOLDEN_H

#include <stdint.h>

#include "num/real.h"

struct golden {
    real_t lo, hi;        /* the minimum is between them */
    real_t x[2], f[2];    /* the two inner points, and the values there */
    uint8_t trial, taken; /* index of the point under trial; number of values taken so far */
};

/* Begins a search from lo to hi, lo not above hi. */
static inline void golden_begin(struct golden *g, real_t lo, real_t hi)
{
    *g = (struct golden){.lo = lo, .hi = hi};
}

/* Returns the point at which to try the function next. From the third value on, each cut keeps one of the two points. */
static inline real_t golden_next(struct golden *g)
{
    const real_t part = REAL_C(0.6180339887);
    if (g->taken < 2) {
        g->trial = g->taken;
    } else if (g->f[0] < g->f[1]) {
        g->hi = g->x[1];
        g->x[1] = g->x[0];
        g->f[1] = g->f[0];
        g->trial = 0;
    } else {
        g->lo = g->x[0];
        g->x[0] = g->x[1];
        g->f[0] = g->f[1];
        g->trial = 1;
    }
    real_t reach = part * (g->hi - g->lo);
    g->x[g->trial] = g->trial == 0 ? g->hi - reach : g->lo + reach;
    return g->x[g->trial];
}

/* Takes the value at that point. */
static inline void golden_take(struct golden *g, real_t f)
{
    g->f[g->trial] = f;
    g->taken++;
}

#endif
