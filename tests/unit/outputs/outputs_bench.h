/* Outputs above pins that only remember: the board clock turns when the test says so, and its milliseconds wrap soon after the start.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_TESTS_OUTPUTS_BENCH_H
#define REFLUX_TESTS_OUTPUTS_BENCH_H

#include "hal/spi.h"
#include "outputs/output_check.h"
#include "outputs/output_kind.h"
#include "outputs/outputs.h"
#include "random_source.h"

/* Milliseconds from bench_begin() to the wrap of the clock. */
#define BENCH_WRAP_MS 3000u

struct bench_pin {
    enum hal_pin_use use;
    bool low, high; /* of an output: polarity, level */
    bool pwm;
    uint16_t part; /* of a pulse width */
    uint32_t hz;
    unsigned pwm_set;       /* calls of hal_pwm_set() */
    bool taken;             /* is no free pin */
    bool refuses;           /* cannot be opened */
    bool contact;           /* of an input: closed to ground */
    unsigned rises;         /* changes from off to on */
    bool no_timer;          /* for a pulse width */
    uint8_t timer, channel; /* 0: a timer of the pin's own */
};

extern struct bench_pin bench_pins[256];
extern uint32_t bench_now;        /* of the board clock */
extern uint32_t bench_edges[256]; /* falling edges at each pin */

/* What is at the SPI buses: exchanges the bytes of a transfer and returns its state. NULL, as bench_begin() leaves it: nothing, all bits are 1. */
extern enum transfer_state (*bench_spi)(const struct spi_device *device, struct transfer *t);
extern unsigned bench_spi_stops; /* calls of hal_spi_stop() */
extern bool bench_spi_busy;      /* the bus is somebody else's */
extern unsigned bench_safe;      /* calls of hal_output_safe() */

/* All pins as after a reset, all outputs closed. */
void bench_begin(void);
/* An output of this type on pins 16 * index and the three above it, with numbers as at first, without a pin for zero crossings; a chip on
 * SPI bus 1. */
struct output_settings bench_settings(enum output_type type, uint8_t index);
/* Checks and opens, and lets the clock begin to count. The test fails where an output is refused. */
void bench_open(const struct output_settings *settings, uint8_t n);
/* The next turn of the clock; `ms`: so many milliseconds after the last one. */
void bench_turn(void);
void bench_turn_after(uint32_t ms);
/* Whether the pin is an output that is on. */
bool bench_on(hal_pin pin);
/* The whole command of a fraction. */
int64_t bench_whole(double fraction);
/* A random source that begins with this seed, not 0, and, for tearDown(), prints the seed of the last one if the test has failed. */
struct random_source bench_random(uint32_t seed);
void bench_tell_seed(void);

#endif
