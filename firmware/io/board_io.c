/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "io/board_io.h"

#include <stdatomic.h>
#include <stddef.h>
#include <string.h>

#include "base/crc32.h"
#include "base/elapsed.h"
#include "io/board_devices.h"
#include "outputs/output_kind.h"
#include "outputs/outputs.h"

/* A reading older than so many intervals of its device is none. */
#define READINGS_MISSED 3u
#define INTERVAL_MAX_MS 1000u
/* So much later than its time the command of a tick may come before its outputs go to their safe position. */
#define LATE_MS      500u
#define VALVE_FAULTS (OUTPUT_END_MISSED | OUTPUT_BOTH_ENDS)

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
        b->reported[b->n_devices] = 0;
        b->loop[b->n_devices] = (struct current_loop){.failing_s = 0.0f};
        b->row[b->n_devices] = i;
        b->works[b->n_devices] =
            device_open(&b->device[b->n_devices], kind, &s, interval_of(b)) == ERR_OK;
        b->n_devices++;
    }
}

static void close_outputs(void)
{
    uint8_t failed;
    (void)!outputs_open(NULL, 0, &failed);
}

/* The outputs that are used, those of kind enable too; only the others are channels. */
static void open_outputs(struct board_io *b)
{
    struct output_settings all[CONFIG_OUTPUTS];
    uint8_t n = 0, failed;
    b->n_outputs = 0;
    for (uint8_t i = 0; i < CONFIG_OUTPUTS; i++) {
        struct output_settings s = pins_output(b->settings, i);
        if (s.type == OUTPUT_NONE)
            continue;
        if (s.type != OUTPUT_ENABLE) {
            b->output_row[b->n_outputs] = i;
            b->output_at[b->n_outputs++] = n;
        }
        all[n++] = s;
    }
    (void)!outputs_open(all, n, &failed); /* on an error all are closed */
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
    for (unsigned i = 0; i < b->n_devices; i++)
        device_close(&b->device[i]);
    b->n_devices = b->n_outputs = 0;
    memset(b->drive, 0, sizeof b->drive); /* no output gets the command of another one */
    memset(b->proof, 0, sizeof b->proof);
    bool open = pins_are_source(&config->pins);
    if (open) {
        open_devices(b);
        open_outputs(b);
    } else {
        close_outputs();
    }
    b->generation++;
    b->identity = identity;
    b->due_ms = 0;
    atomic_signal_fence(memory_order_seq_cst);
    b->open = open;
}

/* ---- board clock ---- */

bool board_io_clock(struct board_io *b, uint32_t now_ms)
{
    if (!b->open)
        return false;
    for (unsigned i = 0; i < b->n_devices; i++)
        if (b->works[i])
            device_clock(&b->device[i], now_ms);
    outputs_clock(now_ms);
    return (uint32_t)b->due_ms == now_ms;
}

void board_io_stand_by(bool begins)
{
    if (begins)
        outputs_safe();
    else
        outputs_resume();
}

/* ---- tick ---- */

/* The number of the first of these faults, from 1; 0: there is none. */
static uint8_t first_number(uint16_t faults)
{
    uint16_t first = (uint16_t)(faults & (uint16_t)-faults);
    uint8_t number = 0;
    while (first >> number != 0)
        number++;
    return number;
}

/* People are told the first of these faults: where nothing answers, nothing else is known. The detail of the event is its number, from 1. */
static void tell_faults(struct board_io *b, unsigned i, uint16_t faults)
{
    uint16_t first = (uint16_t)(faults & (uint16_t)-faults);
    if (first == b->reported[i])
        return;
    b->reported[i] = first;
    event_put(b->events, *b->plant_time, first != 0 ? EVENT_SENSOR_FAULT : EVENT_SENSOR_FINE,
              b->settings->device[b->row[i]].name, (float)faults, first_number(faults));
}

