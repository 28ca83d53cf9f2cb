/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "io/board_io.h"

#include <stdatomic.h>
#include <stddef.h>
#include <string.h>

#include "base/crc32.h"
#include "base/elapsed.h"
#include "io/board_devices.h"
#include "io/fault_words.h"

/* A reading older than so many intervals of its device is none. */
#define READINGS_MISSED 3u
#define INTERVAL_MAX_MS 1000u

void board_io_init(struct board_io *b, struct event_queue *events, const uint64_t *plant_time)
{
    memset(b, 0, sizeof *b);
    b->tick_ms = BOARD_IO_TICK_MS;
    b->events = events;
    b->plant_time = plant_time;
}

/* ---- settings ---- */

/* Some readings come between two samples, on a grid of their own that the samples are on, too. */
static uint16_t interval_of(const struct board_io *b)
{
    return (uint16_t)(b->tick_ms / 2u < INTERVAL_MAX_MS ? b->tick_ms / 2u : INTERVAL_MAX_MS);
}

static void open_devices(struct board_io *b)
{
    b->n_devices = 0;
    for (uint8_t i = 0; i < CONFIG_DEVICES; i++) {
        const struct device_config *c = &b->settings->device[i];
        const struct device_kind *kind = board_device_kind(c);
        if (c->name[0] == '\0' || kind == NULL)
            continue;
        struct device_settings s = board_device_settings(b->settings, c);
        b->told[b->n_devices] = 0;
        b->row[b->n_devices] = i;
        b->works[b->n_devices] =
            device_open(&b->device[b->n_devices], kind, &s, interval_of(b)) == ERR_OK;
        b->n_devices++;
    }
}

void board_io_take(struct board_io *b, const struct config *config)
{
    uint32_t identity = crc32_update(0, &config->pins, sizeof config->pins);
    uint32_t tick_ms = (uint32_t)(config->tick_s * 1000.0f + 0.5f);
    if (tick_ms == 0)
        tick_ms = BOARD_IO_TICK_MS;
    b->settings = &config->pins;
    if (identity == b->identity && tick_ms == b->tick_ms)
        return;
    b->open = false;
    b->tick_ms = tick_ms;
    atomic_signal_fence(memory_order_seq_cst);
    b->n_devices = b->n_outputs = 0;
    if (pins_are_source(&config->pins))
        open_devices(b);
    b->generation++;
    b->identity = identity;
    b->due_ms = 0;
    atomic_signal_fence(memory_order_seq_cst);
    b->open = pins_are_source(&config->pins);
}

/* ---- board clock ---- */

bool board_io_clock(struct board_io *b, uint32_t now_ms)
{
    if (!b->open)
        return false;
    for (unsigned i = 0; i < b->n_devices; i++)
        if (b->works[i])
            device_clock(&b->device[i], now_ms);
    return (uint32_t)b->due_ms == now_ms;
}

/* ---- tick ---- */

static void tell_faults(struct board_io *b, unsigned i, uint16_t faults)
{
    uint8_t fault = fault_word(faults);
    if (fault == b->told[i])
        return;
    b->told[i] = fault;
    event_put(b->events, *b->plant_time, fault != 0 ? EVENT_SENSOR_FAULT : EVENT_SENSOR_FINE,
              b->settings->device[b->row[i]].name, (float)faults, fault);
}

static struct io_reading reading_of(struct board_io *b, unsigned i, uint64_t now_ms)
{
    struct io_reading reading = {.quality = QUALITY_MISSING};
    const struct device *d = &b->device[i];
    struct device_result result;
    device_read(d, &result);
    uint32_t oldest = READINGS_MISSED * d->interval_ms + b->tick_ms;
    if (result.number == 0)
        return reading;
    if (result.faults == 0 && (uint32_t)now_ms - result.stamp_ms > oldest)
        result.faults = DEVICE_BUS;
    tell_faults(b, i, result.faults);
    if ((result.faults & (DEVICE_NO_CHIP | DEVICE_BUS)) != 0)
        return reading;
    reading.quality = QUALITY_BAD;
    if (result.faults == 0 && d->kind->value(&d->settings, result.code, &reading.value))
        reading.quality = QUALITY_GOOD;
    return reading;
}

/* The first point of the grid after now. */
static uint64_t next_due(const struct board_io *b, uint64_t now_ms)
{
    return now_ms - now_ms % b->tick_ms + b->tick_ms;
}

static bool poll(void *context, uint64_t now_ms, struct io_sample *sample)
{
    struct board_io *b = context;
    if (!b->open)
        return false;
    if (b->due_ms == 0)
        b->due_ms = next_due(b, now_ms);
    if (now_ms < b->due_ms)
        return false;
    memset(sample, 0, sizeof *sample);
    sample->number = b->number++;
    sample->time = now_ms - now_ms % b->tick_ms;
    sample->n_measurements = b->n_devices;
    for (unsigned i = 0; i < b->n_devices; i++)
        sample->measurement[i] = reading_of(b, i, now_ms);
    b->due_ms = next_due(b, now_ms);
    return true;
}

static enum io_state state(const void *context)
{
    return ((const struct board_io *)context)->open ? IO_READY : IO_DOWN;
}

static uint32_t generation(const void *context)
{
    return ((const struct board_io *)context)->generation;
}

static uint8_t count(const void *context, bool manipulated)
{
    const struct board_io *b = context;
    return manipulated ? b->n_outputs : b->n_devices;
}

static struct io_channel channel(const void *context, bool manipulated, uint8_t index)
{
    const struct board_io *b = context;
    if (manipulated) {
        const struct output_config *o = &b->settings->output[b->output_row[index]];
        return (struct io_channel){
            .name = o->name, .unit = o->unit, .safe = o->lo, .lo = o->lo, .hi = o->hi};
    }
    const struct device_config *d = &b->settings->device[b->row[index]];
    return (struct io_channel){.name = d->name, .unit = d->unit, .lo = d->lo, .hi = d->hi};
}

static uint32_t tick_ms(const void *context)
{
    return ((const struct board_io *)context)->tick_ms;
}

static enum err command(void *context, const struct io_command *c, uint64_t now_ms)
{
    struct board_io *b = context;
    (void)now_ms;
    if (!b->open)
        return ERR_STATE;
    (void)c;
    return ERR_OK;
}

struct io_port board_io_port(struct board_io *b)
{
    return (struct io_port){.context = b,
                            .poll = poll,
                            .state = state,
                            .generation = generation,
                            .count = count,
                            .channel = channel,
                            .tick_ms = tick_ms,
                            .command = command};
}
