/* Pins of the board, by number. The console and wiring files write them as the maker does: PA4, PB10.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HAL_PIN_H
#define REFLUX_HAL_PIN_H

#include <stdbool.h>
#include <stdint.h>

typedef uint8_t hal_pin; /* 16 x port + number: PA0 is 0, PB0 16 */

#define HAL_PIN_NONE          0xFFu
#define HAL_PIN(port, number) ((hal_pin)(((port) - 'A') * 16 + (number)))

enum hal_pin_use {
    HAL_PIN_CLOSED,       /* input, nothing connected: as after a reset */
    HAL_PIN_INPUT,        /* floating */
    HAL_PIN_INPUT_PULLED, /* pulled up: dry contact to ground */
    HAL_PIN_OUTPUT        /* low until it is set */
};

/* Whether a device may have this pin: the board has it, and neither the debugger, the boot loader, the console nor the link needs it. */
bool hal_pin_is_free(hal_pin pin);

/* Sets the use of a free pin. Outputs that are on go off first. */
void hal_pin_use(hal_pin pin, enum hal_pin_use use);

/* True: high. Callable from every context. */
bool hal_pin_read(hal_pin pin);

/* Sets an output. Callable from every context; one call changes nothing of another pin. */
void hal_pin_write(hal_pin pin, bool high);

#endif
