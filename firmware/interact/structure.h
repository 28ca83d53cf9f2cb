/* The couplings of a plant that count: independent parts, triangular order, and blocks that need more than single loops.
 *
 * An effect counts when its gain stands out of its error, |K| > significance sd, and is not negligible. Negligible is
 * what is small both beside the largest gain of its row and in the equilibrated matrix (there, small products around a
 * ring stay small); either alone would depend on the spans chosen. */
#ifndef REFLUX_INTERACT_STRUCTURE_H
#define REFLUX_INTERACT_STRUCTURE_H

#include <stdbool.h>

#include "interact/rga.h"

struct structure_config {
    real_t significance; /* standard deviations: 0 to 20 */
    real_t negligible;   /* 0 to 0.5 */
    real_t lambda_lo;    /* single loops want a relative gain of their pair from here, 0 to 1, */
    real_t lambda_hi;    /* to here, 1 to 100 */
    real_t grouped;      /* |lambda| off the pairs that joins two pairs to a group: 0.01 to 1 */
};

/* Part of the plant whose loops all act on each other, round some ring. */
struct block {
    uint16_t pairs;     /* bit k: pair k of the pairing belongs to it */
    uint16_t driven_by; /* bit b: block b, an earlier one, disturbs it: feedforward */
    uint8_t size;       /* pairs */
    uint8_t part;       /* blocks of one number are coupled, of different numbers independent */
    uint16_t mimo;      /* pairs that single loops will not serve well: bits as in pairs */
    /* Relative gain, within the block, of the pair furthest from 1; 0 where the block has none (singular). */
    real_t worst_lambda;
};

struct structure {
    uint16_t effect[INTERACT_MAX];    /* output i: bit j, input j has an effect */
    uint16_t uncertain[INTERACT_MAX]; /* bit j: not seen, but its error leaves room for one */
    uint8_t parts; /* independent subprocesses; channels without any effect are not counted */
    uint16_t part_outputs[INTERACT_MAX], part_inputs[INTERACT_MAX];
    uint8_t blocks; /* of the paired plant; each is driven by earlier ones only */
    struct block block[INTERACT_MAX];
    uint8_t pair_block[INTERACT_MAX]; /* pair k is in this block */
};

/* From an input to another loop's manipulated variable: gain (lead s + 1)/(lag s + 1) exp(-dead s), the FOPDT quotient
 * -G_ij/G_ii. lead_s much above lag_s amplifies noise. */
struct cross_way {
    uint8_t from, to; /* pairs */
    real_t gain, lead_s, lag_s, dead_s;
    real_t late_s; /* above 0: the disturbance comes that much before any correction; dead_s is 0 */
};

/* significance 3, negligible 0.03, lambda 0.5 to 5, grouped 0.15. */
void structure_config_default(struct structure_config *config);

/* pairs: the pairing, for blocks; with n = 0 only effects and parts are found. ERR_RANGE: config or pairs out of range;
 * otherwise as interact_check. */
struct structure_work {
    struct rga_work rga;
    struct matrix gains, lambda;
};
MUST_CHECK enum err structure_detect(const struct interact_plant *plant, const struct pairs *pairs,
                                     const struct structure_config *config,
                                     struct structure_work *work, struct structure *result);

/* Feedforward that a triangular plant wants: into pair `to` (of a later block) from the input of pair `from` (of an
 * earlier one). ERR_EMPTY: there is no effect, or both are in one block. */
MUST_CHECK enum err structure_cross_way(const struct interact_plant *plant,
                                        const struct pairs *pairs, const struct structure *s,
                                        uint8_t from, uint8_t to, struct cross_way *way);

#endif
