/* DS18B20: thermometers with 12 bits, several on one wire, each by its address. They need a supply of their own: three wires.
 *
 * Settings: bus; rom: address, family code 28h first, checksum last.
 * Codes: 1/16 degC.
 *
 * Set-up writes the two alarm bytes and 12 bits into the scratchpad, and not into the chip's EEPROM. So the alarm bytes are a mark: a chip that
 * was without power has those of its EEPROM again. This shows a power-on even in chips whose byte 6 is not that of the data sheet.
 *
 * What a reading can say:
 *     power on: the mark is gone, or the value is 0550h (85 degC) with 0Ch in byte 6, which a conversion never leaves. A temperature of
 *     85 degC as such is good;
 *     no chip: no presence pulse, or only ones: no chip with this address; bus: only zeros; checksum: wrong in both of two reads;
 *     wrong chip: it does not have 12 bits.
 * The sensor is part of the chip, so nothing of it can be open or shorted. Wires that are show as no chip or as a failure of the bus.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_DS18B20_H
#define REFLUX_DEVICES_DS18B20_H

#include "devices/device.h"

#define DS18B20_FAMILY 0x28u

/* Whether this is the address of a DS18B20: family and checksum. */
bool ds18b20_is_address(const uint8_t rom[ONEWIRE_ROM_BYTES]);

extern const struct device_kind ds18b20_kind; /* degC */

#endif
