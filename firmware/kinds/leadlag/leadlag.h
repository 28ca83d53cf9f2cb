/* The kind `leadlag` is feedforward from several disturbances to several MVs, a sum of terms,
 *
 *     u_p = sum of K (lead s + 1)/(lag s + 1) exp(-dead s) (d_k - reference)
 *
 * each term from one input to one MV, with exact dead time. The form is that of the element ffN (block/feedforward.h); what is
 * more: several inputs and MVs, a dead band against the noise of a sensor, a washout of slow changes, limits of the sum and of how fast it
 * moves, and an input that is lost is held for a while before the element gives up. All in fractions of span. docs/methods/feedforward.md */
#ifndef REFLUX_LEADLAG_LEADLAG_H
#define REFLUX_LEADLAG_LEADLAG_H

#include "block/block.h"

#if CONFIG_BLOCKS

#define LEADLAG_TERMS  8
#define LEADLAG_INPUTS 8
#define LEADLAG_MVS    4

struct leadlag_settings {
    /* MV span per span of the input; 0: the term is off. */
    float gain[LEADLAG_TERMS];
    float lead_s[LEADLAG_TERMS], lag_s[LEADLAG_TERMS], dead_s[LEADLAG_TERMS];
    /* Value of the input that calls for nothing, EU. */
    float reference[LEADLAG_TERMS];
    /* Limits of what is added, fraction of the MV's span. */
    float lo[LEADLAG_MVS], hi[LEADLAG_MVS];
    /* Fraction of span per s; 0: any. */
    float rate[LEADLAG_MVS];
    /* Largest lead/(lag + h): by how much a jump is more at first than at rest. */
    float kick;
    /* A change that stays so long calls for less and less; 0: none. */
    float washout_s;
    /* Time for which an input that is lost stays what it was. */
    float hold_s;
    /* Number of the input, of the MV; 0: no term. */
    uint16_t from[LEADLAG_TERMS], to[LEADLAG_TERMS];
    /* EU of the input; d_k follows the input at this distance. */
    float dead_band[LEADLAG_TERMS];
};

extern const struct block_kind leadlag_kind;

#endif
#endif
