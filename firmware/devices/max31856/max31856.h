/* MAX31856: thermocouples of types B, E, J, K, N, R, S and T, cold junction included. Facts: data sheet of the MAX31856, registers.
 *
 * Settings: bus, select (SPI); type: the letter of the thermocouple; mains_60.
 * Codes: temperature, 2^-7 degC; cold junction, 2^-6 degC; the fault register.
 *
 * Each reading is one conversion. In automatic conversion the chip looks for an open circuit in every 16th only, which is about 2 s, and it may
 * change its registers between two reads. Values and faults come in one burst; its settings come with them, so that the type is known to be the
 * right one.
 *
 * What a reading can say: open; voltage: over- or undervoltage, during which the chip keeps its old temperature; cold junction: outside -20 to
 * 85 degC, where the chip is good to 0.7 K, or outside of what it can have; range: outside the range of the type; power on: the settings are
 * those of power-on; wrong chip: they are others, or a conversion does not end; no chip: all bits alike; checksum: two reads differ.
 * A thermocouple that is shorted measures the temperature of the short, which no chip can tell.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_MAX31856_H
#define REFLUX_DEVICES_MAX31856_H

#include "devices/device.h"

extern const struct device_kind max31856_kind; /* degC */

#endif