static struct io_reading newest_reading(struct board_io *b, unsigned i, uint64_t now_ms)
{
    struct io_reading reading = {.quality = QUALITY_MISSING};
    const struct device *d = &b->device[i];
    struct device_result result;
    device_read(d, &result);
    uint32_t oldest = READINGS_MISSED * d->interval_ms + b->tick_ms;
    if (!b->works[i])
        tell_faults(b, i, DEVICE_WRONG_CHIP); /* its kind has refused its settings */
    if (result.number == 0)
        return reading;
    if (result.faults == 0 && (uint32_t)now_ms - result.stamp_ms > oldest)
        result.faults = DEVICE_BUS;
    tell_faults(b, i, result.faults);
    if ((result.faults & (DEVICE_NO_CHIP | DEVICE_BUS)) != 0)
        return reading;
    reading.quality = QUALITY_BAD;
    if (result.faults == 0)
        (void)board_device_value(&b->settings->device[b->row[i]], d, &result,
                                 (float)b->tick_ms / 1000.0f, &b->loop[i], &reading);
    return reading;
}

/* The first point of the grid after now. */
static uint64_t next_due(const struct board_io *b, uint64_t now_ms)
{
    return now_ms - now_ms % b->tick_ms + b->tick_ms;
}

/* Gives the outputs the commands of the tick once more, without which they would go to their safe position. */
static void repeat_commands(const struct board_io *b)
{
    outputs_report(OUTPUTS_TICK);
    for (uint8_t i = 0; i < b->n_outputs; i++)
        outputs_command(b->output_at[i], b->drive[i], b->fraction[i]);
}

/* What an output is, fraction of its span. The mean of a window or a burst over a tick that is shorter would jump; its time on follows the
 * command by construction, unless something else rules it. */
static float output_part(const struct board_io *b, uint8_t i)
{
    float really = outputs_readback(b->output_at[i]);
    uint8_t type = b->settings->output[b->output_row[i]].settings.type;
    bool follows = outputs_rule(b->output_at[i]) == OUTPUT_COMMANDED;
    return follows && (type == OUTPUT_WINDOW || type == OUTPUT_BURST) ? b->fraction[i] : really;
}

/* The detail of the event is the number of the first of these faults, from 1. */
static void tell_output(struct board_io *b, uint8_t i, uint8_t faults)
{
    float value = faults != 0 ? (float)faults : outputs_mains(b->output_at[i]);
    event_put(b->events, *b->plant_time, faults != 0 ? EVENT_OUTPUT_FAULT : EVENT_OUTPUT_FINE,
              b->settings->output[b->output_row[i]].name, value, first_number(faults));
}

/* Tells faults of an output: those of a motor valve's end contacts when they come, the others when they change. */
static void tell_output_faults(struct board_io *b, uint8_t i)
{
    uint8_t faults = outputs_faults(b->output_at[i]), before = b->output_fault[i];
    uint8_t valve = faults & VALVE_FAULTS;
    faults &= VALVE_FAULTS | OUTPUT_TOLD;
    if (valve != 0 && valve != (before & VALVE_FAULTS))
        event_put(b->events, *b->plant_time, EVENT_VALVE_FAULT,
                  b->settings->output[b->output_row[i]].name, (float)valve, 0);
    if (((faults ^ before) & OUTPUT_TOLD) != 0)
        tell_output(b, i, faults & OUTPUT_TOLD);
    b->output_fault[i] = faults;
}

/* The largest parts of other outputs than i: of those that show at the same channel, and of all. */
static void look_at_others(const struct board_io *b, uint8_t i, const float *part,
                           struct output_proof_look *look)
{
    uint8_t device = b->settings->output[b->output_row[i]].proof.device;
    for (uint8_t k = 0; k < b->n_outputs; k++) {
        bool same = b->settings->output[b->output_row[k]].proof.device == device;
        if (k != i && same && part[k] > look->others)
            look->others = part[k];
        if (k != i && part[k] > look->elsewhere)
            look->elsewhere = part[k];
    }
}

/* Looks whether output i does as it is told, and takes the power from the heaters where one heats untold. part: of all outputs. */
static enum output_proof_fault prove(struct board_io *b, uint8_t i, const float *part,
                                     const struct io_sample *sample)
{
    const struct output_config *o = &b->settings->output[b->output_row[i]];
    struct output_proof *p = &b->proof[i];
    enum output_proof_fault before = (enum output_proof_fault)p->known_fault;
    struct output_proof_look look = {.part = part[i], .since_ms = b->tick_ms};
    look_at_others(b, i, part, &look);
    for (uint8_t k = 0; k < b->n_devices; k++)
        if (b->row[k] + 1u == o->proof.device) {
            look.reading = sample->measurement[k].value;
            look.usable = quality_usable(sample->measurement[k].quality);
        }
    enum output_proof_fault fault = output_proof_step(p, &o->proof, &look);
    if (fault == before)
        return fault;
    event_put(b->events, *b->plant_time,
              fault == PROOF_FINE ? EVENT_OUTPUT_ACTS : EVENT_OUTPUT_CONTRADICTED, o->name,
              look.reading, (uint8_t)fault);
    outputs_stuck(b->output_at[i], output_proof_stuck(fault));
    return fault;
}

