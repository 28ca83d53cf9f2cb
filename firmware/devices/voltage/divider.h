/* Resistors around a measured voltage.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_VOLTAGE_DIVIDER_H
#define REFLUX_DEVICES_VOLTAGE_DIVIDER_H

#include <stdbool.h>
#include <stdint.h>

/* Voltage in front of a divider, as of 0 to 10 V, from the voltage over its lower resistor. Both resistors in the same unit, lower above 0. */
float divider_source(float volt, float upper, float lower);

/* Resistance of a sensor in series with a fixed resistor at a supply, in the unit of the latter. `grounded`: the sensor is the one at ground. 0,
 * or DEVICE_OPEN, DEVICE_SHORT (enum device_fault): less than a hundredth of the supply is at the fixed resistor, or at the sensor; DEVICE_RANGE: no
 * number, or no supply. */
uint16_t divider_sensor(float volt, float supply, float fixed, bool grounded, float *resistance);

#endif
