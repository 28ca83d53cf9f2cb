/* The plant at the board's own pins: hal/io.h implemented on devices and outputs. Plant time is the board's clock.
 *
 * Samples come on a grid: at whole multiples of the base tick of the board's clock. A sample has the newest reading of each device.
 * Contexts: functions of the tick, unless they say otherwise.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_IO_BOARD_IO_H
#define REFLUX_IO_BOARD_IO_H

#include <stddef.h>

#include "base/event.h"
#include "exchange/config.h"
#include "hal/io.h"
#include "io/output_proof.h"

#if CONFIG_DEVICES
#include "devices/device.h"
#include "devices/voltage/current_loop.h"

#define BOARD_IO_TICK_MS 1000u /* where tick.base is 0 */

struct board_io {
    const struct pins_config *settings; /* of the plan in force */
    struct device device[CONFIG_DEVICES];
    uint8_t row[CONFIG_DEVICES];       /* of each device in settings->device */
    uint16_t reported[CONFIG_DEVICES]; /* fault of each device that an event has told */
    struct current_loop loop[CONFIG_DEVICES];
    bool works[CONFIG_DEVICES]; /* false: its kind has refused its settings */
    uint8_t n_devices;
    uint8_t output_row[CONFIG_OUTPUTS]; /* of each output in settings->output */
    uint8_t output_at[CONFIG_OUTPUTS];  /* its index in firmware/outputs */
    bool drive[CONFIG_OUTPUTS];         /* the command of the last tick */
    float fraction[CONFIG_OUTPUTS];
    uint8_t output_fault[CONFIG_OUTPUTS]; /* bits that events have told */
    struct output_proof proof[CONFIG_OUTPUTS];
    uint64_t commanded_ms;
    uint8_t n_outputs;
    uint32_t identity; /* checksum of the settings that devices and outputs have */
    uint32_t generation, tick_ms;
    volatile bool open; /* the board clock may step devices and outputs */
    uint32_t number;
    uint64_t due_ms; /* the next sample, ms of the board's clock */
    struct event_queue *events;
    const uint64_t *plant_time; /* for the time stamp of events */
};

void board_io_init(struct board_io *b, struct event_queue *events, const uint64_t *plant_time);
struct io_port board_io_port(struct board_io *b);

/* Takes the settings of a plan that comes into force; they stay where they are until the next one does. Devices and outputs that have other
 * settings now begin anew, outputs at rest, and the table of channels with them. */
void board_io_take(struct board_io *b, const struct config *config);

/* Board clock: once a millisecond. Returns true when a sample is due. */
bool board_io_clock(struct board_io *b, uint32_t now_ms);

/* Main loop. Switches all outputs off, around an erase of the flash in which nothing else runs; then they may act again. */
void board_io_stand_by(bool begins);
#else
struct board_io {
};
static inline void board_io_init(struct board_io *b, struct event_queue *events,
                                 const uint64_t *plant_time)
{
    (void)b;
    (void)events;
    (void)plant_time;
}
static inline struct io_port board_io_port(struct board_io *b)
{
    (void)b;
    return (struct io_port){.context = NULL};
}
static inline void board_io_take(struct board_io *b, const struct config *config)
{
    (void)b;
    (void)config;
}
static inline void board_io_stand_by(bool begins)
{
    (void)begins;
}
#endif

#endif