/* Outputs as they really were; uncertain where the channel of an output contradicts it. */
static void read_back(struct board_io *b, struct io_sample *sample)
{
    float part[CONFIG_OUTPUTS] = {0.0f};
    for (uint8_t i = 0; i < b->n_outputs; i++)
        part[i] = output_part(b, i);
    sample->n_readback = b->n_outputs;
    for (uint8_t i = 0; i < b->n_outputs; i++) {
        const struct output_config *o = &b->settings->output[b->output_row[i]];
        tell_output_faults(b, i);
        sample->readback[i] = (struct io_reading){
            o->lo + part[i] * (o->hi - o->lo),
            prove(b, i, part, sample) == PROOF_FINE ? QUALITY_GOOD : QUALITY_UNCERTAIN};
    }
}

static bool board_poll(void *context, uint64_t now_ms, struct io_sample *sample)
{
    struct board_io *b = context;
    if (!b->open)
        return false;
    if (now_ms - b->commanded_ms <= b->tick_ms + LATE_MS)
        repeat_commands(b);
    if (b->due_ms == 0)
        b->due_ms = next_due(b, now_ms);
    if (now_ms < b->due_ms)
        return false;
    memset(sample, 0, sizeof *sample);
    sample->number = b->number++;
    sample->time = now_ms - now_ms % b->tick_ms;
    sample->n_measurements = b->n_devices;
    for (unsigned i = 0; i < b->n_devices; i++)
        sample->measurement[i] = newest_reading(b, i, now_ms);
    read_back(b, sample);
    b->due_ms = next_due(b, now_ms);
    return true;
}

static enum io_state board_state(const void *context)
{
    return ((const struct board_io *)context)->open ? IO_READY : IO_DOWN;
}

static uint32_t board_generation(const void *context)
{
    return ((const struct board_io *)context)->generation;
}

static uint8_t board_count(const void *context, bool manipulated)
{
    const struct board_io *b = context;
    return manipulated ? b->n_outputs : b->n_devices;
}

static float safe_value(const struct output_config *o)
{
    const struct output_kind *kind = output_kind(o->settings.type);
    float part = kind != NULL && kind->keeps_position ? o->settings.safe : 0.0f;
    return o->lo + part * (o->hi - o->lo);
}

static struct io_channel board_channel(const void *context, bool manipulated, uint8_t index)
{
    const struct board_io *b = context;
    if (manipulated) {
        const struct output_config *o = &b->settings->output[b->output_row[index]];
        return (struct io_channel){
            .name = o->name, .unit = o->unit, .safe = safe_value(o), .lo = o->lo, .hi = o->hi};
    }
    const struct device_config *d = &b->settings->device[b->row[index]];
    return (struct io_channel){.name = d->name, .unit = d->unit, .lo = d->lo, .hi = d->hi};
}

static uint32_t board_tick_ms(const void *context)
{
    return ((const struct board_io *)context)->tick_ms;
}

static enum err board_command(void *context, const struct io_command *c, uint64_t now_ms)
{
    struct board_io *b = context;
    if (!b->open)
        return ERR_STATE;
    b->commanded_ms = now_ms;
    for (uint8_t i = 0; i < b->n_outputs; i++) {
        const struct output_config *o = &b->settings->output[b->output_row[i]];
        b->drive[i] = i < c->n_outputs && c->output[i].drive;
        b->fraction[i] = b->drive[i] ? (c->output[i].value - o->lo) / (o->hi - o->lo) : 0.0f;
    }
    repeat_commands(b);
    return ERR_OK;
}

struct io_port board_io_port(struct board_io *b)
{
    return (struct io_port){.context = b,
                            .poll = board_poll,
                            .state = board_state,
                            .generation = board_generation,
                            .count = board_count,
                            .channel = board_channel,
                            .tick_ms = board_tick_ms,
                            .command = board_command};
}
