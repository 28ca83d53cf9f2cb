/* The state of swing.c. */
#ifndef REFLUX_COMMISSION_SWING_STATE_H
#define REFLUX_COMMISSION_SWING_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

/* All 0 before the first sample. Areas are in units of the error times a sample. */
struct swing {
    real_t integral;
    real_t extreme;       /* farthest since the turn before, in the present direction */
    real_t turned;        /* integral at that turn */
    real_t area, largest; /* of the half cycle before; of all before */
    uint32_t since;       /* samples since the extreme */
    uint32_t length;      /* samples of the present half cycle, to its extreme */
    uint32_t took;        /* samples of the half cycle before */
    int8_t direction;     /* of the integral; 0: before the first sample */
    uint8_t
        larger; /* half cycles in a row that were not smaller than the one before by that factor */
    bool grows; /* two in a row were not */
};

/* Two half cycles in a row were not smaller than the one before by that factor. */
static inline bool swing_grows(const struct swing *w)
{
    return w->grows;
}

/* Number of half cycles in a row, up to 255, that were not smaller than the one before by that factor. */
static inline unsigned swing_in_a_row(const struct swing *w)
{
    return w->larger;
}

/* Mean height of the last whole half cycle; 0 before the first. */
static inline real_t swing_height(const struct swing *w)
{
    return w->took > 0 ? w->area / (real_t)w->took : REAL_C(0.0);
}

#endif
