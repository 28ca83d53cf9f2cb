/* A thermistor by its beta: 1/T = 1/T25 + ln(R/R25)/beta, T in K. The makers give beta for two temperatures, mostly 25 and 85 degC; between them
 * the equation is good to a few tenths of a kelvin.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_VOLTAGE_THERMISTOR_H
#define REFLUX_DEVICES_VOLTAGE_THERMISTOR_H

#include <stdbool.h>

/* Temperature, degC, from the resistance and that at 25 degC, in the same unit, and beta, K (above 0; thermistors whose resistance falls). False:
 * it is outside -55 to 200 degC, or no number. */
bool thermistor_temperature(float resistance, float at_25, float beta, float *temperature);

#endif
