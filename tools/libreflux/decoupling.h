/* Part of libreflux.h: decouplers of a sampled plant, controllers by pole placement, static decouplers between none and the whole one
 * (firmware/design/polynomial_decoupler.h, pole_placement.h, decoupler_shapes.h). The rules of libreflux.h hold; struct
 * reflux_sampled is that of arrays.h. Polynomials are in z^-1, coefficient 0 first. tools/reflux/decoupling.py is the Python
 * side. */
#ifndef REFLUX_LIBREFLUX_DECOUPLING_H
#define REFLUX_LIBREFLUX_DECOUPLING_H

#include <stdint.h>

#include "arrays.h"

#define REFLUX_POLYNOMIAL 32 /* coefficients of one */

/* settings: element_hi, determinant_lo, zero_hi, recursion_hi. Of n loops: g, n x n x REFLUX_POLYNOMIAL, and taps, coefficients that count;
 * h, n x REFLUX_POLYNOMIAL, and h_taps. zeros: n_zeros complex numbers and a radius for each. numbers: outermost, recursive,
 * delay. n_zeros, zeros and radius also hold where the decoupler is refused, as far as they were found. */
int32_t reflux_polynomial_decoupler(const struct reflux_sampled *model, const double *settings,
                                    double *g, int32_t *taps, double *h, int32_t *h_taps,
                                    int32_t *n_zeros, double *zeros, double *radius,
                                    double *numbers, char *reason);
void reflux_polynomial_decoupler_defaults(double *settings);

/* a, b: na and nb coefficients. goal: overshoot, settling time (s), observer, largest condition. p, q, r, poles: room for
 * REFLUX_POLYNOMIAL each, counts [4]: how many. numbers: radius, angle, condition, residual, overshoot, input peak, sensitivity. */
int32_t reflux_pole_placement(int32_t na, const double *a, int32_t nb, const double *b,
                              double period_s, const double *goal, double *p, double *q, double *r,
                              double *poles, int32_t *counts, double *numbers, char *reason);
void reflux_pole_placement_defaults(double *goal);

/* gains, d: n x n, n to 8; gain, left: by loop. factor: n x n, its diagonal is not looked at. rank: loops from 0. *limited: directions
 * that got no more than the bound. */
int32_t reflux_decoupler_partial(int32_t n, const double *gains, const double *factor, double *d,
                                 double *gain, double *left);
int32_t reflux_decoupler_one_way(int32_t n, const double *gains, const int32_t *rank, double *d,
                                 double *gain, double *left);
int32_t reflux_decoupler_by_directions(int32_t n, const double *gains, double condition_hi,
                                       double *d, double *gain, double *left, int32_t *limited);

#endif
