/* Settings of the board's outputs: what each means, its range and what it is at first.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_OUTPUTS_OUTPUT_SETTINGS_H
#define REFLUX_OUTPUTS_OUTPUT_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/pin.h"
#include "outputs/output_limits.h"

/* The numbers are stored: a new type goes to the end. */
enum output_type {
    OUTPUT_NONE,
    OUTPUT_WINDOW,      /* solid-state relay or contactor: on for a part of each period */
    OUTPUT_BURST,       /* solid-state relay that switches at zero: whole cycles of the mains */
    OUTPUT_RELAY,       /* on above one half, off below */
    OUTPUT_PWM,         /* pulse width of the pin itself */
    OUTPUT_ANALOG,      /* 0-10 V from a pulse width and a filter */
    OUTPUT_STEPPER,     /* pump with a stepper motor and a driver with step and direction */
    OUTPUT_MOTOR_VALVE, /* motor that turns a valve both ways, with or without end switches */
    OUTPUT_ENABLE,      /* contactor in series with all heaters; takes no command */
    OUTPUT_AD5422,      /* chip with a current or a voltage: 4-20 mA, 0-10 V */
    OUTPUT_TYPES
};

#define OUTPUT_BIT(type) ((uint16_t)(1u << (type)))

/* Pins that an output may have, by index of output_settings.pin[]. */
enum output_pin {
    OUTPUT_PIN, /* switches; the pulse width; a step; the motor that opens; a chip's clear */
    OUTPUT_SECOND_PIN, /* stepper: direction (may be missing); motor valve: the motor that closes; a chip's select */
    OUTPUT_OPEN_END, /* motor valve: contact to ground that is closed when the valve is open (may be missing) */
    OUTPUT_CLOSED_END, /* ... when it is closed (may be missing) */
    OUTPUT_CROSSING,   /* burst: falls at zero crossings of the mains (may be missing) */
    OUTPUT_PINS
};

/* Words of out.range, in their order. */
enum output_range {
    OUTPUT_4_20_MA,
    OUTPUT_0_20_MA,
    OUTPUT_0_24_MA,
    OUTPUT_0_5_V,
    OUTPUT_0_10_V,
    OUTPUT_RANGES
};

struct output_settings {
    uint8_t type; /* enum output_type */
    hal_pin pin[OUTPUT_PINS];
    bool low;      /* outputs are on when the pin is low */
    bool heater;   /* behind the enable output: safe while that one is off */
    bool mains_60; /* burst: 60 Hz instead of 50 */
    bool reverse;  /* stepper: the direction pin is on */
    uint8_t bus;   /* chip: of SPI, from 1; 0: none */
    uint8_t range; /* chip: enum output_range */
    /* Numbers: output_numbers[] says what they mean. */
    float dead_man, safe;
    float period, least_on, least_off;
    OUTPUT_FURTHER(float cycles;)
    float hysteresis;
    OUTPUT_FURTHER(float frequency; float gain, offset; float flow, steps, ramp;
                   float travel, dead_band, pause;)
};

/* A number among the settings. */
struct output_number {
    const char *name, *unit; /* at the console */
    const char *help;
    uint16_t offset; /* in struct output_settings */
    uint16_t types;  /* that use it: OUTPUT_BIT() */
    float lo, hi, initial;
};

extern const struct output_number output_numbers[];
extern const size_t output_number_count;

/* Settings of an output that is not used: no pins, all numbers as at first. */
void output_settings_init(struct output_settings *s);

/* Value of one of the numbers. */
float output_number(const struct output_settings *s, const struct output_number *number);

/* Words of a type at the console, "motor_valve"; never NULL. type < OUTPUT_TYPES. */
const char *output_type_name(uint8_t type);

/* Whether an output of this type uses the pin, and whether the pin may not be missing. type < OUTPUT_TYPES. */
bool output_uses(uint8_t type, enum output_pin pin);
bool output_needs(uint8_t type, enum output_pin pin);

/* Whether an output of this type is a chip on a bus. */
static inline bool output_has_bus(uint8_t type)
{
    return type == OUTPUT_AD5422;
}

#endif
