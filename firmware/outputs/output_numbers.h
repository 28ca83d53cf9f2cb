/* Numbers among the settings of an output, each declared once: for outputs/output_settings.c and for the parameters of the console.
 * OUTPUT_FURTHER: of types that a board may lack.
 * X(field, id of the parameter from 1, unit, types of output that use it, lowest, highest, value at first, words)
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_OUTPUTS_OUTPUT_NUMBERS_H
#define REFLUX_OUTPUTS_OUTPUT_NUMBERS_H

#include "outputs/output_limits.h"

/* clang-format off */
#define OUTPUT_NUMBERS(X) \
    X(dead_man, 1, "s", DRIVEN, 0.5f, 2.0f, 2.0f, "time without a command after which the output goes to its safe position") \
    X(safe, 2, "", ANALOG | VALVE | CHIP, 0.0f, 1.0f, 0.0f, "safe position, fraction of the command's span; other outputs are off") \
    X(period, 3, "s", WINDOW, 0.1f, 120.0f, 2.0f, "period of the window") \
    X(least_on, 4, "s", WINDOW | RELAY, 0.0f, 60.0f, 0.02f, "shortest time on; what is missing or too much is carried over") \
    X(least_off, 5, "s", WINDOW | RELAY | ENABLE, 0.0f, 600.0f, 0.02f, "shortest time off; kept after a reset too") \
    OUTPUT_FURTHER(X(cycles, 6, "", BURST, 1.0f, 60.0f, 3.0f, "whole cycles of the mains that are on or off together; at 60 Hz a multiple of 3")) \
    X(hysteresis, 7, "", RELAY, 0.0f, 0.98f, 0.1f, "on above 0.5 and half of this, off below 0.5 less half of this") \
    OUTPUT_FURTHER(X(frequency, 8, "Hz", PWM | ANALOG, 1.0f, 100000.0f, 1000.0f, "frequency of the pulse width")) \
    OUTPUT_FURTHER(X(gain, 9, "", ANALOG | CHIP, -1.0f, 1.0f, 1.0f, "change of the output's span over the command's")) \
    OUTPUT_FURTHER(X(offset, 10, "", ANALOG | CHIP, 0.0f, 1.0f, 0.0f, "output, fraction of its span, at command 0")) \
    OUTPUT_FURTHER(X(flow, 11, "l/h", STEPPER, 0.001f, 1000.0f, 1.0f, "flow at command 1")) \
    OUTPUT_FURTHER(X(steps, 12, "1/ml", STEPPER, 0.01f, 100000.0f, 100.0f, "steps that pump a millilitre")) \
    OUTPUT_FURTHER(X(ramp, 13, "1/s2", STEPPER, 50.0f, 10000.0f, 500.0f, "largest change of speed, steps/s each second")) \
    OUTPUT_FURTHER(X(travel, 14, "s", VALVE, 1.0f, 600.0f, 60.0f, "time from one end to the other")) \
    OUTPUT_FURTHER(X(dead_band, 15, "", VALVE, 0.001f, 0.2f, 0.01f, "the valve stays where it is while the command is no further away")) \
    OUTPUT_FURTHER(X(pause, 16, "s", VALVE, 0.05f, 10.0f, 0.5f, "rest of the motor before it turns back"))
/* clang-format on */

#endif
