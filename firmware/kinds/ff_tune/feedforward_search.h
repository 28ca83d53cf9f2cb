/* Gain, lead, lag and dead time of a feedforward from Gd/Gp on a grid of frequencies: the least
 *
 *     J = sum_i W_i | F(w_i) + R_i |      F = K (lead s + 1)/(lag s + 1) e^(-dead w i),  s = (1 - z^-1)/h      R = Gd/Gp
 *
 * R. Siddha (2003), 2.2: his objective, with W = 1/(w h), and the backward difference that the element computes. He seeks it by
 * a simplex of three parameters, which stops early. Ours: for a given lag and dead time J is convex in (K, K lead) and found by least squares
 * reweighted by 1/|error| (E. Weiszfeld 1937, for sums of distances); lag and dead time by a grid and then in turns by golden section.
 * lead is 0 or above, and (lead + h)/(lag + h), by which a jump of d is amplified at first, at most `kick`. Where a lead below 0
 * would imitate a dead time there is the dead time itself. */
#ifndef REFLUX_FF_TUNE_FEEDFORWARD_SEARCH_H
#define REFLUX_FF_TUNE_FEEDFORWARD_SEARCH_H

#include <stdbool.h>
#include <stdint.h>

#include "num/cmatrix.h"
#include "num/golden.h"

#define FEEDFORWARD_POINTS 16

struct feedforward_wanted {
    uint8_t points;                        /* 1 to FEEDFORWARD_POINTS */
    real_t omega[FEEDFORWARD_POINTS];      /* rad/s, above 0, to pi/h */
    struct cplx ratio[FEEDFORWARD_POINTS]; /* Gd/Gp, output span per disturbance span */
    real_t weight[FEEDFORWARD_POINTS];     /* 0 and above; 0: left out */
    real_t h_s;                            /* of the element's steps */
    real_t kick;                           /* 1 and above */
    real_t lag_most, dead_most;            /* s, 0 and above */
};

struct feedforward_shape {
    real_t k, lead, lag, dead; /* output span per disturbance span; s */
};

struct feedforward_search {
    struct feedforward_shape best;
    real_t j, j0; /* the least so far; J of K = 0 */
    /* inner state */
    uint8_t phase, lag_at, dead_at, round;
    struct golden section;
};

void feedforward_search_begin(struct feedforward_search *s,
                              const struct feedforward_wanted *wanted);
/* Lag and dead time of *near are tried beside the grid, which may be coarse where they have a long range. */
void feedforward_search_near(struct feedforward_search *s, const struct feedforward_wanted *wanted,
                             const struct feedforward_shape *near);
/* The same *wanted all the time. A lag with a dead time: up to 20,000 instructions. True while there is more. */
bool feedforward_search_piece(struct feedforward_search *s,
                              const struct feedforward_wanted *wanted);

/* F at a frequency, and J. */
struct cplx feedforward_response(const struct feedforward_shape *f, real_t h_s, real_t omega);
real_t feedforward_objective(const struct feedforward_wanted *wanted,
                             const struct feedforward_shape *f);

#endif
