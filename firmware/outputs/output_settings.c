/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs/output_settings.h"

#include "base/assertion.h"

#define WINDOW  OUTPUT_BIT(OUTPUT_WINDOW)
#define BURST   OUTPUT_BIT(OUTPUT_BURST)
#define RELAY   OUTPUT_BIT(OUTPUT_RELAY)
#define PWM     OUTPUT_BIT(OUTPUT_PWM)
#define ANALOG  OUTPUT_BIT(OUTPUT_ANALOG)
#define STEPPER OUTPUT_BIT(OUTPUT_STEPPER)
#define VALVE   OUTPUT_BIT(OUTPUT_MOTOR_VALVE)
#define ENABLE  OUTPUT_BIT(OUTPUT_ENABLE)
#define DRIVEN  (WINDOW | BURST | RELAY | PWM | ANALOG | STEPPER | VALVE)

#define NUMBER(field, unit, types, lo, hi, initial, help)                                          \
    {                                                                                              \
#field, unit, help, (uint16_t)offsetof(struct output_settings, field), types, lo, hi,      \
            initial                                                                                \
    }

const struct output_number output_numbers[] = {
    NUMBER(dead_man, "s", DRIVEN, 0.5f, 2.0f, 2.0f,
           "time without a command after which the output goes to its safe position"),
    NUMBER(safe, "", ANALOG | VALVE, 0.0f, 1.0f, 0.0f,
           "safe position, fraction of the command's span; other outputs are off"),
    NUMBER(period, "s", WINDOW, 0.1f, 120.0f, 2.0f, "period of the window"),
    NUMBER(least_on, "s", WINDOW | RELAY, 0.0f, 60.0f, 0.02f,
           "shortest time on; what is missing or too much is carried over"),
    NUMBER(least_off, "s", WINDOW | RELAY | ENABLE, 0.0f, 600.0f, 0.02f,
           "shortest time off; kept after a reset too"),
    NUMBER(cycles, "", BURST, 1.0f, 60.0f, 3.0f,
           "whole cycles of the mains that are on or off together; at 60 Hz a multiple of 3"),
    NUMBER(hysteresis, "", RELAY, 0.0f, 0.98f, 0.1f,
           "on above 0.5 and half of this, off below 0.5 less half of this"),
    NUMBER(frequency, "Hz", PWM | ANALOG, 1.0f, 100000.0f, 1000.0f, "frequency of the pulse width"),
    NUMBER(gain, "", ANALOG, -1.0f, 1.0f, 1.0f, "change of the output's span over the command's"),
    NUMBER(offset, "", ANALOG, 0.0f, 1.0f, 0.0f, "output, fraction of its span, at command 0"),
    NUMBER(flow, "l/h", STEPPER, 0.001f, 1000.0f, 1.0f, "flow at command 1"),
    NUMBER(steps, "1/ml", STEPPER, 0.01f, 100000.0f, 100.0f, "steps that pump a millilitre"),
    NUMBER(ramp, "1/s2", STEPPER, 50.0f, 10000.0f, 500.0f,
           "largest change of speed, steps/s each second"),
    NUMBER(travel, "s", VALVE, 1.0f, 600.0f, 60.0f, "time from one end to the other"),
    NUMBER(dead_band, "", VALVE, 0.001f, 0.2f, 0.01f,
           "the valve stays where it is while the command is no further away"),
    NUMBER(pause, "s", VALVE, 0.05f, 10.0f, 0.5f, "rest of the motor before it turns back")};

const size_t output_number_count = sizeof output_numbers / sizeof *output_numbers;

/* In the order of enum output_type. */
static const struct {
    const char *name;
    uint8_t pins, needed; /* bits of enum output_pin */
} types[OUTPUT_TYPES] = {{"none", 0, 0},    {"window", 1, 1},       {"burst", 1, 1},
                         {"relay", 1, 1},   {"pwm", 1, 1},          {"analog", 1, 1},
                         {"stepper", 3, 1}, {"motor_valve", 15, 3}, {"enable", 1, 1}};

void output_settings_init(struct output_settings *s)
{
    *s = (struct output_settings){.type = OUTPUT_NONE};
    for (unsigned k = 0; k < OUTPUT_PINS; k++)
        s->pin[k] = HAL_PIN_NONE;
    for (size_t k = 0; k < output_number_count; k++)
        *(float *)(void *)((char *)s + output_numbers[k].offset) = output_numbers[k].initial;
}

float output_number(const struct output_settings *s, const struct output_number *number)
{
    return *(const float *)(const void *)((const char *)s + number->offset);
}

const char *output_type_name(uint8_t type)
{
    REFLUX_ASSERT(type < OUTPUT_TYPES);
    return types[type].name;
}

bool output_uses(uint8_t type, enum output_pin pin)
{
    REFLUX_ASSERT(type < OUTPUT_TYPES);
    return (types[type].pins & 1u << pin) != 0;
}

bool output_needs(uint8_t type, enum output_pin pin)
{
    REFLUX_ASSERT(type < OUTPUT_TYPES);
    return (types[type].needed & 1u << pin) != 0;
}
