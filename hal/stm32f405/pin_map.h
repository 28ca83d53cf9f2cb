/* Pins of the STM32F405 for the drivers of its buses and outputs.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F405_PIN_MAP_H
#define REFLUX_STM32F405_PIN_MAP_H

#include "hal/pin.h"

#define PIN_PORTS       4u
#define PIN_PORT(pin)   ((uint32_t)(pin) / 16u)
#define PIN_NUMBER(pin) ((uint32_t)(pin) % 16u)

enum pin_kind { PIN_PUSH_PULL, PIN_OPEN_DRAIN };

/* Gives a pin to the alternate function 0 to 15 of a bus or timer, free or not; a pull-up where the line may be left open. */
void pin_give(hal_pin pin, unsigned function, enum pin_kind kind, bool pulled_up);
/* Whether it is given to this function now. */
bool pin_is_given(hal_pin pin, unsigned function);
/* Makes it an analogue input. */
void pin_make_analog(hal_pin pin);
/* Makes it a plain output at this level at once, free or not. An open drain has a pull-up. */
void pin_make_output(hal_pin pin, enum pin_kind kind, bool high);

/* Makes it an output of hal/output.h that is off; off_high: off is high. */
void pin_make_switched(hal_pin pin, bool off_high);
/* Switches all outputs that pin_make_switched() has made off. */
void pin_switch_all_off(void);

#endif
