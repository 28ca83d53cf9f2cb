/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/ds18b20/rom_search.h"

#include <string.h>

#include "devices/device.h"
#include "devices/ds18b20/crc8.h"
#include "devices/line.h"

/* Reset, command, and 64 times 3 bits of 87 us are 19 ms. */
#define PASS_MS       28u
#define PASS_TRIES    3u
#define PASS_REFUSALS 255u

enum err rom_search_begin(struct rom_search *s, uint8_t bus)
{
    memset(s, 0, sizeof *s);
    s->bus = bus;
    enum err err = hal_onewire_open(bus);
    if (err != ERR_OK)
        s->state = ROM_SEARCH_FAILED;
    return err;
}

static void end_rom_search(struct rom_search *s, enum rom_search_state state)
{
    line_release(s);
    s->state = (uint8_t)state;
}

static void begin_rom_pass(struct rom_search *s, uint32_t now_ms)
{
    s->branch = s->last_branch;
    memset(s->pass_rom, 0, sizeof s->pass_rom);
    if (s->found > 0)
        memcpy(s->pass_rom, s->rom[s->found - 1u], ONEWIRE_ROM_BYTES);
    s->transfer =
        (struct transfer){.in = s->pass_rom, .n_in = ONEWIRE_ROM_BYTES, .state = TRANSFER_IDLE};
    if (line_claim(DEVICE_ONEWIRE, s->bus, LINE_WHOLE, s, now_ms, PASS_MS) &&
        hal_onewire_search(s->bus, &s->transfer, &s->branch) == ERR_OK) {
        s->wait_ms = PASS_MS;
        s->refusals = 0;
        return;
    }
    s->transfer.state = TRANSFER_IDLE;
    if (++s->refusals == PASS_REFUSALS)
        end_rom_search(s, ROM_SEARCH_FAILED);
}

/* Takes over the address of a pass that is complete. */
static void end_rom_pass(struct rom_search *s)
{
    bool zeros = device_all(s->pass_rom, ONEWIRE_ROM_BYTES, 0);
    if (zeros || crc8_onewire(s->pass_rom, ONEWIRE_ROM_BYTES) != 0) {
        if (++s->tries == PASS_TRIES)
            end_rom_search(s, zeros ? ROM_SEARCH_FAILED : ROM_SEARCH_CHECKSUM);
        return;
    }
    s->tries = 0;
    s->last_branch = s->branch;
    memcpy(s->rom[s->found++], s->pass_rom, ONEWIRE_ROM_BYTES);
    if (s->last_branch == 0)
        end_rom_search(s, ROM_SEARCH_DONE);
    else if (s->found == ROM_SEARCH_MAX)
        end_rom_search(s, ROM_SEARCH_FULL);
}

void rom_search_clock(struct rom_search *s, uint32_t now_ms)
{
    if (s->state != ROM_SEARCH_RUNS)
        return;
    if (s->wait_ms > 1) {
        s->wait_ms--;
        return;
    }
    switch (s->transfer.state) {
    case TRANSFER_DONE:
        end_rom_pass(s);
        break;
    case TRANSFER_RUNS:
        hal_onewire_stop(s->bus);
        end_rom_search(s, ROM_SEARCH_FAILED);
        break;
    case TRANSFER_NO_ANSWER:
        end_rom_search(s, s->found == 0 ? ROM_SEARCH_DONE : ROM_SEARCH_FAILED);
        break;
    case TRANSFER_FAILED:
        end_rom_search(s, ROM_SEARCH_FAILED);
        break;
    default:
        break;
    }
    if (s->state == ROM_SEARCH_RUNS)
        begin_rom_pass(s, now_ms);
}
