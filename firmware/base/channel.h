/* Sizes of the names and units of channels, the number of channels, and the quality of a reading. */
#ifndef REFLUX_BASE_CHANNEL_H
#define REFLUX_BASE_CHANNEL_H

#include <stdbool.h>
#include <stdint.h>

#define CHANNEL_NAME_SIZE 16 /* bytes with the terminating zero */
#define CHANNEL_UNIT_SIZE 12 /* bytes with the terminating zero */

#ifndef CHANNEL_MAX
/* Largest number of measurements, and of manipulated variables, that a board binds. */
#define CHANNEL_MAX 16
#endif

/* Quality of one reading; the worst one wins. The plant link sends it as a byte. */
enum quality {
    QUALITY_GOOD = 0,
    QUALITY_UNCERTAIN = 1, /* usable, but held, clipped or inferred */
    QUALITY_BAD = 2,       /* do not use the number */
    QUALITY_MISSING = 3    /* no number was delivered */
};

static inline bool quality_usable(enum quality q)
{
    return q == QUALITY_GOOD || q == QUALITY_UNCERTAIN;
}

/* Finite float test without libm: an exponent of all ones is infinity or NaN. */
static inline bool float_is_finite(float x)
{
    union {
        float f;
        uint32_t u;
    } bits = {.f = x};
    return (bits.u & 0x7F800000u) != 0x7F800000u;
}

#endif
