/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs/output_kind.h"

#include <stddef.h>

#include "base/assertion.h"

static const struct output_kind *const output_kinds[OUTPUT_TYPES] = {
    [OUTPUT_WINDOW] = &window_output,
    [OUTPUT_RELAY] = &relay_output,
    [OUTPUT_ENABLE] = &enable_output,
    OUTPUT_FURTHER([OUTPUT_BURST] = &burst_output, [OUTPUT_PWM] = &pwm_output,
                   [OUTPUT_ANALOG] = &analog_output, [OUTPUT_STEPPER] = &stepper_output,
                   [OUTPUT_MOTOR_VALVE] = &motor_valve_output, [OUTPUT_AD5422] = &ad5422_output)};

const char *output_fault_text(uint8_t number)
{
    switch (number != 0 ? 1u << (number - 1u) : 0) {
    case OUTPUT_NO_CHIP:
        return "no chip answers, or not with what it was given";
    case OUTPUT_LOOP_OPEN:
        return "no current flows";
    case OUTPUT_HOT:
        return "chip too hot";
    case OUTPUT_NO_CROSSING:
        return "no zero crossings of the mains";
    default:
        return "?";
    }
}

const struct output_kind *output_kind(uint8_t type)
{
    REFLUX_ASSERT(type < OUTPUT_TYPES);
    return output_kinds[type];
}
