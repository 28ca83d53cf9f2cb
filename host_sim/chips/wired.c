/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "chips/wired.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"
#include "chips/chip.h"

#define NS_PER_S    1e9
#define ML_S_TO_L_H 3.6
#define PREFIX      "pins."
#define LINE_SIZE   96u
#define NS_PER_MS   UINT64_C(1000000)

/* What the pins of an output say. */
struct load {
    enum pin_drive drive[2]; /* of pin and close_pin */
    double pulses;     /* part of the time that the pin is high; negative: it has no pulse width */
    double position;   /* of a valve with two pins, 0..1 */
    double level;      /* what a chip makes of its load, at the last whole millisecond */
    double sum_ns;     /* integral of what the load was */
    uint64_t since_ns; /* up to here the sum is */
    uint64_t read_ns;  /* when it was read last: milliseconds count from there */
};

struct wired {
    struct wiring *wiring;
    struct world world;
    struct load load[WIRED_OUTPUTS_MAX];
    size_t n_outputs;
};

/* ---- loads ---- */

/* A pin that nobody drives is held off by a resistor. */
static bool is_on(const struct wiring_output *o, enum pin_drive drive)
{
    bool driven = drive == PIN_HIGH || drive == PIN_LOW;
    return driven && (drive == PIN_HIGH) != o->low_active;
}

static double part_on(const struct wiring_output *o, const struct load *l)
{
    if (o->shorted || o->broken)
        return o->shorted ? 1.0 : 0.0;
    if (l->pulses >= 0.0)
        return o->low_active ? 1.0 - l->pulses : l->pulses;
    return is_on(o, l->drive[0]) ? 1.0 : 0.0;
}

/* Moves a valve with two pins for so long; returns the integral of its position, ns. At its end it stays. */
static double turn_valve(const struct wiring_output *o, struct load *l, double ns)
{
    double way = (is_on(o, l->drive[0]) ? 1.0 : 0.0) - (is_on(o, l->drive[1]) ? 1.0 : 0.0);
    if (o->broken || way == 0.0)
        return ns * l->position;
    double before = l->position, end = way > 0.0 ? 1.0 : 0.0;
    double to_end_ns = fabs(end - before) * o->travel_s * NS_PER_S;
    l->position = ns < to_end_ns ? before + way * ns / NS_PER_S / o->travel_s : end;
    double moving_ns = fmin(ns, to_end_ns);
    return moving_ns * (before + l->position) / 2.0 + (ns - moving_ns) * l->position;
}

/* How far open the load behind a chip is. */
static double part_driven(const struct wiring_output *o, uint64_t at_ns)
{
    if (o->shorted || o->broken)
        return o->shorted ? 1.0 : 0.0;
    double part = (chip_drives(o->chip, at_ns) - o->lo_in) / (o->hi_in - o->lo_in);
    return fmin(fmax(part, 0.0), 1.0);
}

/* Integral of the load behind a chip, ns. It follows its input in whole milliseconds from where it was read last. A board whose transfer takes some
 * microseconds and one whose transfer takes none then come to the same sum. */
static double follow(const struct wiring_output *o, struct load *l, uint64_t now_ns)
{
    double sum = 0.0;
    for (uint64_t at = l->since_ns, next; at < now_ns; at = next) {
        uint64_t past = (at - l->read_ns) % NS_PER_MS;
        if (past == 0)
            l->level = part_driven(o, at);
        next = at - past + NS_PER_MS;
        next = next < now_ns ? next : now_ns;
        sum += (double)(next - at) * l->level;
    }
    return sum;
}

/* Brings the sum of an output up to now. */
static void pass(struct wired *w, size_t i, uint64_t now_ns)
{
    const struct wiring_output *o = wiring_output(w->wiring, i);
    struct load *l = &w->load[i];
    double ns = now_ns > l->since_ns ? (double)(now_ns - l->since_ns) : 0.0;
    if (o->chip != NULL) {
        l->sum_ns += follow(o, l, now_ns);
    } else if (o->kind == WIRING_STEPPER) {
        /* its steps are counted as they come */
    } else if (o->close_pin == HAL_PIN_NONE) {
        l->sum_ns += ns * part_on(o, l);
    } else {
        l->sum_ns += turn_valve(o, l, ns);
    }
    l->since_ns = now_ns;
}

