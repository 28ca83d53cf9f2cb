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
    /* 1 to FEEDFORWARD_POINTS */
    uint8_t points;
    /* rad/s, above 0, to pi/h */
    real_t omega[FEEDFORWARD_POINTS];
    /* Gd/Gp, output span per disturbance span */
    struct cplx ratio[FEEDFORWARD_POINTS];
    /* 0 and above; 0: left out */
    real_t weight[FEEDFORWARD_POINTS];
    /* Interval of the element's steps. */
    real_t h_s;
    /* 1 and above */
    real_t kick;
    /* s, 0 and above */
    real_t lag_most, dead_most;
};

struct feedforward_shape {
    /* output span per disturbance span; s */
    real_t k, lead, lag, dead;
};

struct feedforward_search {
    /* The result so far. */
    struct feedforward_shape best;
    /* Its J; J of K = 0. */
    real_t j, j0;
    /* inner state */
    uint8_t phase, lag_at, dead_at, round;
    struct golden section;
};

void feedforward_search_begin(struct feedforward_search *s,
                              const struct feedforward_wanted *wanted);
/* Tries lag and dead time of *near beside the grid, which may be coarse where they have a long range. */
void feedforward_search_near(struct feedforward_search *s, const struct feedforward_wanted *wanted,
                             const struct feedforward_shape *near);
/* A piece, a lag with a dead time: up to 20,000 instructions. *wanted is the same all the time. True while there is more. */
bool feedforward_search_piece(struct feedforward_search *s,
                              const struct feedforward_wanted *wanted);

/* Instead of a search: sets J of K = 0, and that of an element from elsewhere. */
void feedforward_search_skip(struct feedforward_search *s, const struct feedforward_wanted *wanted,
                             real_t j);

/* F at a frequency, and J. */
struct cplx feedforward_response(const struct feedforward_shape *f, real_t h_s, real_t omega);
real_t feedforward_objective(const struct feedforward_wanted *wanted,
                             const struct feedforward_shape *f);

#endif
