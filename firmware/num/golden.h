/* Golden section: the least of a function of one variable, one value of it at a time, so that a search can be left between any two. */
#ifndef REFLUX_NUM_GOLDEN_H
#define REFLUX_NUM_GOLDEN_H

#include <stdint.h>

#include "num/real.h"

struct golden {
    real_t lo, hi;        /* the least is between */
    real_t x[2], f[2];    /* the two points within, and the values there */
    uint8_t trial, taken; /* which is being tried; values taken so far */
};

/* From lo to hi, lo not above hi. */
static inline void golden_begin(struct golden *g, real_t lo, real_t hi)
{
    *g = (struct golden){.lo = lo, .hi = hi};
}

/* Where to try the function next. From the third value on one of the two points stays in each cut. */
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

/* The value there. */
static inline void golden_take(struct golden *g, real_t f)
{
    g->f[g->trial] = f;
    g->taken++;
}

#endif
