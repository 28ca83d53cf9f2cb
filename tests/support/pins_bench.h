/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* The whole firmware on the board in memory, with chips and loads at its pins as a wiring file has them. Nothing is at the plant link. */
#ifndef REFLUX_TESTS_PINS_BENCH_H
#define REFLUX_TESTS_PINS_BENCH_H

#include <math.h>
#include <unistd.h>

#include "board_bench.h"
#include "buses.h"
#include "chips/wired.h"

#define PINS_NS_PER_MS UINT64_C(1000000)

static struct wired *pins_world;
static char pins_header[1000], pins_row[1000]; /* the last ones of the telemetry */

static inline void pins_close(void)
{
    buses_set_world(NULL);
    wired_close(pins_world);
    pins_world = NULL;
}

/* A board without settings, wired like this. */
static inline void pins_power_on(const char *wiring)
{
    char path[] = "/tmp/pins_bench_XXXXXX", err[256] = "";
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    TEST_ASSERT_EQUAL_INT((int)strlen(wiring), (int)write(file, wiring, strlen(wiring)));
    (void)close(file);
    pins_close();
    pins_world = wired_open(path, 1, err, sizeof err);
    (void)remove(path);
    TEST_ASSERT_NOT_NULL_MESSAGE(pins_world, err);
    buses_set_world(wired_world(pins_world));
    memory_port_erase_all();
    power_on();
    pins_header[0] = pins_row[0] = '\0';
}

static inline void pins_ask_all(const char *const *lines)
{
    for (; *lines != NULL; lines++)
        ask_ok(*lines);
}

#define PINS_ASK(...) pins_ask_all((const char *const[]){__VA_ARGS__, NULL})

static inline void pins_measure(const char *sensor, double value)
{
    wired_measure(pins_world, board.clock_ms * PINS_NS_PER_MS, sensor, value);
}

static inline void pins_fault(const char *name, const char *what, double value)
{
    char err[256] = "";
    TEST_ASSERT_TRUE_MESSAGE(wired_fault(pins_world, board.clock_ms * PINS_NS_PER_MS, name, what,
                                         value, err, sizeof err),
                             err);
}

/* Number of an output in the wiring. */
static inline size_t pins_output_named(const char *name)
{
    const struct wiring *wiring = wired_wiring(pins_world);
    for (size_t i = 0; i < wiring_n_outputs(wiring); i++)
        if (strcmp(wiring_output(wiring, i)->name, name) == 0)
            return i;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

/* How long a load has been on since the beginning, s. */
static inline double pins_on_s(const char *load)
{
    double ns[WIRED_OUTPUTS_MAX];
    (void)wired_loads(pins_world, board.clock_ms * PINS_NS_PER_MS, ns);
    return ns[pins_output_named(load)] / 1e9;
}

/* Mean of a load over the next so many ms, fraction. */
static inline double pins_mean(const char *load, unsigned ms)
{
    double before = pins_on_s(load);
    pass(ms);
    return (pins_on_s(load) - before) * 1000.0 / ms;
}

/* Ticks and main loop stand for so long; the board clock goes on. */
static inline void pins_stall(unsigned ms)
{
    board.clock_ms += ms;
    memory_port_set_clock(board.clock_ms);
}

/* Takes header and row out of what has been said since board_forget(); returns how many rows there are. */
static inline unsigned pins_take_rows(void)
{
    unsigned rows = 0;
    for (const char *line = board.said; line != NULL && *line != '\0'; line = strchr(line, '\n')) {
        line += *line == '\n';
        bool header = strncmp(line, "H,", 2) == 0;
        rows += strncmp(line, "T,", 2) == 0;
        if (!header && strncmp(line, "T,", 2) != 0)
            continue;
        snprintf(header ? pins_header : pins_row, sizeof pins_row, "%.*s", (int)strcspn(line, "\n"),
                 line);
    }
    return rows;
}

/* A field of the last row by its name in the header, "T1" or "T1.q"; not a number where it is empty. */
static inline double pins_field(const char *name)
{
    (void)pins_take_rows();
    const char *h = pins_header, *r = pins_row;
    while (h != NULL && r != NULL) {
        size_t n = strcspn(h, ",[");
        if (n == strlen(name) && strncmp(h, name, n) == 0)
            return strcspn(r, ",\n") == 0 ? (double)NAN : atof(r);
        h = strchr(h, ',');
        r = strchr(r, ',');
        h += h != NULL;
        r += r != NULL;
    }
    TEST_FAIL_MESSAGE(name);
    return 0.0;
}

/* Passes so many samples, 1 s each, and keeps what is said meanwhile. */
static inline void pins_samples(unsigned n)
{
    (void)pins_take_rows(); /* the header is said once */
    board_forget();
    pass(1000u * n);
}

#endif
