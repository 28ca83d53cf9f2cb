/* One interface for every regulatory control law, SISO or MIMO.
 *
 * All values are num_t fractions of span. The order within a tick is
 *     step     setpoints and measurements in, commanded outputs out (limited by the block itself)
 *     back     the outputs that really took effect, in the coordinates step used; the block brings its state
 *              in line (anti-windup). Always called after step, also when nothing was limited.
 * and, while the block does not act (manual, initialisation, restart),
 *     follow   setpoints, measurements and the outputs in effect: the state is set so that the next step
 *              with the same inputs gives those outputs (bumpless transfer).
 */
#ifndef REFLUX_BLOCK_BLOCK_H
#define REFLUX_BLOCK_BLOCK_H

#include <stddef.h>
#include <stdint.h>

#include "num/num.h"

/* Directions in which output i may not integrate further, because what it drives is at a limit. */
enum block_hold { BLOCK_HOLD_NONE = 0, BLOCK_HOLD_UP = 1, BLOCK_HOLD_DOWN = 2 };

struct block_ops {
    const char *kind; /* "pid" */
    void (*step)(void *state, const num_t *setpoint, const num_t *measurement, num_t *output);
    void (*back)(void *state, const num_t *applied, const uint8_t *hold);
    void (*follow)(void *state, const num_t *setpoint, const num_t *measurement,
                   const num_t *applied);
    /* Number of named internal values, and the i-th (for `loop` on the console): NULL past the end. */
    const char *(*describe)(const void *state, size_t i, float *value);
};

#endif
