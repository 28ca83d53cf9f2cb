/* Which input controls which output, and how sure that is: docs/methods/interaction.md.
 *
 * 1. A plant with more outputs than inputs keeps as many outputs as it has inputs, those with the largest sums of
 *    relative gains over their row (Chang and Yu 1990; the sum is the squared length of the output's projection on what
 *    the inputs can reach); with more inputs, inputs by their columns.
 * 2. Of the square rest, the assignment of least sum of |ln lambda|: 0.5 is as far from 1 as 2. A pair needs a relative
 *    gain of at least smallest_lambda, so never a negative one or 0, and every subset of the loops a positive Niederlinski
 *    index (interact/integrity.h); where the best has not, the next best is tried (Murty, Operations Research 16 (1968)
 *    682), PAIRING_TRIES of them.
 * 3. The same is done with gains drawn at random about the estimates. The share of draws that give the same pairs is the
 *    pairing's probability; below the confidence wanted it is not determined, and the pairs that differ are named. Of a
 *    draw only the index of all loops together has to be positive. Where the same pairs come out its subsets are looked at,
 *    too (of more than PAIRING_SUBSETS loops every two): the share of draws without a negative one is the integrity,
 *    and below the least of that it is not determined either. Less is asked of it, for less is at stake: the loops run
 *    together, and only with some in manual would the others run away.
 * 4. The determinant of the gains must stand out of its own error by determinant_sds: nearer to 0, its sign, and with it
 *    every relative gain's, is not known, however the errors of the draws may be distributed. */
#ifndef REFLUX_INTERACT_PAIRING_H
#define REFLUX_INTERACT_PAIRING_H

#include <stdbool.h>
#include <stdint.h>

#include "interact/integrity.h"
#include "interact/ranked_assignment.h"
#include "interact/rga.h"
#include "num/random.h"

#define PAIRING_TRIES   16
#define PAIRING_SUBSETS 8

struct pairing_config {
    real_t smallest_lambda; /* 0.001 to 1 */
    real_t floor;           /* relative standard deviation of a gain at least: 1e-4 to 0.5 */
    real_t confidence;      /* above 0.5, below 1 */
    real_t determinant_sds; /* standard deviations: 0 to 20 */
    real_t integrity;       /* 0 to 0.9999 */
    uint16_t draws;         /* 20 to 10000 */
    uint64_t seed;
    uint16_t outputs_out, inputs_out; /* bit i set: this one is not to be used */
    uint16_t apart[INTERACT_MAX];     /* output i: bit j set, it and input j are no pair */
};

enum pairing_verdict {
    PAIRING_DETERMINED,
    PAIRING_UNDETERMINED, /* the gains are not known well enough; pairs are the best guess */
    /* No relative gains at the estimates: rank not full. No pairs; shares and rivals are about the most frequent pairs
     * of draws, which then have errors of at least 0.1 %. */
    PAIRING_SINGULAR,
    /* No pairs with positive relative gains and positive Niederlinski indices of all subsets. Where only a part of the loops
     * is in the way, `negative` says which, and pairs are those that would be the best otherwise. */
    PAIRING_IMPOSSIBLE
};

/* 14 KiB (float). */
struct pairing {
    /* Results */
    enum pairing_verdict verdict;
    struct pairs pairs; /* outputs ascending */
    real_t lambda[INTERACT_MAX], niederlinski;
    real_t cost; /* sum of |ln lambda|, to 1e-4 a pair */
    /* Magnitude of the determinant of the gains of the channels kept, in its own standard deviations; 0: none. */
    real_t determinant;
    uint16_t negative; /* bit k: pair k is in the subset of loops that is in the way; 0: none is */
    real_t negative_index; /* its Niederlinski index */
    real_t probability;    /* share of draws that gave exactly these pairs */
    real_t integrity;      /* of those the share without a negative subset */
    real_t channels; /* share of draws that keep the same outputs and inputs, however paired */
    /* By output: share of draws that gave it its input (or left it out, where the pairs do), and the input it got most
     * often otherwise; INTERACT_MAX: left out, INTERACT_NONE: it always got the same. */
    real_t share[INTERACT_MAX];
    uint8_t rival[INTERACT_MAX];
    uint16_t ambiguous_outputs;    /* bit i: share below the confidence */
    uint16_t ambiguous_inputs;     /* theirs, and their rivals */
    uint16_t drawn, drawn_no_pair; /* draws so far; of them without admissible pairs */

    /* Work */
    struct pairing_config config;
    const struct interact_plant *plant;
    struct random random;
    struct matrix gains, square, lambda_all;
    union {
        struct rga_work rga;
        struct integrity integrity;
    } work;
    real_t index;
    struct ranked_assignment ranked;
    uint16_t agreed, fragile, same_channels, count[INTERACT_MAX][INTERACT_MAX + 1];
    struct pairs kept; /* channels of the square plant, ascending; not paired */
    real_t floor;
    bool drawing;
    uint8_t stage, tries;
};

/* smallest_lambda 0.02, floor 0.005, confidence 0.95, determinant_sds 2, integrity 0.9, 400 draws, seed 1, every channel. 400 draws settle a probability of
 * 0.95 to about 0.01 (one standard deviation). */
void pairing_config_default(struct pairing_config *config);

/* ERR_RANGE and ERR_NOT_FINITE as interact_check, or for config (why says what); ERR_EMPTY: no channel left. plant must
 * live and stay as it is until the end. Then pairing_step until it is not ERR_BUSY: at most 2e5 instructions a call. */
MUST_CHECK enum err pairing_begin(struct pairing *p, const struct interact_plant *plant,
                                  const struct pairing_config *config,
                                  struct interact_refusal *reason);
MUST_CHECK enum err pairing_step(struct pairing *p);

#endif
