/* Record of one experiment in fixed memory: at most RECORD_POINTS points per output, each the mean of a block of
 * samples. When it is full, neighbours are averaged and the block doubles. So the resolution is always between 1/64
 * and 1/128 of what has passed, and nothing is thrown away.
 *
 * Point i is the mean of samples i block .. (i + 1) block - 1; samples count from 0 at record_begin(). Samples after the
 * last whole block wait, and belong to no point yet.
 */
#ifndef REFLUX_IDENTIFY_RECORD_H
#define REFLUX_IDENTIFY_RECORD_H

#include <stdint.h>

#include "base/channel.h"
#include "base/error.h"
#include "identify/excitation.h"
#include "num/real.h"

#ifndef RECORD_POINTS
#define RECORD_POINTS 128 /* even */
#endif

struct record {
    uint32_t outputs;
    real_t h_s;
    uint32_t samples;              /* taken since begin */
    uint32_t block;                /* samples per point: a power of two */
    uint32_t points;               /* whole ones */
    uint32_t waiting;              /* samples in the sums */
    struct excitation input;       /* edges by sample */
    real_t reference[CHANNEL_MAX]; /* taken off every sample */
    real_t sum[CHANNEL_MAX];
    real_t y[CHANNEL_MAX][RECORD_POINTS]; /* deviations from reference */
};

/* outputs 1 to CHANNEL_MAX; h_s [1e-3, 1e5] s. ERR_RANGE, ERR_NOT_FINITE: *r unchanged. */
MUST_CHECK enum err record_init(struct record *r, uint32_t outputs, real_t h_s);

/* Empty, input at rest. reference: a value near each output's level. ERR_NOT_FINITE: *r unchanged. */
MUST_CHECK enum err record_begin(struct record *r, const real_t *reference);

/* One sample of every output. ERR_NOT_FINITE, ERR_RANGE (more than 1e12 from reference): *r unchanged; ERR_FULL after 2^31 samples. A tick costs one addition an
 * output; every 64 blocks one of them also averages 64 pairs an output. */
MUST_CHECK enum err record_step(struct record *r, const real_t *y);

/* The input moves to level (deviation) right after the latest sample. ERR_EMPTY before the first; ERR_NOT_FINITE,
 * ERR_FULL. */
MUST_CHECK enum err record_move(struct record *r, real_t level);

/* Middle of point i, s from sample 0. */
real_t record_time(const struct record *r, uint32_t i);

/* Sample of the first edge; 0 when there is none yet. */
uint32_t record_first_edge(const struct record *r);

#endif