/* Contacts close a little before the end: no reading of theirs falls together with the moment in which the motor arrives. */
#define CONTACT_S 0.0005

static enum pin_level pin_input(void *context, uint64_t now_ns, unsigned pin)
{
    struct wired *w = context;
    for (size_t i = 0; i < w->n_outputs; i++) {
        const struct wiring_output *o = wiring_output(w->wiring, i);
        for (unsigned end = 0; end < 2; end++) {
            if (o->end_pin[end] != pin)
                continue;
            pass(w, i, now_ns);
            double place = w->load[i].position, left = end == 0 ? 1.0 - place : place;
            return left * o->travel_s <= CONTACT_S ? PIN_LEVEL_LOW : PIN_LEVEL_OPEN;
        }
    }
    const struct chip *c = wiring_at_pin(w->wiring, pin);
    bool low = c != NULL && c->kind->low != NULL && c->kind->low(c, now_ns);
    return low ? PIN_LEVEL_LOW : PIN_LEVEL_OPEN;
}

static uint64_t next_edge(void *context, uint64_t now_ns)
{
    const struct wired *w = context;
    uint64_t first = UINT64_MAX;
    for (size_t i = 0; i < wiring_n_sensors(w->wiring); i++) {
        const struct wiring_sensor *s = wiring_sensor(w->wiring, i);
        uint64_t at = s->chip->kind->next_edge == NULL ? UINT64_MAX
                                                       : s->chip->kind->next_edge(s->chip, now_ns);
        first = at < first ? at : first;
    }
    return first;
}

static double pin_volts(void *context, uint64_t now_ns, unsigned pin)
{
    const struct wired *w = context;
    const struct chip *c = wiring_at_pin(w->wiring, pin);
    return c == NULL || c->kind->pin_volts == NULL ? 0.0 : c->kind->pin_volts(c, now_ns);
}

/* A step is where the pin goes on. A pump that turns backwards brings nothing. */
static void step(const struct wiring_output *o, struct load *l, enum pin_drive before)
{
    bool stands = o->broken || is_on(o, l->drive[1]);
    if (!stands && is_on(o, l->drive[0]) && !is_on(o, before))
        l->sum_ns += NS_PER_S * ML_S_TO_L_H / o->steps / o->hi;
}

static void pin_driven(void *context, uint64_t now_ns, unsigned pin, enum pin_drive drive)
{
    struct wired *w = context;
    for (size_t i = 0; i < w->n_outputs; i++)
        if (wiring_output(w->wiring, i)->pin == pin)
            pass(w, i, now_ns); /* before a chip takes what is new */
    for (unsigned bus = 1; bus <= 3; bus++) {
        struct chips *b = wiring_bus(w->wiring, CHIP_SPI, bus);
        if (b != NULL)
            chips_select(b, now_ns, (hal_pin)pin, drive == PIN_LOW);
    }
    for (size_t i = 0; i < w->n_outputs; i++) {
        const struct wiring_output *o = wiring_output(w->wiring, i);
        if (o->pin != pin && o->close_pin != pin && o->clear_pin != pin)
            continue;
        pass(w, i, now_ns);
        if (o->clear_pin == pin) { /* pulled up */
            o->chip->kind->clear(o->chip, now_ns, drive != PIN_LOW);
            continue;
        }
        enum pin_drive before = w->load[i].drive[0];
        w->load[i].drive[o->pin == pin ? 0 : 1] = drive;
        w->load[i].pulses = -1.0;
        if (o->kind == WIRING_STEPPER)
            step(o, &w->load[i], before);
    }
}

