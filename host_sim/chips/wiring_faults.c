/* What can happen to the lines and buses of a wiring file, by name, and which of it a line has.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <string.h>

#include "bench/text.h"
#include "chips/chip_inside.h"
#include "chips/wiring_inside.h"

#define ON_OR_OFF 0.0, 1.0

static const struct wiring_fault missing = {
    "missing", "", ON_OR_OFF, "no chip is there; one that is back has just got power"};
static const struct wiring_fault dead = {"dead", "", ON_OR_OFF,
                                         "the chip does not answer, and keeps its registers"};
static const struct wiring_fault wrong = {"wrong", "", ON_OR_OFF, "another chip is in its place"};
static const struct wiring_fault open_wire = {"open", "", ON_OR_OFF,
                                              "the wire is broken: 0 V, no current"};
static const struct wiring_fault noise = {"noise", "", 0.0, 1.0,
                                          "probability that a bit is wrong, each way"};
static const struct wiring_fault stuck = {"stuck", "", ON_OR_OFF, "the data line is low"};
static const struct wiring_fault floats_low = {
    "floats_low", "", ON_OR_OFF, "a data line that nobody drives reads 0 instead of 1"};
static const struct wiring_fault shorted = {"shorted", "", ON_OR_OFF,
                                            "the load is on, whatever the pin does"};
static const struct wiring_fault broken = {
    "broken", "", ON_OR_OFF, "the load is off, whatever the pin does; a valve stays where it is"};

static const struct wiring_sensor *sensor_named(const struct wiring *w, const char *name)
{
    for (size_t i = 0; i < w->n_sensors; i++) {
        if (strcmp(w->sensor[i].name, name) == 0) {
            return &w->sensor[i];
        }
    }
    return NULL;
}

static const struct wiring_output *output_named(const struct wiring *w, const char *name)
{
    for (size_t i = 0; i < w->n_outputs; i++) {
        if (strcmp(w->output[i].name, name) == 0) {
            return &w->output[i];
        }
    }
    return NULL;
}

static bool has_numbered_inputs(const struct chip_kind *kind)
{
    return strcmp(kind->inputs[0].name, "in0") == 0;
}

/* The plant gives this input its value in each sample, so that nothing else can. */
static bool is_measured(const struct wiring *w, const struct chip *chip, const char *input)
{
    for (size_t i = 0; i < w->n_sensors; i++) {
        if (w->sensor[i].chip == chip && strcmp(w->sensor[i].input, input) == 0) {
            return true;
        }
    }
    return has_numbered_inputs(chip->kind) && strncmp(input, "in", 2) == 0;
}

/* `stuck` of a chip has another name here, because `stuck` of a measurement is its sensor's (instruments.h). */
static const char *name_of_input(const char *input)
{
    return strcmp(input, "stuck") == 0 ? "frozen" : input;
}

/* Picks the n-th of those that are given to it one after the other. */
struct pick {
    size_t n;
    bool found;
    struct wiring_fault *fault;
};

static void offer(struct pick *p, struct wiring_fault fault)
{
    if (!p->found && p->n-- == 0) {
        *p->fault = fault;
        p->found = true;
    }
}

static void offer_sensor(struct pick *p, const struct wiring *w, const struct wiring_sensor *s)
{
    const struct chip_kind *kind = s->chip->kind;
    if (kind->bus != CHIP_PIN) {
        offer(p, missing);
        offer(p, dead);
    }
    if (kind->bus != CHIP_PIN && kind->bus != CHIP_ONEWIRE) {
        offer(p, wrong);
    }
    if (has_numbered_inputs(kind)) {
        offer(p, open_wire);
    }
    for (size_t i = 0; i < kind->n_inputs; i++) {
        const struct chip_input *in = &kind->inputs[i];
        if (!is_measured(w, s->chip, in->name)) {
            offer(p, (struct wiring_fault){name_of_input(in->name), in->unit, in->lo, in->hi,
                                           in->what});
        }
    }
}

static void offer_output(struct pick *p, const struct wiring_output *o)
{
    if (o->close_pin == HAL_PIN_NONE && o->kind != WIRING_STEPPER) {
        offer(p, shorted);
    }
    offer(p, broken);
    if (o->chip == NULL) {
        return;
    }
    offer(p, missing);
    offer(p, dead);
    for (size_t i = 0; i < o->chip->kind->n_inputs; i++) {
        const struct chip_input *in = &o->chip->kind->inputs[i];
        offer(p, (struct wiring_fault){in->name, in->unit, in->lo, in->hi, in->what});
    }
}

bool wiring_fault_at(const struct wiring *w, const char *name, size_t n, struct wiring_fault *fault)
{
    struct pick p = {.n = n, .fault = fault};
    enum chip_bus kind;
    unsigned number;
    const struct wiring_sensor *s = sensor_named(w, name);
    const struct wiring_output *o = output_named(w, name);
    if (wiring_bus_named(name, &kind, &number) && wiring_bus(w, kind, number) != NULL) {
        offer(&p, noise);
        offer(&p, stuck);
        if (kind == CHIP_SPI) {
            offer(&p, floats_low);
        }
    } else if (s != NULL) {
        offer_sensor(&p, w, s);
    } else if (o != NULL) {
        offer_output(&p, o);
    }
    return p.found;
}

static bool find(const struct wiring *w, const char *name, const char *what,
                 struct wiring_fault *fault)
{
    for (size_t n = 0; wiring_fault_at(w, name, n, fault); n++) {
        if (strcmp(fault->name, what) == 0) {
            return true;
        }
    }
    return false;
}

