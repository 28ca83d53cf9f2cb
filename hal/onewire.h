/* 1-wire with the board as master. Bits are made by a USART, not by waiting: 115,200 baud for a bit, 9,600 for the reset pulse. A strong
 * pull-up for devices without a supply of their own is not there. Rules: hal/transfer.h.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HAL_ONEWIRE_H
#define REFLUX_HAL_ONEWIRE_H

#include "base/error.h"
#include "hal/pin.h"
#include "hal/transfer.h"

#define ONEWIRE_ROM_BYTES 8u

/* Number of the highest wire that the board has; 0: none. */
uint8_t hal_onewire_buses(void);

/* Pin of a wire; false: the board has no such wire. */
bool hal_onewire_pin(uint8_t bus, hal_pin *pin);

/* ERR_RANGE: no such wire. */
enum err hal_onewire_open(uint8_t bus);

/* Reset pulse, presence, n_out bytes, n_in bytes, least significant bit first. ERR_STATE: the wire is busy. */
enum err hal_onewire_start(uint8_t bus, struct transfer *transfer);

/* One pass of a search for addresses (command F0h), 64 times two bits in and one out. `in` of the transfer has ONEWIRE_ROM_BYTES and holds the
 * address that the pass before has found; *branch is the last place, 1 to 64, where it took 0 and there was a choice, or 0 for a first pass.
 * Then the next address is in `in`, and *branch its last such place: 0 means that it was the last address. */
enum err hal_onewire_search(uint8_t bus, struct transfer *transfer, volatile uint8_t *branch);

void hal_onewire_stop(uint8_t bus);

#endif
