/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/ds18b20/crc8.h"

uint8_t crc8_onewire(const uint8_t *bytes, unsigned n)
{
    unsigned crc = 0;
    for (unsigned k = 0; k < n; k++) {
        crc ^= bytes[k];
        for (unsigned bit = 0; bit < 8; bit++)
            crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0x8Cu : 0u);
    }
    return (uint8_t)crc;
}
