/* The table of a wiring file, for the files that read it and that answer from it.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_WIRING_INSIDE_H
#define REFLUX_CHIPS_WIRING_INSIDE_H

#include "chips/chip.h"
#include "chips/wiring.h"

#define WIRING_LINES_MAX 64u
#define WIRING_BUSES_MAX 9u /* of each kind */
#define WIRING_BUS_KINDS 3u

struct wiring {
    struct wiring_sensor sensor[WIRING_LINES_MAX];
    size_t n_sensors;
    struct wiring_output output[WIRING_LINES_MAX];
    size_t n_outputs;
    struct chip *chip[WIRING_LINES_MAX];
    struct chip *other[WIRING_LINES_MAX]; /* in its place while it is `wrong`; NULL: it never was */
    size_t n_chips;
    struct chips *bus[WIRING_BUS_KINDS][WIRING_BUSES_MAX];
    uint64_t seed;
};

/* "spi", "i2c", "wire" */
extern const char *const wiring_bus_names[WIRING_BUS_KINDS];

/* A bus by its name, spi1. False: none. */
bool wiring_bus_named(const char *name, enum chip_bus *kind, unsigned *number);

/* Takes a line, which it cuts into words, into the table. False, with a sentence in err, without file and line. */
bool wiring_line(struct wiring *w, char *text, unsigned line, char *err, size_t err_size);

#endif
