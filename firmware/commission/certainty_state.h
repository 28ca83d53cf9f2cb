/* The state of certainty.c. */
#ifndef REFLUX_COMMISSION_CERTAINTY_STATE_H
#define REFLUX_COMMISSION_CERTAINTY_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "interact/pairing.h"

/* Doubts about a pairing: certainty.h. */
enum analysis_doubt {
    DOUBT_DRAWS = 1 << 0, /* no pairs would do with enough of the gains drawn about the estimates */
    DOUBT_DETERMINANT = 1 << 1, /* its sign is uncertain */
    DOUBT_RANK = 1 << 2,        /* within error, there are fewer directions than pairs */
    DOUBT_SIGN = 1 << 3,        /* the sign of the gain of a pair is uncertain */
    DOUBT_SHAPE = 1 << 4,       /* a test did not show the end of a response */
    DOUBT_CHANNELS = 1 << 5     /* others might be left over; counts while there are more rounds */
};

struct certainty {
    uint16_t used
        [INTERACT_MAX]; /* by output; bit i: a pair, or the inner loop below one, uses input i */
    uint16_t ambiguous_outputs; /* bit j: the pair of output j is open */
    uint16_t unsettled;         /* bit i: longer tests of input i may resolve a flag */
    uint8_t doubts; /* bits of enum analysis_doubt; any makes the pairing undetermined */
};

static inline unsigned certainty_doubts(const struct certainty *c)
{
    return c->doubts;
}

/* The pair of output j is open. */
static inline bool certainty_is_open(const struct certainty *c, unsigned j)
{
    return (c->ambiguous_outputs >> j & 1u) != 0u;
}

/* Longer tests of input i may resolve a flag. */
static inline bool certainty_wants_longer(const struct certainty *c, unsigned i)
{
    return (c->unsettled & (1u << i)) != 0u;
}

#endif
