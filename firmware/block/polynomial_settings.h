/* Settings of the kind `polynomial`, for itself and for the blocks that propose them. */
#ifndef REFLUX_BLOCK_POLYNOMIAL_SETTINGS_H
#define REFLUX_BLOCK_POLYNOMIAL_SETTINGS_H

#include <stdint.h>

#define POLYNOMIAL_LOOPS 4
#define POLYNOMIAL_TAPS  8

/* How a loop's output gives way where an MV is limited. */
enum polynomial_limits {
    /* The past of v is what gives the MVs that took effect: v = G^-1 u sample by sample, which G has to allow. */
    POLYNOMIAL_RECURSE,
    /* One loop alone does so where its own element of G allows it. Else the move of all loops is shortened to the part that the MV
     * shortened most could make. */
    POLYNOMIAL_SCALE,
    /* A part of G is missing, because the block that has found it proposes it in parts. Until G is whole each MV gets its own loop's output. */
    POLYNOMIAL_INCOMPLETE
};

struct polynomial_settings {
    /* Interval of z^-1; 0: a base tick. */
    float period_s;
    /* Element i, j of n loops is row i n + j, both from 0: span of MV i per span of the output of loop j. Column k is of z^-k. */
    float g[POLYNOMIAL_LOOPS * POLYNOMIAL_LOOPS][POLYNOMIAL_TAPS];
    /* enum polynomial_limits */
    uint8_t limits;
    uint8_t padding[3];
};

/* Ids of the parameters. */
enum { POLYNOMIAL_ID_PERIOD = 1, POLYNOMIAL_ID_G, POLYNOMIAL_ID_LIMITS };

#endif
