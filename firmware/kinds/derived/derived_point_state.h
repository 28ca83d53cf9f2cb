/* State of a channel; all 0: it has no past. For its owner derived_point.c and for the block that allocates it.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_DERIVED_DERIVED_POINT_STATE_H
#define REFLUX_DERIVED_DERIVED_POINT_STATE_H

#include "kinds/derived/derived_point.h"

#if CONFIG_BLOCKS

/* A sum of two floats: what a float cannot hold of the sum is carried. It has about 47 bits, in both formats of num_t. */
struct derived_total {
    real_t sum, carry;
};

struct derived_point {
    bool has_last;      /* `last` and `lagged` hold */
    bool begun, gap;    /* a total has been reset, and has missed something since */
    bool fresh;         /* a total has been reset since the last step */
    real_t last;        /* S, or the counter, in the last usable step */
    uint32_t since_ms;  /* time since then */
    uint32_t missed_ms; /* of a total */
    struct derived_total lagged, total;
};

#endif
#endif
