/* Pins of an STM32 for the drivers of its buses and outputs.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32_PIN_MAP_H
#define REFLUX_STM32_PIN_MAP_H

#include "board_pins.h"

#define PIN_PORT(pin)   ((uint32_t)(pin) / 16u)
#define PIN_NUMBER(pin) ((uint32_t)(pin) % 16u)

/* As the STM32F405 counts them (RM0090 8.4.1). */
enum pin_mode { PIN_INPUT, PIN_OUTPUT, PIN_FUNCTION, PIN_ANALOG };
/* PIN_LISTENS: the line of a bus or timer that comes in, which some chips must know. */
enum pin_kind { PIN_PUSH_PULL, PIN_OPEN_DRAIN, PIN_LISTENS };

/* pin_modes.c, each port's own: starts the clock of a port, A is 0. */
void pin_start_clock(uint32_t port);
/* pin_modes.c: sets all of a pin but its level, which an output has already. function: as pin_give(). Interrupts that set pins of the same port
 * are held off. */
void pin_set(hal_pin pin, enum pin_mode mode, unsigned function, enum pin_kind kind,
             bool pulled_up);

/* Gives a pin to the alternate function 0 to 15 of a bus or timer, free or not; a pull-up where the line may be left open. A chip on which pins
 * have one function each looks at `kind` alone, and has no pull-up beside an open drain. */
void pin_give(hal_pin pin, unsigned function, enum pin_kind kind, bool pulled_up);
/* pin_modes.c, of the STM32F405: whether it is given to this function now. */
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
