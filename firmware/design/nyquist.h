/* Stability of several sampled loops together, and how far from instability: det(I + G C) followed along the upper half of
 * the unit circle, z = exp(i omega h).
 *
 * G is stable (elements of one or two lags, sampled exactly) and every loop integrates, so F(z) = det(I + G C) ((z - 1)/(z - b))^n, b
 * inside the circle, has no pole on or outside it, and is 1 at infinity; the loops are stable together exactly when F(1),
 * which is real, is positive and the curve does not turn about the origin on its way to F(-1) (Nyquist; for several loops
 * MacFarlane and Postlethwaite, Int. J. Control 25 (1977) 81). Turns are counted where the curve crosses the negative real
 * axis; steps in frequency are made as short as it wants: at most 0.4 rad and a factor of 1.4 in size, and 1 rad of any
 * dead time that matters; and half of what is left to a resonance of an underdamped element, or half of its width.
 *
 * Distance: the closed-loop log modulus of W = det(I + G C) - 1, L = 20 log10 |W/(1 + W)| dB, largest over frequency
 * (Luyben, Ind. Eng. Chem. Process Des. Dev. 25 (1986) 654). */
#ifndef REFLUX_DESIGN_NYQUIST_H
#define REFLUX_DESIGN_NYQUIST_H

#include <stdbool.h>

#include "design/loops.h"
#include "design/peaks.h"

#define NYQUIST_POINTS 6000
#define NYQUIST_DELAY  4000 /* samples; longer dead times are looked at with longer samples */

struct nyquist {
    /* Results */
    bool stable;
    real_t log_modulus_db; /* largest */
    real_t omega;          /* rad/s, where */
    uint16_t points;       /* frequencies used */
    struct peaks peaks;    /* after nyquist_begin_peaks; of stable loops */

    /* Work: 8 KiB (float) */
    const struct interact_plant *plant;
    const struct loops *loops;
    struct loops_sampled sampled;
    struct clu lu; /* I + G C */
    real_t gain_times, limit_db, w, w_end, ratio, corner, last_log;
    struct cplx last;
    real_t
        last_corner; /* of elements of two lags or with a zero, rad/s; the curve is followed as far */
    int16_t turns;
    uint8_t stage, tries;
    bool shaped; /* there are such elements */
    bool with_peaks;
};

/* gain_times, 0.01 to 100: all controller gains are taken that many times as large (1: as they are). limit_db: give up
 * as soon as the log modulus exceeds it (stable is false then); infinite: never. plant and loops must live and stay as
 * they are. Then nyquist_step until it is not ERR_BUSY: one frequency a call, about 1e5 instructions (with a decoupler,
 * of at most 8 loops in this firmware, no more). ERR_TIMEOUT from a
 * step: NYQUIST_POINTS were not enough; stable is false. */
MUST_CHECK enum err nyquist_begin(struct nyquist *n, const struct interact_plant *plant,
                                  const struct loops *loops, real_t gain_times, real_t limit_db);
/* The same with the gains as they are and without a limit, and the largest sensitivities as well: at most a third more a call,
 * and steps of at most 8 % of a sensitivity. */
MUST_CHECK enum err nyquist_begin_peaks(struct nyquist *n, const struct interact_plant *plant,
                                        const struct loops *loops);
MUST_CHECK enum err nyquist_step(struct nyquist *n);

#endif
