/* BME280 or BMP280, told apart by their chip id: barometer. Facts: Bosch BST-BME280-DS002 and BST-BMP280-DS001, memory map and compensation.
 *
 * Settings: bus; address: 76h or 77h. Two kinds have the same chip: bme280 is its pressure, bme280_temperature its temperature; both may be on one
 * chip.
 * Codes: pressure, 1/256 Pa; temperature, 0.01 degC.
 *
 * Each reading is one conversion (forced mode) with sixteen samples of pressure and two of temperature. The calibration is read twice at the
 * start, and again after each failure. Humidity is left out. A conversion that did not begin, because its command was disturbed, shows the
 * reading before once more.
 *
 * What a reading can say: no chip: no acknowledgement; wrong chip: another id, or a conversion that does not end; power on: the
 * configuration is gone; checksum: two reads differ; range: the chip has not measured, or its calibration is none.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_BME280_H
#define REFLUX_DEVICES_BME280_H

#include "devices/device.h"

extern const struct device_kind bme280_kind;             /* Pa */
extern const struct device_kind bme280_temperature_kind; /* degC */

#endif
