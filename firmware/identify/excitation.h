/* The course of an input during one experiment: edges of a piecewise constant signal, on the sample grid.
 *
 * Time is counted in samples of the record that watches it: an edge at sample k takes place right after sample k
 * was read, as the tick does it, so sample k still sees the level before. Levels are deviations from the input
 * held before the experiment, in the input's unit, as applied (after limits), not as commanded.
 */
#ifndef REFLUX_IDENTIFY_EXCITATION_H
#define REFLUX_IDENTIFY_EXCITATION_H

#include <stdint.h>

#include "base/error.h"
#include "num/real.h"

#ifndef EXCITATION_EDGES_MAX
#define EXCITATION_EDGES_MAX 12
#endif

struct excitation {
    uint32_t edges;
    struct {
        uint32_t sample;
        real_t change; /* new level less old level */
    } edge[EXCITATION_EDGES_MAX];
};

/* No edges: the input rests at 0. */
void excitation_clear(struct excitation *u);

/* The input moves to level right after sample, which is not before the last edge. Moves at one sample are one edge; an
 * edge that changes nothing is none. ERR_NOT_FINITE; ERR_STATE (sample before the last edge); ERR_FULL. */
MUST_CHECK enum err excitation_move(struct excitation *u, uint32_t sample, real_t level);

/* Level after the last edge. */
real_t excitation_level(const struct excitation *u);

/* Largest magnitude of the level between any two edges and after the last. */
real_t excitation_peak(const struct excitation *u);

/* Double step (Johansson 1994): +amplitude for t1 samples from sample start, -amplitude for t2, then 0. t1, t2 from 1;
 * *u begins anew. ERR_RANGE, ERR_NOT_FINITE. */
MUST_CHECK enum err excitation_double_step(struct excitation *u, uint32_t start, uint32_t t1,
                                           uint32_t t2, real_t amplitude);

#endif
