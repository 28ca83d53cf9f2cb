/* PI settings for loops that disturb each other: docs/methods/tuning.md.
 *
 * Every loop begins with SIMC (Skogestad 2003) on its own element, and all are slowed by one factor F:
 *     tau_c = F max(theta, T/8)
 * as little as possible, but so that the loops together are as far from instability as Luyben (1986) asks of multiloop
 * systems: closed-loop log modulus at most db_per_loop n, here never more than db_most; and stay stable with all gains
 * gain_margin times as large. (Luyben begins with Ziegler and Nichols' settings and takes K/F and F Ti.) theta includes
 * half a sample interval; an element of more than one lag counts as one (design/first_order.h). The gain a loop is designed on is the larger of its own, K, and that with the other loops
 * closed, K/lambda (the gain of the equivalent transfer function of He et al. 2009); with a decoupler K/lambda, and the
 * mean dead time and lag of what then makes up the loop.
 *
 * Parts of a plant that do not act on each other have a factor each, the limit is for each by itself: det(I + G C) is the
 * product of theirs, stable where each of them is, and the log modulus of a product of n grows with n though no loop is
 * nearer to instability. What is neglected between parts is not neglected at the end: all loops together must be stable,
 * also with gain_margin; where they are not, all are slowed by one factor after all. */
#ifndef REFLUX_DESIGN_DETUNE_H
#define REFLUX_DESIGN_DETUNE_H

#include "design/nyquist.h"
#include "interact/rga.h"

struct detune_config {
    real_t db_per_loop; /* 0.1 to 20 dB; Luyben: 2 */
    real_t db_most;     /* 0.1 to 40 dB */
    real_t gain_margin; /* 1 to 10 */
    real_t factor_hi;   /* slowest that is tried: 1 to 1e4 */
    real_t gain_hi; /* largest controller gain: 1e-6 to 1e6; the PID of the firmware takes 100 */
    /* Noise of every output of the plant, fraction of span, 0 to 1e3; NULL or 0: not known. What a loop makes of its noise
     * moves no output by more than noise_times (0.01 to 1e6) that output's noise, standard deviations. */
    const real_t *noise_sd;
    real_t noise_times;
    /* 0 to 1: a loop of which the noise is no more has none: it is the resolution. */
    real_t noise_least;
    uint8_t part[INTERACT_MAX]; /* of pair k: pairs of different numbers do not act on each other */
};

struct detune {
    /* Results */
    struct loops loops;           /* settings; pairs, interval and decoupler as given */
    real_t factor, factor_least;  /* F: largest and smallest of the parts */
    real_t log_modulus_db, omega; /* largest of the parts, and where, rad/s */
    uint8_t tried;                /* factors */

    /* Work: 9 KiB (float) */
    const struct interact_plant *plant;
    struct detune_config config;
    struct fopdt model[INTERACT_MAX]; /* what each loop is designed on */
    uint16_t done;                    /* pairs of parts that are */
    bool joint, failed;               /* one factor for all; a part keeps no distance */
    uint8_t place[INTERACT_MAX];      /* loop k of `part` is this one of `loops` */
    /* The part that is detuned: its loops, their decoupler, their F; an F that is too small, one that is large enough, 0 while unknown. */
    struct loops part;
    struct matrix part_decoupler;
    real_t part_factor, lo, hi;
    uint8_t stage;
    union {
        struct nyquist nyquist;
        struct {
            struct rga_work rga;
            struct matrix gains, lambda;
        } begin;
    } work;
};

/* 2 dB, 6 dB, 1.7, 200, 100, no noise, 2, all of one part. */
void detune_config_default(struct detune_config *config);

/* pairs, interval_s and decoupler as in struct loops; the decoupler must live as long. ERR_RANGE, ERR_NOT_FINITE: what is
 * not as there, config, or a pair without a gain (why, which may be NULL, says); ERR_SINGULAR: the gains have no inverse.
 * Then detune_step until it is not ERR_BUSY: about 1e5 instructions a call, about twenty times as many calls as one
 * nyquist for each part. ERR_TIMEOUT from it: not even factor_hi keeps the distance of some part, which then has the
 * settings of factor_hi. */
MUST_CHECK enum err detune_begin(struct detune *d, const struct interact_plant *plant,
                                 const struct pairs *pairs, real_t interval_s,
                                 const struct matrix *decoupler, const struct detune_config *config,
                                 struct interact_refusal *reason);
MUST_CHECK enum err detune_step(struct detune *d);

/* Returns the largest gain of loop k that noise allows: gain_hi, or less where noise_sd is known. All as detune_begin has
 * checked it; settings of the loops do not matter. */
real_t detune_largest_gain(const struct interact_plant *plant, const struct loops *loops,
                           const struct detune_config *config, uint8_t k);

#endif
