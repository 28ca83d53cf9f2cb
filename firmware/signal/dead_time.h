/* Dead-time line exp(-L s): the input L seconds ago.
 *
 * L = (whole + fraction) h. Whole steps come from a ring of samples the caller provides, the fraction by
 * straight-line interpolation between two neighbours (error at most max|x''| h^2/8; gain exactly 1 at rest).
 */
#ifndef REFLUX_SIGNAL_DEAD_TIME_H
#define REFLUX_SIGNAL_DEAD_TIME_H

#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "num/num.h"

#define DEAD_TIME_MAX_STEPS 100000u

struct dead_time {
    num_t *ring;
    /* Samples in the ring: whole + 2. */
    uint32_t length;
    /* Full steps of delay. */
    uint32_t whole;
    /* Place of the next sample. */
    uint32_t head;
    /* [0, 1) of one more step. */
    num_t fraction;
};

/* Bytes of ring (aligned for num_t) that dead_time_init will want; 0 if the arguments are refused. */
size_t dead_time_bytes(float dead_time_s, float h_s);

/* Dead time [0, 1e6] s and at most 100000 steps, h [0.001, 1e5] s. A fraction within 1/1024 of a whole step is
 * rounded to it. ring stays the element's while in use. The line is full of 0; call reset for a start
 * without a jump. ERR_RANGE, ERR_NOT_FINITE, ERR_MEMORY (ring NULL or bytes too few): *f unchanged. */
MUST_CHECK enum err dead_time_init(struct dead_time *f, float dead_time_s, float h_s, num_t *ring,
                                   size_t bytes);

/* The ring stands here from now on. Returns the entry behind it. */
num_t *dead_time_place(struct dead_time *f, num_t *ring);

/* The whole line holds value. */
void dead_time_reset(struct dead_time *f, num_t value);

num_t dead_time_step(struct dead_time *f, num_t x);

#endif
