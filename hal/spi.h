/* SPI with the board as master, most significant bit first. Rules: hal/transfer.h.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HAL_SPI_H
#define REFLUX_HAL_SPI_H

#include "base/error.h"
#include "hal/pin.h"
#include "hal/transfer.h"

struct spi_device {
    uint8_t bus;    /* 1: spi1 */
    hal_pin select; /* low from the first bit to the last */
    uint8_t mode;   /* 0..3: bit 0 clock phase, bit 1 clock polarity */
    uint32_t hz;    /* the clock is this or slower */
};

/* Number of the highest bus that the board has; 0: none. */
uint8_t hal_spi_buses(void);

/* Pins of a bus, in the order clock, in, out; false: the board has no such bus. */
bool hal_spi_pins(uint8_t bus, hal_pin pins[3]);

/* Makes bus and select ready, select high. ERR_RANGE: no such bus. */
enum err hal_spi_open(const struct spi_device *device);

/* Sends n_out bytes, then zeros while n_in bytes come in; what comes in during the first part is dropped. ERR_STATE: the bus is busy. */
enum err hal_spi_start(const struct spi_device *device, struct transfer *transfer);

/* Ends what runs on this bus: TRANSFER_FAILED, select high. */
void hal_spi_stop(uint8_t bus);

#endif
