/* The state of kept_watch.c; in the workspace. */
#ifndef REFLUX_COMMISSION_KEPT_WATCH_STATE_H
#define REFLUX_COMMISSION_KEPT_WATCH_STATE_H

#include "base/assertion.h"
#include "commission/swing_state.h"
#include "exchange/config.h"

/* Values are fractions of span. */
struct watched_loop {
    struct swing swing;   /* of the error, since the setpoint's last move */
    real_t largest;       /* |error|, once the setpoint counts */
    real_t sum, square;   /* of the error and of its square, over `samples` */
    real_t moves;         /* of the output, summed */
    real_t output, limit; /* output of the sample before; farthest from the setpoint */
    real_t target;        /* setpoint of the sample before */
    uint32_t samples;     /* in automatic, once the setpoint counts */
    uint32_t held;        /* samples until the setpoint counts again */
    uint32_t stuck;       /* samples in a row at a limit of the output */
    uint32_t manual;      /* samples in manual */
};

struct kept_watch {
    uint32_t ticks, length; /* samples so far, and of the whole watch */
    uint8_t sign, culprit;  /* enum kept_sign, and its loop */
    struct watched_loop loop[CONFIG_LOOPS];
};

/* Samples that are left. */
static inline uint32_t kept_watch_left(const struct kept_watch *w)
{
    return w->ticks < w->length ? w->length - w->ticks : 0;
}

static inline const struct watched_loop *kept_watch_loop(const struct kept_watch *w, unsigned k)
{
    REFLUX_ASSERT(k < CONFIG_LOOPS);
    return &w->loop[k];
}

#endif
