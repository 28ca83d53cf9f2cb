/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "chips/spi_port.h"

#include "chips/chip_inside.h"

#define BYTE_NS_MIN     1600u /* 8 bits at 5 MHz */
#define RELEASED_NS_MIN 400u  /* tCWH */

void spi_port_select(struct spi_port *p, struct chip *c, uint64_t now_ns, bool low)
{
    if (!low && c->stray_bits != 0) {
        chip_wrong(c, "select released after %u of 8 bits", c->stray_bits);
    }
    uint64_t released_ns = now_ns - p->select_ns;
    if (low && released_ns > 0 && released_ns < RELEASED_NS_MIN && p->bytes > 0) {
        chip_wrong(c, "select was high for %u ns; at least %u ns", (unsigned)released_ns,
                   RELEASED_NS_MIN);
    }
    c->stray_bits = 0;
    p->low = low;
    p->has_address = false;
    p->wrong_mode = false;
    p->bytes = low ? 0 : p->bytes;
    p->select_ns = now_ns;
}

uint8_t spi_port_exchange(struct spi_port *p, struct chip *c, uint64_t now_ns, unsigned mode,
                          uint8_t out, const struct spi_registers *registers)
{
    uint64_t byte_ns = now_ns - p->byte_ns;
    if (p->bytes > 0 && byte_ns > 0 && byte_ns < BYTE_NS_MIN) {
        chip_wrong(c, "SPI: a byte in %u ns; the clock is 5 MHz at most", (unsigned)byte_ns);
    }
    p->byte_ns = now_ns;
    p->bytes++;
    if ((mode & 1u) == 0 && !p->wrong_mode) {
        chip_wrong(c, "SPI mode %u; it takes modes 1 and 3", mode);
        p->wrong_mode = true;
    }
    if (p->wrong_mode || c->stray_bits != 0) {
        return (uint8_t)chip_random(&c->random);
    }
    if (!p->has_address) {
        p->has_address = true;
        p->address = out;
        return 0xFF; /* SDO is not driven */
    }
    uint8_t address = p->address;
    p->address = (uint8_t)((address & 0x80u) | ((address + 1u) & 0x7Fu));
    if ((address & 0x80u) == 0) {
        return registers->read(c, now_ns, address);
    }
    registers->write(c, now_ns, address & 0x7Fu, out);
    return 0xFF;
}
