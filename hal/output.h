/* Outputs of the board: pins that switch, and pins with a pulse width. What an element does with them is firmware/outputs.
 *
 * Rules
 *  1. After a reset, and until it is opened, a pin is an input; a pull resistor on the board holds it off.
 *  2. hal_output_safe() may be called from everywhere, takes no time worth counting, and switches all outputs off at once: before the flash
 *     is erased, and where the firmware ends for good.
 *  3. When the clock of the board stands, nothing calls any more: the watchdog resets the chip and rule 1 holds.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HAL_OUTPUT_H
#define REFLUX_HAL_OUTPUT_H

#include "base/error.h"
#include "hal/pin.h"

#define HAL_PWM_FULL 65535u

/* Makes the pin an output that is off. `low`: it is on when the pin is low. ERR_RANGE: not a free pin. */
enum err hal_output_open(hal_pin pin, bool low);
void hal_output_set(hal_pin pin, bool on);

/* What gives a pin its pulse width. Outputs of one timer have one frequency, and only one pin of a channel can be an output. */
struct hal_pwm_place {
    uint8_t timer, channel; /* numbers of the port's own */
};
/* Where the pulse width of this pin comes from. False: no timer at this pin, or not with this frequency. */
bool hal_pwm_find(hal_pin pin, uint32_t hz, struct hal_pwm_place *place);

/* Makes the pin a pulse-width output of 0. ERR_RANGE: no timer at this pin, or not with this frequency. ERR_FULL: its timer has another one. */
enum err hal_pwm_open(hal_pin pin, uint32_t hz, bool low);
void hal_pwm_set(hal_pin pin, uint16_t part); /* of HAL_PWM_FULL */

void hal_output_safe(void);

#endif
