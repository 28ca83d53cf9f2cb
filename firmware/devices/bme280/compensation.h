/* From the raw numbers of a BME280 or BMP280 to temperature and pressure, in whole numbers as the data sheets have it (BME280 4.2.3, BMP280
 * 3.11.3): 32 bits for temperature, 64 bits for pressure.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_BME280_COMPENSATION_H
#define REFLUX_DEVICES_BME280_COMPENSATION_H

#include <stdbool.h>
#include <stdint.h>

#define BME280_CALIBRATION 24u /* bytes, registers 88h to 9Fh */

/* Temperature in 0.01 degC and pressure in 1/256 Pa from raw numbers of 20 bits. False: the calibration allows no pressure. */
bool bme280_compensate(const uint8_t calibration[BME280_CALIBRATION], int32_t raw_temperature,
                       int32_t raw_pressure, int32_t *temperature, int32_t *pressure);

#endif
