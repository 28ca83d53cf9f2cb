/* Settings of the kind `polynomial`, for the kind and for the blocks that propose them. */
#ifndef REFLUX_BLOCK_POLYNOMIAL_SETTINGS_H
#define REFLUX_BLOCK_POLYNOMIAL_SETTINGS_H

#include <stdint.h>

#define POLYNOMIAL_LOOPS 4
#define POLYNOMIAL_TAPS  8

/* How the loops' outputs give way where an MV is limited. */
enum polynomial_limits {
    /* The past of v becomes the one that gives the applied MVs: v = G^-1 u sample by sample, which G must allow. */
    POLYNOMIAL_RECURSE,
    /* If only one MV is limited, and the own element of G of its loop allows it, this loop gives way alone.
     * Otherwise the moves of all loops are shortened, in the ratio of the MV that was shortened most. */
    POLYNOMIAL_SCALE,
    /* A part of G is missing, because the block that has found it proposes it in parts. Until G is complete, each
     * MV gets the output of its own loop. */
    POLYNOMIAL_INCOMPLETE
};

struct polynomial_settings {
    /* Interval of z^-1; 0: a base tick. */
    float period_s;
    /* Element i, j for n loops is row i n + j, both from 0: span of MV i per span of the output of loop j. Column k
     * is the coefficient of z^-k. */
    float g[POLYNOMIAL_LOOPS * POLYNOMIAL_LOOPS][POLYNOMIAL_TAPS];
    /* enum polynomial_limits */
    uint8_t limits;
    uint8_t padding[3];
};

/* Ids of the parameters. */
enum { POLYNOMIAL_ID_PERIOD = 1, POLYNOMIAL_ID_G, POLYNOMIAL_ID_LIMITS };

#endif
