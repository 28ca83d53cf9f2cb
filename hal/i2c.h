/* I2C with the board as the only master, addresses of 7 bits. Rules: hal/transfer.h.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HAL_I2C_H
#define REFLUX_HAL_I2C_H

#include "base/error.h"
#include "hal/pin.h"
#include "hal/transfer.h"

#define HAL_I2C_HZ 100000u

/* Number of the highest bus that the board has; 0: none. */
uint8_t hal_i2c_buses(void);

/* Pins of a bus, in the order clock, data; false: the board has no such bus. */
bool hal_i2c_pins(uint8_t bus, hal_pin pins[2]);

/* Makes the bus ready. A device that holds the data line low is clocked until it lets go. ERR_RANGE: no such bus. */
enum err hal_i2c_open(uint8_t bus);

/* Start, address, n_out bytes; where n_in is not 0, start again, address, n_in bytes; stop. ERR_STATE: the bus is busy. */
enum err hal_i2c_start(uint8_t bus, uint8_t address, struct transfer *transfer);

/* Ends what runs on this bus, TRANSFER_FAILED, and makes it ready anew. */
void hal_i2c_stop(uint8_t bus);

#endif
