/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs/output_settings.h"

#include "base/assertion.h"
#include "outputs/output_numbers.h"

#define WINDOW  OUTPUT_BIT(OUTPUT_WINDOW)
#define BURST   OUTPUT_BIT(OUTPUT_BURST)
#define RELAY   OUTPUT_BIT(OUTPUT_RELAY)
#define PWM     OUTPUT_BIT(OUTPUT_PWM)
#define ANALOG  OUTPUT_BIT(OUTPUT_ANALOG)
#define STEPPER OUTPUT_BIT(OUTPUT_STEPPER)
#define VALVE   OUTPUT_BIT(OUTPUT_MOTOR_VALVE)
#define ENABLE  OUTPUT_BIT(OUTPUT_ENABLE)
#define CHIP    OUTPUT_BIT(OUTPUT_AD5422)
#define DRIVEN  (WINDOW | BURST | RELAY | PWM | ANALOG | STEPPER | VALVE | CHIP)

#define NUMBER(field, id, unit, types, lo, hi, initial, help)                                      \
    {#field, unit, help, (uint16_t)offsetof(struct output_settings, field), types, lo, hi, initial},

const struct output_number output_numbers[] = {OUTPUT_NUMBERS(NUMBER)};

const size_t output_number_count = sizeof output_numbers / sizeof *output_numbers;

/* In the order of enum output_type. */
static const struct {
    const char *name;
    uint8_t pins, needed; /* bits of enum output_pin */
} types[OUTPUT_TYPES] = {{"none", 0, 0},    {"window", 1, 1},       {"burst", 17, 1},
                         {"relay", 1, 1},   {"pwm", 1, 1},          {"analog", 1, 1},
                         {"stepper", 3, 1}, {"motor_valve", 15, 3}, {"enable", 1, 1},
                         {"ad5422", 3, 3}};

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
