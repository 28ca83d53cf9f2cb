/* Buses and pins of a board that follow a script: each transfer must send the bytes that come next in it, and gets the bytes that stand
 * beside them. It implements hal/spi.h, i2c.h, onewire.h, pin.h, analog.h and pulse.h.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_TESTS_SCRIPTED_BUS_H
#define REFLUX_TESTS_SCRIPTED_BUS_H

#include "devices/device.h"

#define SCRIPT_NEVER_ENDS TRANSFER_RUNS

/* Clears the script and lets the clock stand at 1000 ms. */
void script_clear(void);

/* The next transfer sends `out` and gets `in`, both in hex: "8C A5". */
void script(const char *out, const char *in);

/* The next transfer sends `out`, wants n_in bytes, and ends like this instead. */
void script_fails(const char *out, unsigned n_in, enum transfer_state end);

/* The next transfer is a pass of a search that begins with this address and branch, finds this address and has this branch then. */
void script_search(const char *last_rom, uint8_t branch, const char *rom, uint8_t next_branch);

/* From now on there is no script: any transfer may be sent, gets random bytes, all alike bytes or an echo of the bytes before, and ends in any
 * way. */
void script_noise(uint64_t seed);

/* Fails the test if transfers of the script have not been made. */
void script_is_done(void);

/* Steps devices until the clock has gone on by this time. */
void script_run(struct device *d, uint32_t ms);
void script_run_several(struct device *const d[], unsigned n, uint32_t ms);

/* When the n-th transfer since script_clear() was begun, ms, from 0. */
uint32_t script_began_ms(unsigned n);

/* What the last transfer went to, and what the port has seen. */
struct script_seen {
    enum device_line line;
    uint8_t bus, address;
    struct spi_device spi;
    unsigned transfers, stops;
};
extern struct script_seen script_seen;

/* What the board is like. */
struct script_board {
    uint32_t now_ms;
    bool no_bus;     /* no bus can be opened */
    unsigned busy;   /* so many calls that start a transfer find the bus busy */
    bool pin_used;   /* no pin is free */
    bool level[256]; /* of each pin: high */
    bool analog_ready;
    uint16_t analog_code;
    float analog_reference;
    hal_pin pulled_up; /* the last pin that became an input with a pull-up */
    uint32_t pulses;
    uint8_t dead_ms;
};
extern struct script_board script_board;

/* The newest result of a device. */
struct device_result script_result(const struct device *d);

#endif
