/* Thermocouples by their letters: voltage from temperature, and back. Cold end at 0 degC.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_THERMOCOUPLE_H
#define REFLUX_CHIPS_THERMOCOUPLE_H

#include <stdbool.h>

#define THERMOCOUPLES "BEJKNRST"

/* Place of the letter in THERMOCOUPLES, or -1. */
int thermocouple_index(char type);

/* Range of the reference function, degC. False: no such type. */
bool thermocouple_range(char type, double *lo, double *hi);

/* mV at a temperature, degC; beyond the range as the nearest polynomial continues. NAN: no such type. */
double thermocouple_mv(char type, double degc);

/* Temperature, degC, within lo..hi, where the voltage must rise all the way: of type B only above 42 degC. */
double thermocouple_degc(char type, double mv, double lo, double hi);

#endif
