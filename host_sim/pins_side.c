/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "pins_side.h"

#include <math.h>
#include <string.h>

#include "bench/text.h"
#include "chips/wired.h"

#define NS_PER_MS 1e6
#define MS_NS     UINT64_C(1000000)

/* The line of the wiring for a quantity of the plant. */
static uint8_t line_of(const struct wiring *w, bool mv, const char *quantity)
{
    size_t n = mv ? wiring_n_outputs(w) : wiring_n_sensors(w);
    for (size_t i = 0; i < n; i++) {
        const char *name = mv ? wiring_output(w, i)->quantity : wiring_sensor(w, i)->quantity;
        if (strcmp(name, quantity) == 0)
            return (uint8_t)i;
    }
    return PINS_NONE;
}

static bool find_lines(struct pins_side *p, const struct plant_class *class, const char *path,
                       char *err, size_t err_size)
{
    size_t wired[2] = {0, 0};
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        bool mv = c->kind == PLANT_MV;
        size_t *n = mv ? &p->n_outputs : &p->n_measurements;
        if ((!mv && c->kind != PLANT_MEASUREMENT) || *n == LINK_CHANNELS_MAX)
            continue;
        uint8_t line = line_of(p->wiring, mv, c->name);
        (mv ? p->output_of : p->sensor_of)[(*n)++] = line;
        wired[mv] += line != PINS_NONE;
    }
    if (wired[0] == 0)
        return sim_fail(err, err_size, "%s: no line has the name of a measurement of the plant",
                        path);
    return wired[1] != 0 ||
           sim_fail(err, err_size,
                    "%s: no line has the name of a manipulated variable of the plant", path);
}

bool pins_side_open(struct pins_side *p, struct transport *port, const struct wiring *wiring,
                    const char *file, const struct plant_class *class, uint32_t tick_ms,
                    uint64_t seed, char *err, size_t err_size)
{
    *p = (struct pins_side){.port = port, .wiring = wiring, .tick_ms = tick_ms};
    if (port->ops->measure == NULL)
        return sim_fail(err, err_size, "--wiring %s: what is at %s has no pins", file, port->where);
    return find_lines(p, class, file, err, err_size) &&
           (port->ops->wire == NULL || port->ops->wire(port, file, seed, err, err_size));
}

bool pins_side_switches(const struct pins_side *p, size_t output)
{
    if (output >= p->n_outputs || p->output_of[output] == PINS_NONE)
        return false;
    enum wiring_kind kind = wiring_output(p->wiring, p->output_of[output])->kind;
    return kind == WIRING_SSR || kind == WIRING_RELAY;
}

void pins_side_turn(struct pins_side *p)
{
    uint8_t bytes[256];
    while (transport_read(p->port, bytes, sizeof(bytes)) > 0) {
    }
}

static uint64_t now_of(const struct pins_side *p)
{
    uint64_t now_ns, began_ns;
    p->port->ops->clock(p->port, &now_ns, &began_ns);
    return now_ns;
}

static void stop_at(struct pins_side *p, uint64_t ns)
{
    p->end_ns = ns;
    if (p->port->ops->limit != NULL)
        p->port->ops->limit(p->port, ns);
}

/* When the firmware's clock next is just before a whole multiple of step_ms. */
static uint64_t next_multiple(const struct pins_side *p, uint64_t step_ms)
{
    uint64_t now_ns, began_ns, step_ns = step_ms * MS_NS;
    p->port->ops->clock(p->port, &now_ns, &began_ns);
    uint64_t passed = now_ns - began_ns + MS_NS;
    return began_ns + passed - passed % step_ns + step_ns - MS_NS + PINS_DONE_NS;
}

static void measure(struct pins_side *p, const struct link_sample *sample)
{
    for (size_t i = 0; i < p->n_measurements; i++) {
        size_t first = p->sensor_of[i];
        for (size_t k = first; first != PINS_NONE && k < wiring_n_sensors(p->wiring); k++) {
            const struct wiring_sensor *s = wiring_sensor(p->wiring, k);
            if (strcmp(s->quantity, wiring_sensor(p->wiring, first)->quantity) == 0)
                p->port->ops->measure(p->port, s->name, (double)sample->measurement[i].value);
        }
    }
}

static uint64_t start_ms(const struct pins_side *p)
{
    return (PINS_START_MS + p->tick_ms - 1u) / p->tick_ms * p->tick_ms;
}

void pins_side_set_up(struct pins_side *p, const struct link_sample *sample)
{
    measure(p, sample);
    stop_at(p, next_multiple(p, start_ms(p)));
}

void pins_side_count(struct pins_side *p, bool flows)
{
    p->port->ops->measure(p->port, WIRED_TIME, flows ? 1.0 : 0.0);
}

bool pins_side_is_set_up(const struct pins_side *p)
{
    uint64_t now_ns, began_ns;
    p->port->ops->clock(p->port, &now_ns, &began_ns);
    return (now_ns - began_ns + MS_NS) % (start_ms(p) * MS_NS) < MS_NS;
}

void pins_side_next_sample(struct pins_side *p)
{
    stop_at(p, next_multiple(p, p->tick_ms) + p->tick_ms * MS_NS / 4u);
}

void pins_side_begin(struct pins_side *p, const struct link_sample *sample)
{
    measure(p, sample);
    (void)p->port->ops->loads(p->port, p->loads_ns, wiring_n_outputs(p->wiring));
    p->begin_ns = now_of(p);
    stop_at(p, p->begin_ns + p->tick_ms * MS_NS / 4u);
}

void pins_side_go_on(struct pins_side *p)
{
    stop_at(p, next_multiple(p, p->tick_ms));
}

uint64_t pins_side_left(const struct pins_side *p)
{
    uint64_t now_ns = now_of(p), left_ns = now_ns < p->end_ns ? p->end_ns - now_ns : 0;
    return (left_ns + (p->port->ops->limit != NULL ? MS_NS - 1u : 0)) / MS_NS;
}

/* Ms that a load was on, so that a board that takes microseconds to switch and one that takes none give the same numbers: whole ones of a load that
 * switches. The others differ by errors of rounding only, and no code of a chip makes a fraction of 0.3. */
static double rounded(const struct wiring_output *o, double ms)
{
    bool finely = o->kind == WIRING_CHIP || o->kind == WIRING_STEPPER;
    return finely ? floor(ms * 1e3 + 0.7) * 1e-3 : round(ms);
}

bool pins_side_end(struct pins_side *p, struct link_command *command)
{
    double ns[LINK_CHANNELS_MAX];
    if (!p->port->ops->loads(p->port, ns, wiring_n_outputs(p->wiring)))
        return false;
    double ms = round((double)(now_of(p) - p->begin_ns) / NS_PER_MS);
    if (p->port->ops->limit != NULL)
        p->port->ops->limit(p->port, 0);
    command->n_outputs = (uint8_t)p->n_outputs;
    for (size_t i = 0; i < p->n_outputs; i++) {
        uint8_t line = p->output_of[i];
        command->output[i].drive = line != PINS_NONE;
        if (line == PINS_NONE)
            continue;
        const struct wiring_output *o = wiring_output(p->wiring, line);
        double on_ms = (ns[line] - p->loads_ns[line]) / NS_PER_MS;
        double part = ms > 0.0 ? fmin(rounded(o, on_ms) / ms, 1.0) : 0.0;
        command->output[i].value = (float)(o->lo + (o->hi - o->lo) * part);
    }
    return true;
}
