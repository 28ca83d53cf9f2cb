/* SPI of the MAX31865 and MAX31856: modes 1 and 3, most significant bit first, an address and then data, 0Xh to read and 8Xh to write; the
 * address goes up by itself while the chip is selected (MAX31865, data sheet 19-6478 rev. 3, pages 4 and 17).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_SPI_PORT_H
#define REFLUX_CHIPS_SPI_PORT_H

#include "chips/chip.h"

struct spi_port {
    bool low; /* selected */
    bool has_address;
    bool wrong_mode; /* since it was selected */
    uint8_t address; /* of the next byte, bit 7 as it came */
    unsigned bytes;  /* since it was selected */
    uint64_t select_ns, byte_ns;
};

/* How the chip reads and writes a register 0..7Fh. */
struct spi_registers {
    uint8_t (*read)(struct chip *c, uint64_t now_ns, uint8_t address);
    void (*write)(struct chip *c, uint64_t now_ns, uint8_t address, uint8_t value);
};

/* Notes what the data sheet forbids: a select that is released within a byte, or for less than 400 ns. */
void spi_port_select(struct spi_port *p, struct chip *c, uint64_t now_ns, bool low);

/* One byte. In mode 0 or 2, or behind a broken byte, nothing is taken and rubbish comes back, which is noted; so is a clock above 5 MHz where
 * the times of two bytes show it. */
uint8_t spi_port_exchange(struct spi_port *p, struct chip *c, uint64_t now_ns, unsigned mode,
                          uint8_t out, const struct spi_registers *registers);

#endif
