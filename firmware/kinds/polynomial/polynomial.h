/* Kind `polynomial`: a compensator u = G(z^-1) v of up to four loops, G a matrix of polynomials: the polynomial decoupler of Kotyk and
 * Machacek (1995), Eq. 6 (design/polynomial_decoupler.h finds G), or with one coefficient a constant matrix, as from the inverse
 * Nyquist array. */
#ifndef REFLUX_POLYNOMIAL_POLYNOMIAL_H
#define REFLUX_POLYNOMIAL_POLYNOMIAL_H

#include "block/block.h"
#include "block/polynomial_settings.h"

#if CONFIG_BLOCKS

extern const struct block_kind polynomial_kind;

/* Returns true when the recursion v(t) = -G0^-1 (G1 v(t-1) + ...) of the loops in `members` has lost half of every past after 64
 * samples, so that its spectral radius is below 0.99. False also where G0 has no inverse. */
bool polynomial_forgets(const struct polynomial_settings *c, unsigned loops, unsigned taps,
                        unsigned members);
/* Solves a x = b for up to four loops, Gauss with partial pivoting; b may be x. False: singular, to 1e-5 of the largest element. */
bool polynomial_solve(unsigned n, float a[POLYNOMIAL_LOOPS][POLYNOMIAL_LOOPS], const float *b,
                      float *x);

#endif
#endif
