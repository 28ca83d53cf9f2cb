/* Do loops with integral action stay together when any of them are in manual? Every subset of them must have a positive
 * Niederlinski index: with gains of rows divided by their pair's, all principal minors are positive (decentralised integral
 * controllability wants that: P. Grosdidier, M. Morari and B. R. Holt, Ind. Eng. Chem. Fundam. 24 (1985) 221).
 *
 * 2^n - 1 subsets of n loops, each found from one with a loop less by a single step of Gaussian elimination (as K. Griffin and
 * M. J. Tsatsomeros, Linear Algebra Appl. 419 (2006) 107, order them): 2^n times a dozen products in all, not n^3 for each.
 * The first subset that is not positive ends it. */
#ifndef REFLUX_INTERACT_INTEGRITY_H
#define REFLUX_INTERACT_INTEGRITY_H

#include <stdbool.h>

#include "interact/plant.h"

/* Elements of the matrices of n, n - 1 .. 1 rows, for n = INTERACT_MAX. */
#define INTEGRITY_ELEMENTS (INTERACT_MAX * (INTERACT_MAX + 1) * (2 * INTERACT_MAX + 1) / 6)

/* 6 KiB (float). */
struct integrity {
    /* Results */
    /* Bit k: pair k belongs to the subset whose index is not positive; 0: there is none. */
    uint16_t negative;
    real_t index; /* its Niederlinski index */
    /* Work: at level d the loops before pair d are in the subset or out of it; what is left of the others' gains. */
    uint8_t n, level;
    uint16_t included;
    uint8_t tried[INTERACT_MAX]; /* at each level: 0 nothing, 1 with this pair, 2 without it */
    uint16_t from[INTERACT_MAX]; /* first element of the level's matrix */
    real_t element[INTEGRITY_ELEMENTS];
};

/* Row pairs->output[k] and column pairs->input[k] are pair k's. ERR_RANGE: no pairs, or more than the matrix has;
 * ERR_SINGULAR: the gain of a pair is 0. Then integrity_step() until it is not ERR_BUSY: at most 1e5 instructions a call, 280
 * calls for 16 pairs. */
MUST_CHECK enum err integrity_begin(struct integrity *w, const struct matrix *gains,
                                    const struct pairs *pairs);
MUST_CHECK enum err integrity_step(struct integrity *w);

/* The same of every two pairs alone, at once: whether there is no negative index. */
bool integrity_of_two(const struct matrix *gains, const struct pairs *pairs);

#endif
