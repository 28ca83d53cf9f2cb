/* Finds the addresses of the chips on a wire, for a wiring check: who has connected a sensor needs to know its address. Devices on this wire
 * keep their turns meanwhile, because each pass is a transfer like any other.
 *
 * Board clock: rom_search_begin(), then rom_search_clock() once a millisecond until state is no longer ROM_SEARCH_RUNS. Other contexts read
 * addresses only afterwards.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_DS18B20_ROM_SEARCH_H
#define REFLUX_DEVICES_DS18B20_ROM_SEARCH_H

#include "hal/onewire.h"

#define ROM_SEARCH_MAX 16u

enum rom_search_state {
    ROM_SEARCH_RUNS,
    ROM_SEARCH_DONE,     /* all are found; none: nothing answers */
    ROM_SEARCH_FULL,     /* there are more than ROM_SEARCH_MAX */
    ROM_SEARCH_CHECKSUM, /* an address came wrong three times: noise, or the wire is too long */
    ROM_SEARCH_FAILED    /* of the bus: wire shorted, or never free */
};

struct rom_search {
    uint8_t bus;
    volatile uint8_t state; /* enum rom_search_state */
    uint8_t found;
    uint8_t rom[ROM_SEARCH_MAX][ONEWIRE_ROM_BYTES];
    /* Of rom_search.c: */
    struct transfer transfer;
    uint8_t pass_rom[ONEWIRE_ROM_BYTES]; /* of the pass that runs */
    volatile uint8_t branch;
    uint8_t last_branch; /* before this pass */
    uint8_t tries, wait_ms, refusals;
};

/* ERR_RANGE: no such wire. */
enum err rom_search_begin(struct rom_search *s, uint8_t bus);
void rom_search_clock(struct rom_search *s, uint32_t now_ms);

#endif
