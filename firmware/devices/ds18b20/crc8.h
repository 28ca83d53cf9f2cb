/* Checksum of 1-wire devices: polynomial x^8 + x^5 + x^4 + 1, least significant bit first, from 0. Over bytes and their checksum it is 0, and
 * so it is over zeros alone: a wire that is held low must be told otherwise.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_DS18B20_CRC8_H
#define REFLUX_DEVICES_DS18B20_CRC8_H

#include <stdint.h>

uint8_t crc8_onewire(const uint8_t *bytes, unsigned n);

#endif
