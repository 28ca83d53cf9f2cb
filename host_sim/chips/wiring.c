/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "chips/wiring.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"
#include "chips/wiring_inside.h"

#define LINE_SIZE 512

struct wiring *wiring_read(const char *path, uint64_t seed, char *err, size_t err_size)
{
    FILE *f = sim_open_text(path, err, err_size);
    if (f == NULL) {
        return NULL;
    }
    struct wiring *w = calloc(1, sizeof(*w));
    bool good = w != NULL || sim_fail(err, err_size, "%s: no memory", path);
    char text[LINE_SIZE];
    char reason[SIM_ERROR_SIZE];
    if (w != NULL) {
        w->seed = seed;
    }
    for (unsigned line = 1; good && fgets(text, sizeof(text), f) != NULL; line++) {
        if (strlen(text) == sizeof(text) - 1) {
            good = sim_fail(err, err_size, "%s, line %u: longer than %d characters", path, line,
                            LINE_SIZE - 2);
        } else if (!wiring_line(w, text, line, reason, sizeof(reason))) {
            good = sim_fail(err, err_size, "%s, line %u: %s", path, line, reason);
        }
    }
    (void)fclose(f);
    if (!good) {
        wiring_free(w);
        return NULL;
    }
    return w;
}

void wiring_free(struct wiring *w)
{
    if (w == NULL) {
        return;
    }
    for (size_t i = 0; i < w->n_chips; i++) {
        chip_free(w->chip[i]);
        chip_free(w->other[i]);
    }
    for (size_t kind = 0; kind < WIRING_BUS_KINDS; kind++) {
        for (size_t i = 0; i < WIRING_BUSES_MAX; i++) {
            chips_free(w->bus[kind][i]);
        }
    }
    free(w);
}

size_t wiring_n_sensors(const struct wiring *w)
{
    return w->n_sensors;
}

const struct wiring_sensor *wiring_sensor(const struct wiring *w, size_t i)
{
    return &w->sensor[i];
}

size_t wiring_n_outputs(const struct wiring *w)
{
    return w->n_outputs;
}

const struct wiring_output *wiring_output(const struct wiring *w, size_t i)
{
    return &w->output[i];
}

struct chips *wiring_bus(const struct wiring *w, enum chip_bus kind, unsigned number)
{
    bool is_bus = kind < WIRING_BUS_KINDS && number >= 1 && number <= WIRING_BUSES_MAX;
    return is_bus ? w->bus[kind][number - 1] : NULL;
}

void wiring_power(struct wiring *w, uint64_t now_ns, bool on)
{
    for (size_t i = 0; i < w->n_chips; i++) {
        chip_power(w->chip[i], now_ns, on);
    }
}

void wiring_begin(struct wiring *w, uint64_t now_ns, bool flows)
{
    for (size_t i = 0; i < w->n_chips; i++) {
        if (w->chip[i]->kind->begin != NULL) {
            w->chip[i]->kind->begin(w->chip[i], now_ns, flows);
        }
    }
}

const struct chip *wiring_at_pin(const struct wiring *w, unsigned pin)
{
    for (size_t i = 0; i < w->n_sensors; i++) {
        if (w->sensor[i].bus == CHIP_PIN && w->sensor[i].select == pin) {
            return w->sensor[i].chip;
        }
    }
    return NULL;
}

void wiring_at(struct wiring *w, uint64_t now_ns)
{
    for (size_t i = 0; i < w->n_chips; i++) {
        chip_at(w->chip[i], now_ns);
        if (w->other[i] != NULL) {
            chip_at(w->other[i], now_ns);
        }
    }
}

void wiring_measure(struct wiring *w, size_t sensor, double value)
{
    const struct wiring_sensor *s = &w->sensor[sensor];
    int i = chip_input_index(s->chip->kind, s->input);
    const struct chip_input *in = &s->chip->kind->inputs[i];
    double part = (value - s->lo) / (s->hi - s->lo);
    double x = s->lo_in + part * (s->hi_in - s->lo_in);
    s->chip->input[i] = s->open ? 0.0 : fmin(fmax(x, in->lo), in->hi);
}

static bool set_output(struct wiring_output *o, const char *what, double value, char *err,
                       size_t err_size)
{
    if (strcmp(what, "shorted") == 0) {
        o->shorted = value != 0.0;
    } else if (strcmp(what, "broken") == 0) {
        o->broken = value != 0.0;
    } else if (o->chip != NULL) {
        return chip_set(o->chip, what, value, err, err_size);
    } else {
        return sim_fail(err, err_size, "output %s has no fault %s; it has shorted, broken", o->name,
                        what);
    }
    return true;
}

bool wiring_set(struct wiring *w, const char *name, const char *what, double value, char *err,
                size_t err_size)
{
    enum chip_bus kind;
    unsigned number;
    if (wiring_bus_named(name, &kind, &number)) {
        struct chips *b = wiring_bus(w, kind, number);
        return b == NULL ? sim_fail(err, err_size, "nothing is wired to %s", name)
                         : chips_set(b, what, value, err, err_size);
    }
    for (size_t i = 0; i < w->n_sensors; i++) {
        if (strcmp(w->sensor[i].name, name) == 0) {
            return chip_set(w->sensor[i].chip, what, value, err, err_size);
        }
    }
    for (size_t i = 0; i < w->n_outputs; i++) {
        if (strcmp(w->output[i].name, name) == 0) {
            return set_output(&w->output[i], what, value, err, err_size);
        }
    }
    return sim_fail(err, err_size, "nothing called %s is wired", name);
}

bool wiring_load(const struct wiring_output *output, bool high)
{
    bool on = high != output->low_active;
    return !output->broken && (output->shorted || on);
}

const char *wiring_wrong(const struct wiring *w, unsigned *count)
{
    const char *first = "";
    unsigned wrongs = 0;
    for (size_t i = 0; i < w->n_chips; i++) {
        wrongs += w->chip[i]->wrongs;
        first = first[0] == '\0' ? w->chip[i]->wrong : first;
    }
    if (count != NULL) {
        *count = wrongs;
    }
    return first;
}
