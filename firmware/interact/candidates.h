/* Pairings of the same channels that single loops with integral action could use, in ascending order of the sum of |ln lambda|:
 * every pair has a relative gain of at least smallest_lambda, and the Niederlinski index of all loops together is positive. Of up
 * to CANDIDATES_LOOPS loops all of them, else the first CANDIDATES_OF_MANY. Which of them is best is for a design to say.
 *
 * Two things are found of each:
 *   negative  a subset of its loops whose index is not positive: with the others in manual these loops would run away. A warning,
 *             for the loops run together;
 *   sound     the share of draws of the gains about their estimates in which the pairs would do: every pair's gain keeps its
 *             sign, and the index of all together is positive. */
#ifndef REFLUX_INTERACT_CANDIDATES_H
#define REFLUX_INTERACT_CANDIDATES_H

#include <stdbool.h>
#include <stdint.h>

#include "interact/integrity.h"
#include "interact/ranked_assignment.h"
#include "interact/rga.h"
#include "num/random.h"

#define CANDIDATES_MAX     24
#define CANDIDATES_LOOPS   4u
#define CANDIDATES_OF_MANY 8u
#define CANDIDATES_TRIES   48u /* assignments that are looked at */

struct candidates_config {
    real_t smallest_lambda; /* 0.001 to 1 */
    real_t floor;           /* relative standard deviation of a gain at least: 0 to 0.5 */
    uint16_t draws;         /* 20 to 10000 */
    uint64_t seed;
    uint16_t apart[INTERACT_MAX]; /* output i: bit j set, it and input j are no pair */
};

struct candidate {
    uint8_t input[INTERACT_MAX]; /* of output k of the channels */
    real_t cost;                 /* sum of |ln lambda|, to 1e-4 a pair */
    real_t niederlinski;
    uint16_t negative;     /* bit k: pair k is in the subset that is in the way; 0: there is none */
    uint16_t sound;        /* draws */
    real_t negative_index; /* of that subset */
};

/* About 18 KiB (float). */
struct candidates {
    /* Results */
    uint8_t n; /* how many there are */
    struct candidate list[CANDIDATES_MAX];
    struct matrix lambda; /* of the channels: row k output[k], column l input[l] */
    uint16_t drawn;

    /* Work */
    const struct interact_plant *plant;
    struct candidates_config config;
    struct pairs channels; /* ascending */
    struct random random;
    struct matrix gains;
    real_t index;
    struct ranked_assignment ranked;
    union {
        struct rga_work rga;
        struct integrity integrity;
    } work;
    uint8_t stage, tries;
};

/* channels: 1 to 16 outputs and as many inputs, in any order. plant must live and stay as it is until the end. ERR_RANGE,
 * ERR_NOT_FINITE as interact_check, pairs_check, or for config. Then candidates_step until it is not ERR_BUSY: at most 2e5
 * instructions a call. ERR_SINGULAR from it: the channels have no relative gains. No candidate at all is no error. */
MUST_CHECK enum err candidates_begin(struct candidates *c, const struct interact_plant *plant,
                                     const struct pairs *channels,
                                     const struct candidates_config *config,
                                     struct interact_refusal *reason);
MUST_CHECK enum err candidates_step(struct candidates *c);

/* The pairs of number k, outputs ascending. */
void candidates_pairs(const struct candidates *c, uint8_t k, struct pairs *pairs);

#endif
