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

#define WIRING_WORDS_MAX 24u
#define WIRING_TEXT_SIZE 512u

/* A line, in words. */
struct words {
    char *word[WIRING_WORDS_MAX];
    size_t n;
    size_t places; /* words in front of the properties */
    unsigned line;
};

/* Properties that are the line's own, not the chip's. */
struct own {
    double lo, hi, lo_in, hi_in, travel_s;
    bool low_active, has_active, has_travel, has_input_range;
    const char *quantity;
};

/* "spi", "i2c", "wire" */
extern const char *const wiring_bus_names[WIRING_BUS_KINDS];

/* A bus by its name, spi1. False: none. */
bool wiring_bus_named(const char *name, enum chip_bus *kind, unsigned *number);

/* Takes a line, which it cuts into words, into the table. False, with a sentence in err, without file and line. */
bool wiring_line(struct wiring *w, char *text, unsigned line, char *err, size_t err_size);

/* Sorts the properties of a line: its own, and the rest as text for the chip, of WIRING_TEXT_SIZE. False, with a sentence in err. */
bool wiring_properties(const struct words *s, struct own *own, char *rest, char *err,
                       size_t err_size);

/* Reads a pin that nothing has yet. False, with a sentence in err. */
bool wiring_take_pin(const struct wiring *w, const char *text, hal_pin *pin, char *err,
                     size_t err_size);

/* A bus, which is made when it is first wanted. */
struct chips *wiring_make_bus(struct wiring *w, enum chip_bus kind, unsigned number);

/* Makes a chip of the table, without power. NULL, with a sentence in err. */
struct chip *wiring_make_chip(struct wiring *w, const char *kind, const char *properties, char *err,
                              size_t err_size);

/* Takes a line of an output that is a chip or a stepper. False, with a sentence in err. */
bool wiring_chip_output(struct wiring *w, const struct words *s, const struct chip_kind *kind,
                        char *err, size_t err_size);
bool wiring_stepper(struct wiring *w, const struct words *s, char *err, size_t err_size);

#endif