bool wiring_fault_check(const struct wiring *w, const char *name, const char *what, double value,
                        char *err, size_t err_size)
{
    struct wiring_fault f;
    if (!find(w, name, what, &f)) {
        (void)sim_fail(err, err_size, "%s has no fault \"%s\"; it has ", name, what);
        for (size_t n = 0; wiring_fault_at(w, name, n, &f); n++) {
            sim_append(err, err_size, "%s%s", n > 0 ? ", " : "", f.name);
        }
        return false;
    }
    return (value >= f.lo && value <= f.hi) ||
           sim_fail(err, err_size, "%s.%s must be %g to %g%s%s", name, what, f.lo, f.hi,
                    f.unit[0] != '\0' ? " " : "", f.unit);
}

bool wiring_has(const struct wiring *w, const char *name, const char *what)
{
    struct wiring_fault f;
    return what == NULL ? wiring_fault_at(w, name, 0, &f) : find(w, name, what, &f);
}

void wiring_append_names(const struct wiring *w, char *text, size_t size)
{
    const char *comma = "";
    for (size_t i = 0; i < w->n_sensors + w->n_outputs; i++) {
        sim_append(text, size, "%s%s", comma,
                   i < w->n_sensors ? w->sensor[i].name : w->output[i - w->n_sensors].name);
        comma = ", ";
    }
    for (unsigned kind = 0; kind < WIRING_BUS_KINDS; kind++) {
        for (unsigned i = 0; i < WIRING_BUSES_MAX; i++) {
            if (w->bus[kind][i] != NULL) {
                sim_append(text, size, ", %s%u", wiring_bus_names[kind], i + 1u);
            }
        }
    }
}

const char *wiring_fault_of_kind(const struct chip_kind *kind, size_t n)
{
    bool numbered = has_numbered_inputs(kind);
    if (numbered && n-- == 0) {
        return open_wire.name;
    }
    /* The first input of a chip that measures is what it measures. */
    for (size_t i = kind->drives == NULL ? 1u : 0u; i < kind->n_inputs; i++) {
        bool of_plant = numbered && strncmp(kind->inputs[i].name, "in", 2) == 0;
        if (!of_plant && n-- == 0) {
            return name_of_input(kind->inputs[i].name);
        }
    }
    return NULL;
}

/* ---- setting them ---- */

static struct chip **place_of(struct wiring *w, const struct chip *chip, struct chip **list)
{
    for (size_t i = 0; i < w->n_chips; i++) {
        if (w->chip[i] == chip) {
            return &list[i];
        }
    }
    return NULL;
}

/* A chip of another kind that can be where this one is: it has its select, or takes its address. */
static struct chip *make_other(const struct wiring *w, const struct wiring_sensor *s, char *err,
                               size_t err_size)
{
    const char *own = s->chip->kind->name;
    const char *kind = s->bus == CHIP_SPI ? strcmp(own, "max31865") == 0 ? "max31856" : "max31865"
                       : strcmp(own, "xgzp6897") == 0 ? "ads1115"
                                                      : "xgzp6897";
    struct chip *other = chip_new(kind, "", w->seed + 7u, err, err_size);
    for (size_t i = 0; other != NULL && i < other->kind->n_properties; i++) {
        if (strcmp(other->kind->properties[i].name, "address") == 0) {
            other->property[i] = s->address;
        }
    }
    return other;
}

static bool set_wrong(struct wiring *w, uint64_t now_ns, const struct wiring_sensor *s, bool on,
                      char *err, size_t err_size)
{
    struct chip **other = place_of(w, s->chip, w->other);
    struct chips *bus = wiring_bus(w, s->bus, s->bus_number);
    if (*other == NULL) {
        *other = make_other(w, s, err, err_size);
    }
    if (*other == NULL || (*other)->powered == on) {
        return *other != NULL;
    }
    chip_power(s->chip, now_ns, !on);
    chip_power(*other, now_ns, on);
    chips_replace(bus, on ? s->chip : *other, on ? *other : s->chip);
    return true;
}

bool wiring_fault(struct wiring *w, uint64_t now_ns, const char *name, const char *what,
                  double value, char *err, size_t err_size)
{
    bool on = value != 0.0;
    const struct wiring_sensor *s = sensor_named(w, name);
    const struct wiring_output *o = output_named(w, name);
    struct wiring_fault f;
    if (o != NULL && o->chip != NULL && strcmp(what, missing.name) == 0) {
        if (o->chip->powered == on) {
            chip_power(o->chip, now_ns, !on);
        }
        return true;
    }
    if (s == NULL || !find(w, name, what, &f)) {
        return wiring_set(w, name, what, value, err, err_size);
    }
    if (strcmp(what, "missing") == 0) {
        if (s->chip->powered == on) {
            chip_power(s->chip, now_ns, !on);
        }
        return true;
    }
    if (strcmp(what, "wrong") == 0) {
        return set_wrong(w, now_ns, s, on, err, err_size);
    }
    if (strcmp(what, "open") == 0 && has_numbered_inputs(s->chip->kind)) {
        w->sensor[s - w->sensor].open = on;
        if (on) {
            (void)chip_set(s->chip, s->input, 0.0, err, err_size);
        }
        return true;
    }
    return chip_set(s->chip, strcmp(what, "frozen") == 0 ? "stuck" : what, value, err, err_size);
}