static void pin_pulses(void *context, uint64_t now_ns, unsigned pin, double hz, double high)
{
    struct wired *w = context;
    (void)hz;
    for (size_t i = 0; i < w->n_outputs; i++)
        if (wiring_output(w->wiring, i)->pin == pin) {
            pass(w, i, now_ns);
            w->load[i].pulses = high;
        }
}

/* ---- buses ---- */

static struct chips *bus_of(const struct wired *w, enum chip_bus kind, unsigned number)
{
    return wiring_bus(w->wiring, kind, number);
}

static uint8_t spi_exchange(void *context, uint64_t now_ns, unsigned bus, unsigned mode,
                            uint8_t out)
{
    struct chips *b = bus_of(context, CHIP_SPI, bus);
    return b == NULL ? 0xFFu : chips_exchange(b, now_ns, mode, out);
}

static bool i2c_address(void *context, uint64_t now_ns, unsigned bus, uint8_t address, bool read)
{
    struct chips *b = bus_of(context, CHIP_I2C, bus);
    return b != NULL && chips_start(b, now_ns, address, read) == CHIPS_ANSWER;
}

static bool i2c_write(void *context, uint64_t now_ns, unsigned bus, uint8_t byte)
{
    struct chips *b = bus_of(context, CHIP_I2C, bus);
    return b != NULL && chips_write(b, now_ns, byte);
}

static uint8_t i2c_read(void *context, uint64_t now_ns, unsigned bus, bool acknowledged)
{
    struct chips *b = bus_of(context, CHIP_I2C, bus);
    return b == NULL ? 0xFFu : chips_read(b, now_ns, acknowledged);
}

static void i2c_stop(void *context, uint64_t now_ns, unsigned bus)
{
    struct chips *b = bus_of(context, CHIP_I2C, bus);
    if (b != NULL)
        chips_stop(b, now_ns);
}

static unsigned i2c_held(void *context, uint64_t now_ns, unsigned bus)
{
    const struct chips *b = bus_of(context, CHIP_I2C, bus);
    (void)now_ns;
    return b != NULL && chips_held_low(b) ? I2C_DATA_HELD : 0;
}

static enum wire_answer wire_reset(void *context, uint64_t now_ns, unsigned bus)
{
    struct chips *b = bus_of(context, CHIP_ONEWIRE, bus);
    enum chips_answer answer = b == NULL ? CHIPS_SILENT : chips_reset(b, now_ns);
    return answer == CHIPS_ANSWER     ? WIRE_PULLED
           : answer == CHIPS_HELD_LOW ? WIRE_SHORTED
                                      : WIRE_SILENT;
}

static enum wire_answer wire_bit(void *context, uint64_t now_ns, unsigned bus, bool out)
{
    struct chips *b = bus_of(context, CHIP_ONEWIRE, bus);
    return b == NULL || chips_slot(b, now_ns, out) ? WIRE_SILENT : WIRE_PULLED;
}

/* ---- the whole ---- */

struct wired *wired_open(const char *path, uint64_t seed, char *err, size_t err_size)
{
    struct wired *w = calloc(1, sizeof(*w));
    if (w == NULL)
        return NULL;
    w->wiring = wiring_read(path, seed, err, err_size);
    if (w->wiring == NULL || wiring_n_outputs(w->wiring) > WIRED_OUTPUTS_MAX) {
        if (w->wiring != NULL)
            (void)sim_fail(err, err_size, "%s: more than %u outputs", path, WIRED_OUTPUTS_MAX);
        wired_close(w);
        return NULL;
    }
    w->n_outputs = wiring_n_outputs(w->wiring);
    for (size_t i = 0; i < w->n_outputs; i++) {
        const struct wiring_output *o = wiring_output(w->wiring, i);
        w->load[i] = (struct load){.drive = {PIN_FLOATS, PIN_FLOATS}, .pulses = -1.0};
        if (o->chip != NULL)
            o->chip->kind->clear(o->chip, 0, true);
    }
    w->world = (struct world){.context = w,
                              .pin_driven = pin_driven,
                              .pin_pulses = pin_pulses,
                              .pin_input = pin_input,
                              .next_edge = next_edge,
                              .pin_volts = pin_volts,
                              .spi_exchange = spi_exchange,
                              .i2c_address = i2c_address,
                              .i2c_write = i2c_write,
                              .i2c_read = i2c_read,
                              .i2c_stop = i2c_stop,
                              .i2c_held = i2c_held,
                              .wire_reset = wire_reset,
                              .wire_bit = wire_bit};
    wiring_power(w->wiring, 0, true);
    return w;
}

