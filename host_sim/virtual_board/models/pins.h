/* Pins as other models see them: by number, PA0 is 0, PB0 16.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_PINS_H
#define REFLUX_VIRTUAL_BOARD_PINS_H

#include "models.h"

#define PIN_NUMBER(port, number) ((unsigned)((port) - 'A') * 16u + (number))

/* State of a part of pins: what the world has been told that they drive. */
struct pins_state {
    enum pin_drive drives[16];
};
#define PINS_STATE_BYTES sizeof(struct pins_state)
/* After anything that may have changed what the part's pins drive: tells the world. */
void pins_look(struct part *p);
/* Levels of the part's pins, a bit each. */
uint32_t pins_seen(struct part *p);

/* The pin is given to this alternate function. */
bool pin_has_function(struct board *b, unsigned pin, uint8_t function);
/* It drives low only. */
bool pin_is_open_drain(struct board *b, unsigned pin);
/* Code of its speed, of edges: 0 is the slowest. */
unsigned pin_speed(struct board *b, unsigned pin);
/* It is an analogue pin. */
bool pin_is_analog(struct board *b, unsigned pin);
/* Level at the pin, from what the board drives and what the world does. */
bool pin_level(struct board *b, unsigned pin);

/* exti.c: the pin's level may be another. */
void exti_look(struct board *b, unsigned pin);
/* pwm.c: pins were given to timers, or taken from them. */
void pwm_look(struct board *b);
/* i2c.c: a pin of a bus is moved by hand; whether the world holds a pin of a bus low. */
void i2c_pin_moved(struct board *b, unsigned pin, enum pin_drive drive);
bool i2c_holds_pin(struct board *b, unsigned pin);

#endif
