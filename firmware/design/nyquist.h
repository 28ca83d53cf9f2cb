/* Stability of several loops together, and how far from instability: the frequency response of det(I + G C), followed
 * along the frequency axis.
 *
 * G is stable (FOPDT elements) and every loop integrates, so that F(s) = det(I + G C) (s/(s + a))^n has neither poles nor
 * integrators in the right half plane; the loops are stable together exactly when F(i omega) starts positive at 0 and
 * its angle comes back to 0 (Nyquist; MacFarlane and Postlethwaite 1977). Steps are made as short as the curve wants:
 * at most 0.4 rad and 40 % in size from one frequency to the next.
 *
 * Distance: the closed-loop log modulus of W = det(I + G C) - 1, L = 20 log10 |W/(1 + W)| dB, largest over frequency
 * (Luyben, Ind. Eng. Chem. Process Des. Dev. 25 (1986) 654, who wants it to be 2 dB for each loop). */
#ifndef REFLUX_DESIGN_NYQUIST_H
#define REFLUX_DESIGN_NYQUIST_H

#include <stdbool.h>

#include "design/loops.h"

#define NYQUIST_POINTS 3000

struct nyquist {
    /* Results */
    bool stable;
    real_t log_modulus_db; /* largest */
    real_t omega;          /* rad/s, where */
    uint16_t points;       /* frequencies used */

    /* Work: 5 KiB (float) */
    const struct interact_plant *plant;
    const struct loops *loops;
    struct cmatrix open;
    struct clu lu;
    real_t w, ratio, w_end, shift, turned, last_log, start_log;
    struct cplx last;
    uint8_t stage;
};

/* plant and loops must live and stay as they are. Then nyquist_step until it is not ERR_BUSY: one frequency a call, at
 * most 1e5 operations. ERR_TIMEOUT from a step: NYQUIST_POINTS were not enough (stable is false then). */
MUST_CHECK enum err nyquist_begin(struct nyquist *n, const struct interact_plant *plant,
                                  const struct loops *loops);
MUST_CHECK enum err nyquist_step(struct nyquist *n);

#endif