void wired_close(struct wired *w)
{
    if (w == NULL)
        return;
    wiring_free(w->wiring);
    free(w);
}

const struct world *wired_world(struct wired *w)
{
    return &w->world;
}

const struct wiring *wired_wiring(const struct wired *w)
{
    return w->wiring;
}

void wired_measure(struct wired *w, uint64_t now_ns, const char *sensor, double value)
{
    wiring_at(w->wiring, now_ns);
    if (strcmp(sensor, WIRED_TIME) == 0)
        wiring_begin(w->wiring, now_ns, value != 0.0);
    for (size_t i = 0; i < wiring_n_sensors(w->wiring); i++)
        if (strcmp(wiring_sensor(w->wiring, i)->name, sensor) == 0)
            wiring_measure(w->wiring, i, value);
}

bool wired_fault(struct wired *w, uint64_t now_ns, const char *name, const char *what, double value,
                 char *err, size_t err_size)
{
    wiring_at(w->wiring, now_ns);
    for (size_t i = 0; i < w->n_outputs; i++)
        pass(w, i, now_ns);
    return wiring_fault(w->wiring, now_ns, name, what, value, err, err_size);
}

size_t wired_loads(struct wired *w, uint64_t now_ns, double *ns)
{
    for (size_t i = 0; i < w->n_outputs; i++) {
        pass(w, i, now_ns);
        w->load[i].read_ns = now_ns;
        ns[i] = w->load[i].sum_ns;
    }
    return w->n_outputs;
}

static bool has_sensor(const struct wired *w, const char *name)
{
    for (size_t i = 0; i < wiring_n_sensors(w->wiring); i++)
        if (strcmp(wiring_sensor(w->wiring, i)->name, name) == 0)
            return true;
    return false;
}

/* A line without its end: "T1 78.3", "T1.open 1". */
static bool one_line(struct wired *w, uint64_t now_ns, char *line, char *err, size_t err_size)
{
    char *blank = strchr(line, ' ');
    double value;
    if (blank == NULL || !sim_parse_number(blank + 1, &value))
        return sim_fail(err, err_size, "pins.%s: must be a name, a blank and a number", line);
    *blank = '\0';
    char *dot = strchr(line, '.');
    if (dot == NULL && strcmp(line, WIRED_TIME) != 0 && !has_sensor(w, line))
        return sim_fail(err, err_size, "pins.%s: the wiring has no sensor of that name", line);
    if (dot == NULL) {
        wired_measure(w, now_ns, line, value);
        return true;
    }
    *dot = '\0';
    return wired_fault(w, now_ns, line, dot + 1, value, err, err_size);
}

size_t wired_lines(struct wired *w, uint64_t now_ns, char *text, size_t n, char *err,
                   size_t err_size)
{
    size_t left = 0, length;
    for (size_t at = 0; at < n; at += length) {
        const char *end = memchr(text + at, '\n', n - at);
        length = end == NULL ? n - at : (size_t)(end - (text + at)) + 1u;
        char line[LINE_SIZE];
        size_t head = sizeof(PREFIX) - 1u;
        if (length <= head || length > sizeof(line) || memcmp(text + at, PREFIX, head) != 0) {
            (void)memmove(text + left, text + at, length);
            left += length;
            continue;
        }
        (void)snprintf(line, sizeof(line), "%.*s", (int)(length - head - (end != NULL)),
                       text + at + head);
        if (!one_line(w, now_ns, line, err, err_size))
            return SIZE_MAX;
    }
    return left;
}
