/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs/output_kind.h"

#include "base/assertion.h"

/* In the order of enum output_type. */
static const struct output_kind *const output_kinds[OUTPUT_TYPES] = {
    NULL,           &window_output,  &burst_output,       &relay_output, &pwm_output,
    &analog_output, &stepper_output, &motor_valve_output, &enable_output};

const struct output_kind *output_kind(uint8_t type)
{
    REFLUX_ASSERT(type < OUTPUT_TYPES);
    return output_kinds[type];
}
