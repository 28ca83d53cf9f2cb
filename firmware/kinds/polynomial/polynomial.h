/* Kind `polynomial`: a compensator u = G(z^-1) v of up to four loops, G a matrix of polynomials: the polynomial decoupler of Kotyk and
 * Machacek (1995), Eq. 6 (design/polynomial_decoupler.h finds G), or with one coefficient a constant matrix, as from the inverse
 * Nyquist array. */
#ifndef REFLUX_POLYNOMIAL_POLYNOMIAL_H
#define REFLUX_POLYNOMIAL_POLYNOMIAL_H

#include "block/block.h"

#if CONFIG_BLOCKS

#define POLYNOMIAL_LOOPS 4
#define POLYNOMIAL_TAPS  8

/* What becomes of a loop's output where an MV is limited. */
enum polynomial_limits {
    /* The past of v is what gives the MVs that took effect: v = G^-1 u sample by sample, which G has to allow. */
    POLYNOMIAL_RECURSE,
    /* One loop alone does so where its own element of G allows it. Else the move of all loops is shortened to the part that the MV
     * shortened most could make. */
    POLYNOMIAL_SCALE,
    /* A part of G is missing: what has found it proposes it in parts. Until G is whole each MV gets its own loop's output. */
    POLYNOMIAL_INCOMPLETE
};

struct polynomial_settings {
    float period_s; /* of z^-1; 0: a base tick */
    /* Element i, j of n loops is row i n + j, both from 0: span of MV i per span of the output of loop j. Column k is of z^-k. */
    float g[POLYNOMIAL_LOOPS * POLYNOMIAL_LOOPS][POLYNOMIAL_TAPS];
    uint8_t limits; /* enum polynomial_limits */
    uint8_t none[3];
};

extern const struct block_kind polynomial_kind;

/* For its check: whether the recursion v(t) = -G0^-1 (G1 v(t-1) + ...) of the loops in `members` has lost half of every past after 64
 * samples, so that its spectral radius is below 0.99. False also where G0 has no inverse. */
bool polynomial_forgets(const struct polynomial_settings *c, unsigned loops, unsigned taps,
                        unsigned members);
/* a x = b for up to four loops, Gauss with partial pivoting; b may be x. False: singular, to 1e-5 of the largest element. */
bool polynomial_solve(unsigned n, float a[POLYNOMIAL_LOOPS][POLYNOMIAL_LOOPS], const float *b,
                      float *x);

#endif
#endif
