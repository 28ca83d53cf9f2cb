/* Analogue inputs of the chip itself, converted in the background.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HAL_ANALOG_H
#define REFLUX_HAL_ANALOG_H

#include "base/error.h"
#include "hal/pin.h"

#define HAL_ANALOG_FULL 65535u

/* Whether this pin has an analogue input. */
bool hal_analog_has(hal_pin pin);

/* Makes the pin an analogue input, which is converted once a millisecond from now on. ERR_RANGE: it has none. ERR_FULL: too many. */
enum err hal_analog_open(hal_pin pin);

/* Mean of the last 16 conversions in 1/65535 of the reference. False: there are none yet. Callable from clock and tick. */
bool hal_analog_read(hal_pin pin, uint16_t *code);

/* Voltage of the reference, V, from the chip's own one; 0: not known. */
float hal_analog_reference(void);

#endif
