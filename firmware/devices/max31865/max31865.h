/* MAX31865: resistance of a PT100 or PT1000, with 2, 3 or 4 wires. Facts: data sheet 19-6478 rev 3.
 *
 * Settings: bus, select (SPI); type: 2, 3 or 4 wires; mains_60; nominal: ohm at 0 degC; reference: ohm of the reference resistor, 3.91 to 16
 * times nominal (usual: 400 or 430 for a PT100, 4000 or 4300 for a PT1000).
 * Codes: the ratio of sensor to reference, 32768 at 1; the fault register.
 *
 * Each reading is one conversion, and the bias is off between them. This is slower than continuous conversion (90 ms for 20 ms), but
 *     - the registers stand still afterwards, so that they can be read twice and compared: the chip has no checksum;
 *     - the fault detection cycle, which continuous conversion does not allow, comes before each conversion;
 *     - a PT100 warms itself for a tenth of the time only;
 *     - a conversion that never began is seen (the bit of the one-shot), a converter that stopped would leave a plausible number.
 *
 * What a reading can say, within the same cycle:
 *     open: ratio at the upper threshold (850 degC), or REFIN- at its bias; short: ratio at the lower threshold (-200 degC);
 *     voltage: an input beyond its supply, or a wire shorted to ground (REFIN- or RTDIN- low while FORCE- is open);
 *     power on: the thresholds are those of power-on, so the chip has lost its settings; wrong chip: they, or the configuration, are
 *     something else; no chip: all bits alike.
 * The fault detection cycle needs an input filter below 100 us (data sheet, Fault Detection Cycle), as with the maker's 100 nF for a PT100 and 10 nF for a PT1000.
 * A wire RTDIN+ that is broken (3 and 4 wires) shows only where a resistor of 10 Mohm pulls it to BIAS (data sheet p. 20).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_MAX31865_H
#define REFLUX_DEVICES_MAX31865_H

#include "devices/device.h"

extern const struct device_kind max31865_kind; /* degC */

#endif
