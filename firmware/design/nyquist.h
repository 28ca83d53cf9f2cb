/* Stability of several loops together, and how far from instability: the frequency response of det(I + G C), followed
 * along the frequency axis.
 *
 * G is stable (FOPDT elements) and every loop integrates, so F(s) = det(I + G C) (s/(s + a))^n, a > 0, has no pole in the
 * right half plane or on its edge; the loops are stable together exactly when F begins positive at 0 and does not turn
 * about the origin on its way to F(i infinity) = 1 (Nyquist; for several loops MacFarlane and Postlethwaite, Int. J.
 * Control 25 (1977) 81). Turns are counted where the curve crosses the negative real axis; steps in frequency are made
 * as short as it wants, at most 0.4 rad and a factor of 1.4 in size.
 *
 * Distance: the closed-loop log modulus of W = det(I + G C) - 1, L = 20 log10 |W/(1 + W)| dB, largest over frequency
 * (Luyben, Ind. Eng. Chem. Process Des. Dev. 25 (1986) 654). */
#ifndef REFLUX_DESIGN_NYQUIST_H
#define REFLUX_DESIGN_NYQUIST_H

#include <stdbool.h>

#include "design/loops.h"

#define NYQUIST_POINTS 4000

struct nyquist {
    /* Results */
    bool stable;
    real_t log_modulus_db; /* largest */
    real_t omega;          /* rad/s, where */
    uint16_t points;       /* frequencies used */

    /* Work: 4 KiB (float) */
    const struct interact_plant *plant;
    const struct loops *loops;
    struct cmatrix open;
    struct clu lu;
    real_t gain_times, limit_db, w, ratio, corner, last_log;
    struct cplx last;
    int16_t turns;
    uint8_t stage, tries;
};

/* gain_times, 0.01 to 100: all controller gains are taken that many times as large (1: as they are). limit_db: give up
 * as soon as the log modulus exceeds it (stable is false then); infinite: never. plant and loops must live and stay as
 * they are. Then nyquist_step until it is not ERR_BUSY: one frequency a call, at most 1e5 operations. ERR_TIMEOUT from a
 * step: NYQUIST_POINTS were not enough; stable is false. */
MUST_CHECK enum err nyquist_begin(struct nyquist *n, const struct interact_plant *plant,
                                  const struct loops *loops, real_t gain_times, real_t limit_db);
MUST_CHECK enum err nyquist_step(struct nyquist *n);

#endif
