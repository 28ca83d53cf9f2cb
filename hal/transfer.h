/* A piece of traffic on one of the board's buses (hal/spi.h, hal/i2c.h, hal/onewire.h).
 *
 * Rules
 *  1. Nothing here waits. A call of hal_*_start() begins the transfer; interrupts of the bus do the rest.
 *  2. The board clock alone starts transfers and looks at their state (app/board_clock.h), once a millisecond. One at a time on each bus.
 *  3. The transfer and its buffers belong to the caller, and stay where they are until state is no longer TRANSFER_RUNS.
 *  4. What comes is complete, or the transfer has failed: then the bytes in `in` mean nothing.
 *  5. A transfer that does not end in the time that its caller allows is ended by hal_*_stop(), which leaves the bus free for the next one.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HAL_TRANSFER_H
#define REFLUX_HAL_TRANSFER_H

#include <stdint.h>

enum transfer_state {
    TRANSFER_IDLE, /* not begun */
    TRANSFER_RUNS,
    TRANSFER_DONE,
    TRANSFER_NO_ANSWER, /* I2C: no acknowledgement of the address; 1-wire: no presence pulse */
    TRANSFER_FAILED     /* any other error of the bus */
};

struct transfer {
    const uint8_t *out; /* bytes that go out first */
    uint8_t *in;        /* bytes that come in after them */
    uint8_t n_out, n_in;
    volatile uint8_t state; /* enum transfer_state */
};

#endif
