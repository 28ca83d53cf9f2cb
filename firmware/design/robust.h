/* PI settings for the worst of many plants: docs/methods/tuning.md.
 *
 * The largest sensitivities |S_kk| and |T_kk| of every loop, broken while the others stay closed (design/peaks.h), stay below two
 * bounds, for the nominal plant and for every member drawn from what is not known of it. Under these bounds the sum over the
 * loops of 1.75 ln gain - ln Ti is raised by a hill climb. gain/Ti is the inverse of the integral of the error after a load; the
 * rest of the weight of the gain is ours, chosen on seven plants, and brings setpoints and loads nearer to their best
 * together.
 *
 *   1. Climb on the nominal plant, from the settings given, by steps of 0.4 down to 0.05 of the logarithms (robust_pass.h).
 *   2. Judge all members along the whole curve (design/nyquist.h). The worst that exceeds a bound, or is unstable, joins the
 *      plants of the climb, at most ROBUST_ACTIVE of them; all gains are lowered and integral times raised until it is good,
 *      and the climb goes on.
 *   3. A member that still exceeds a bound in the end has all gains of its part lowered until it does not.
 *
 * Parts of a plant that do not act on each other are searched one by one, and judged together at the end. With a decoupler
 * all loops are one part. Of more than four loops only single ones are moved, several at once, and the number of passes has a
 * bound. */
#ifndef REFLUX_DESIGN_ROBUST_H
#define REFLUX_DESIGN_ROBUST_H

#include "design/nyquist.h"
#include "design/robust_config.h"
#include "design/robust_pass.h"

#define ROBUST_ACTIVE 4 /* the nominal plant and three members */

struct robust {
    /* Results */
    struct loops loops;
    real_t s_nominal, t_nominal; /* largest |S_kk| and |T_kk| of the nominal plant */
    real_t s_worst, t_worst;     /* and of all plants, the nominal one included */
    uint16_t worst_member; /* of s_worst; the number of members where it is the nominal plant */
    /* Product of the factors by which step 3 has lowered the gains of the parts. 1: it had nothing to do. */
    real_t factor;
    uint32_t frequencies; /* looked at */
    uint16_t passes;      /* each has tried every move */

    /* Work: 14 KiB (float) */
    const struct interact_plant *plant;
    struct robust_config config;
    struct robust_limits limits;
    struct loops
        part; /* being searched: settings under trial; those of `loops` are the last good ones */
    uint8_t place[INTERACT_MAX]; /* loop k of `part` is this one of `loops` */
    real_t part_gain_most[INTERACT_MAX];
    uint16_t done;                  /* bit k: loop k is of a part that is done */
    uint16_t active[ROBUST_ACTIVE]; /* plants of the climb: 0 the nominal one, else member + 1 */
    uint8_t chosen[INTERACT_MAX];   /* moves of the last pass, the best first */
    uint16_t judged, worst;         /* plant, numbered likewise */
    real_t worst_excess, step, margin, omega_lo, omega_hi, widened;
    uint16_t part_passes;
    uint8_t actives, at_active, choices, moved, moved_most, retreats, tries, rounds;
    uint8_t stage, goal, drawn; /* rows of the member that are drawn */
    bool joint, changed;
    struct interact_plant member;
    union {
        struct nyquist nyquist;
        struct robust_pass pass;
    } work;
};

/* start: loops to begin with, PI without derivative (detune); their decoupler and plant must live and stay as they are.
 * ERR_RANGE, ERR_NOT_FINITE: as interact_check, loops_check, or for config (reason, which may be NULL, says). Then
 * robust_step until it is not ERR_BUSY: at most about 2e5 instructions a call. ERR_TIMEOUT from it: no gains
 * keep the bounds on plant number worst_member; the settings are those before step 3. */
MUST_CHECK enum err robust_begin(struct robust *r, const struct interact_plant *plant,
                                 const struct loops *start, const struct robust_config *config,
                                 struct interact_refusal *reason);
MUST_CHECK enum err robust_step(struct robust *r);

#endif
