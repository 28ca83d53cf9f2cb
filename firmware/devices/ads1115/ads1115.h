/* ADS1115: voltages at four inputs against ground, 16 bits. Several devices share a chip, each with an input of its own. Facts: Texas
 * Instruments SBAS444, register maps.
 *
 * Settings: bus; address: 48h to 4Bh; input: 0..3; type: range, 0: 6.144 V, 1: 4.096 V, 2: 2.048 V, 3: 1.024 V, 4: 0.512 V, 5: 0.256 V. The input
 * itself must stay within the chip's supply.
 * Codes: the conversion, 32768 at the range; the configuration that was read back.
 *
 * Each reading is one conversion of 62.5 ms (16 a second: three periods of mains are averaged). The chip is this device's until it is over. Its
 * configuration is read at the beginning, where it must say that a conversion runs: otherwise the voltage of another input could be taken for
 * this one's. It is read again at the end, after two reads of the conversion: then the chip was not without power in between.
 *
 * What a reading can say: no chip: no acknowledgement; power on: the configuration is that of power-on; wrong chip: it is another, or a
 * conversion does not begin or end; checksum: reads that differ; range: the code is at an end of the range.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_ADS1115_H
#define REFLUX_DEVICES_ADS1115_H

#include "devices/device.h"

extern const struct device_kind ads1115_kind; /* V */

#endif
