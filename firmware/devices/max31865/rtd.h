/* Resistance of a platinum thermometer to temperature: the Callendar-Van Dusen equation of IEC 60751,
 *     R = R0 (1 + A T + B T^2 + C (T - 100) T^3),  the last term below 0 degC only,
 *     A = 3.9083e-3, B = -5.775e-7, C = -4.183e-12 per degC, degC^2, degC^4.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_MAX31865_RTD_H
#define REFLUX_DEVICES_MAX31865_RTD_H

#include <stdbool.h>

/* The range of the equation, degC, and R/R0 at its ends. */
#define RTD_LO       (-200.0f)
#define RTD_HI       850.0f
#define RTD_RATIO_LO 0.18520f
#define RTD_RATIO_HI 3.90481f

/* Temperature, degC, from ratio = R/R0, which is 1 at 0 degC. Error against the equation: 0.001 K. False: the ratio is outside
 * RTD_RATIO_LO to RTD_RATIO_HI, or no number. */
bool rtd_temperature(float ratio, float *temperature);

#endif
