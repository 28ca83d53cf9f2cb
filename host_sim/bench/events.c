#include "bench/events.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/text.h"

static const struct {
    const char *name;
    double lo, hi; /* allowed values; in_span: of an MV the span of its channel holds instead */
    enum instrument_option option;
    bool sensor, actuator, in_span;
} options[] = {
    {"bias", -1e9, 1e9, OPTION_BIAS, true, false, false},
    {"noise", 0.0, 1e9, OPTION_NOISE, true, false, false},
    {"resolution", 0.0, 1e9, OPTION_RESOLUTION, true, false, false},
    {"quality", 0.0, 3.0, OPTION_QUALITY, true, false, false},
    {"lag", 0.0, 1e6, OPTION_LAG, true, true, false},
    {"hi", 0.0, 0.0, OPTION_HI, false, true, true},
    {"lo", 0.0, 0.0, OPTION_LO, false, true, true},
    {"slew", 0.0, 1e9, OPTION_SLEW, false, true, false},
    {"stuck", -1e9, 1e9, OPTION_STUCK, true, true, true},
    {"free", 1.0, 1.0, OPTION_FREE, true, true, false},
    {"drift", -1e9, 1e9, OPTION_DRIFT, true, false, false},
    {"frozen", 0.0, 1.0, OPTION_FROZEN, true, false, false},
    {"dead", 0.0, 1.0, OPTION_DEAD, true, false, false},
    {"spike", 0.0, 1e9, OPTION_SPIKE, true, false, false},
    {"hum", 0.0, 1e9, OPTION_HUM, true, false, false},
    {"hum_period", 0.001, 1e6, OPTION_HUM_PERIOD, true, false, false},
    {"spike_rate", 0.0, 1e9, OPTION_SPIKE_RATE, true, false, false},
    {"dropout", 0.0, 1.0, OPTION_DROPOUT, true, false, false},
    {"nan", 0.0, 1.0, OPTION_NAN, true, false, false},
    {"every", 1.0, ANALYSER_EVERY_MAX, OPTION_EVERY, true, false, false},
    {"phase", 0.0, 9999.0, OPTION_PHASE, true, false, false},
    {"delay", 0.0, ANALYSER_DELAY_MAX, OPTION_DELAY, true, false, false},
    {"stiction", 0.0, 1e9, OPTION_STICTION, false, true, false},
    {"backlash", 0.0, 1e9, OPTION_BACKLASH, false, true, false},
    {"gain", 0.0, 100.0, OPTION_GAIN, false, true, false},
    {"readback", 0.0, 2.0, OPTION_READBACK, false, true, false},
};

_Static_assert(sizeof(options) / sizeof(options[0]) == OPTION_COUNT, "every option has a row");

static const struct plant_channel *find(const struct plant_class *class, const char *name,
                                        size_t *index)
{
    for (size_t i = 0; i < class->n_channels; i++) {
        if (strcmp(class->channels[i].name, name) == 0) {
            *index = i;
            return &class->channels[i];
        }
    }
    return NULL;
}

static void append_channels(char *text, size_t size, const struct plant_class *class,
                            enum plant_kind kind)
{
    const char *comma = "";
    for (size_t i = 0; i < class->n_channels; i++) {
        if (class->channels[i].kind == kind) {
            sim_append(text, size, "%s%s", comma, class->channels[i].name);
            comma = ", ";
        }
    }
}

const char *events_option(enum plant_kind kind, size_t n)
{
    for (size_t k = 0; k < OPTION_COUNT; k++) {
        if (!(kind == PLANT_MEASUREMENT ? options[k].sensor : options[k].actuator)) {
            continue;
        }
        if (n == 0) {
            return options[k].name;
        }
        n--;
    }
    return NULL;
}

static void append_options(char *text, size_t size, enum plant_kind kind)
{
    const char *name;
    for (size_t n = 0; (name = events_option(kind, n)) != NULL; n++) {
        sim_append(text, size, "%s%s", n > 0 ? ", " : "", name);
    }
}

static bool unknown_name(const struct plant_class *class, const char *text, const char *name,
                         char *err, size_t err_size)
{
    (void)sim_fail(err, err_size, "--event %s: plant %s has no \"%s\"; disturbances: ", text,
                   class->name, name);
    append_channels(err, err_size, class, PLANT_DISTURBANCE);
    sim_append(err, err_size, " (swing, period); with an option behind a dot: ");
    append_channels(err, err_size, class, PLANT_MEASUREMENT);
    sim_append(err, err_size, " (");
    append_options(err, err_size, PLANT_MEASUREMENT);
    sim_append(err, err_size, "), ");
    append_channels(err, err_size, class, PLANT_MV);
    sim_append(err, err_size, " (");
    append_options(err, err_size, PLANT_MV);
    sim_append(err, err_size, "); noise");
    return false;
}

static bool check_range(const char *text, const char *name, double value, double lo, double hi,
                        const char *unit, char *err, size_t err_size)
{
    if (value >= lo && value <= hi) {
        return true;
    }
    return sim_fail(err, err_size, "--event %s: %s must be %g to %g%s%s", text, name, lo, hi,
                    unit[0] != '\0' ? " " : "", unit);
}

/* Adds the swing of a disturbance. */
static bool add_swing(struct event *event, const struct plant_class *class, const char *text,
                      const char *name, const char *option, char *err, size_t err_size)
{
    const struct plant_channel *c = &class->channels[event->channel];
    char full[132];
    (void)snprintf(full, sizeof(full), "%s.%s", name, option);
    if (strcmp(option, "swing") == 0) {
        event->kind = EVENT_SWING;
        return check_range(text, full, event->value, 0.0, (c->hi - c->lo) / 2.0, c->unit, err,
                           err_size);
    }
    if (strcmp(option, "period") == 0) {
        event->kind = EVENT_PERIOD;
        return check_range(text, full, event->value, SWING_PERIOD_MIN, SWING_PERIOD_MAX, "s", err,
                           err_size);
    }
    return sim_fail(err, err_size,
                    "--event %s: the disturbance %s has no option \"%s\"; it has swing, period",
                    text, name, option);
}

static bool add_fault(struct event *event, const char *text, const char *name, char *err,
                      size_t err_size)
{
    event->kind = EVENT_BOARD;
    event->fault = fault_find(name);
    if (event->fault == FAULT_KINDS) {
        (void)sim_fail(err, err_size, "--event %s: a board has no fault \"%s\"; it has ", text,
                       name);
        for (size_t k = 0; k < FAULT_KINDS; k++) {
            sim_append(err, err_size, "%s%s", k > 0 ? ", " : "", fault_table[k].name);
        }
        return false;
    }
    const struct fault_row *row = &fault_table[event->fault];
    char full[64];
    (void)snprintf(full, sizeof(full), "board.%s", name);
    if (!check_range(text, full, event->value, row->lo, row->hi, row->unit, err, err_size)) {
        return false;
    }
    return !row->whole || event->value == floor(event->value) ||
           sim_fail(err, err_size, "--event %s: %s must be a whole number", text, full);
}

/* What a measurement or an output at the pins cannot have: only the plant link says it. */
static bool is_of_link(enum instrument_option option)
{
    return option == OPTION_QUALITY || option == OPTION_DEAD || option == OPTION_DROPOUT ||
           option == OPTION_NAN || option == OPTION_READBACK;
}

static void append_options_before_pins(char *text, size_t size, enum plant_kind kind)
{
    const char *between = "; before the pins it has ";
    for (size_t k = 0; k < OPTION_COUNT; k++) {
        bool fits = kind == PLANT_MEASUREMENT ? options[k].sensor : options[k].actuator;
        if (fits && !is_of_link(options[k].option)) {
            sim_append(text, size, "%s%s", between, options[k].name);
            between = ", ";
        }
    }
}

static const struct plant_channel *instrument(const struct plant_class *class, const char *name,
                                              const char *option, enum instrument_option *found)
{
    size_t unused;
    const struct plant_channel *c = find(class, name, &unused);
    for (size_t k = 0; c != NULL && k < OPTION_COUNT; k++) {
        bool fits = c->kind == PLANT_MEASUREMENT ? options[k].sensor
                                                 : c->kind == PLANT_MV && options[k].actuator;
        if (fits && strcmp(options[k].name, option) == 0) {
            *found = options[k].option;
            return c;
        }
    }
    return NULL;
}

/* Whether the name behind the time is one for the wiring: an option that only the instrument before the pins has is not. */
static bool is_for_pins(const struct events *e, const struct plant_class *class, const char *name,
                        const char *option)
{
    enum instrument_option found;
    return e->wiring != NULL && wiring_has(e->wiring, name, NULL) &&
           (wiring_has(e->wiring, name, option) ||
            instrument(class, name, option, &found) == NULL || is_of_link(found));
}

static bool add_pins(const struct events *e, struct event *event, const struct plant_class *class,
                     const char *text, const char *name, const char *option, char *err,
                     size_t err_size)
{
    char reason[SIM_ERROR_SIZE];
    size_t unused;
    event->kind = EVENT_PINS;
    sim_append(event->pins, sizeof(event->pins), "%s.%s", name, option);
    if (wiring_fault_check(e->wiring, name, option, event->value, reason, sizeof(reason))) {
        return true;
    }
    (void)sim_fail(err, err_size, "--event %s: %s", text, reason);
    const struct plant_channel *c = find(class, name, &unused);
    if (c != NULL && strstr(reason, "has no fault") != NULL) {
        append_options_before_pins(err, err_size, c->kind);
    }
    return false;
}

bool events_want_board(const struct events *e)
{
    for (size_t i = 0; i < e->n; i++) {
        if (e->list[i].kind == EVENT_BOARD) {
            return true;
        }
    }
    return false;
}

static bool add_option(struct event *event, const struct plant_class *class, const char *text,
                       const char *name, const char *option, char *err, size_t err_size)
{
    const struct plant_channel *c = find(class, name, &event->channel);
    if (c != NULL && c->kind == PLANT_DISTURBANCE) {
        return add_swing(event, class, text, name, option, err, err_size);
    }
    if (c == NULL || (c->kind != PLANT_MV && c->kind != PLANT_MEASUREMENT)) {
        return unknown_name(class, text, name, err, err_size);
    }
    event->kind = EVENT_OPTION;
    for (size_t k = 0; k < OPTION_COUNT; k++) {
        bool fits = c->kind == PLANT_MEASUREMENT ? options[k].sensor : options[k].actuator;
        if (!fits || strcmp(options[k].name, option) != 0) {
            continue;
        }
        event->option = options[k].option;
        char full[132];
        (void)snprintf(full, sizeof(full), "%s.%s", name, option);
        bool in_span = options[k].in_span && c->kind == PLANT_MV;
        double lo = in_span ? c->lo : options[k].lo;
        double hi = in_span ? c->hi : options[k].hi;
        const char *unit = in_span ? c->unit : "";
        if (!check_range(text, full, event->value, lo, hi, unit, err, err_size)) {
            return false;
        }
        if (event->option == OPTION_QUALITY && event->value != (double)(int)event->value) {
            return sim_fail(err, err_size, "--event %s: %s must be 0, 1, 2 or 3", text, full);
        }
        bool choice = event->option == OPTION_FROZEN || event->option == OPTION_DEAD ||
                      event->option == OPTION_NAN || event->option == OPTION_READBACK ||
                      event->option == OPTION_EVERY || event->option == OPTION_PHASE ||
                      event->option == OPTION_DELAY;
        if (choice && event->value != (double)(int)event->value) {
            return sim_fail(err, err_size, "--event %s: %s must be a whole number", text, full);
        }
        return true;
    }
    (void)sim_fail(err, err_size, "--event %s: %s has no option \"%s\"; it has ", text, name,
                   option);
    append_options(err, err_size, c->kind);
    return false;
}

static bool add_plain(struct event *event, const struct plant_class *class, const char *text,
                      const char *name, char *err, size_t err_size)
{
    const struct plant_channel *c = find(class, name, &event->channel);
    if (c == NULL && strcmp(name, "noise") == 0) {
        event->kind = EVENT_NOISE;
        return check_range(text, name, event->value, 0.0, 1e6, "", err, err_size);
    }
    if (c == NULL || c->kind == PLANT_INTERNAL) {
        return unknown_name(class, text, name, err, err_size);
    }
    if (c->kind != PLANT_DISTURBANCE) {
        (void)sim_fail(err, err_size,
                       c->kind == PLANT_MV
                           ? "--event %s: %s is driven by the controller; an event can set its "
                           : "--event %s: %s is measured; an event can set its ",
                       text, name);
        append_options(err, err_size, c->kind);
        sim_append(err, err_size, " (as %s.%s=...)", name, c->kind == PLANT_MV ? "hi" : "bias");
        return false;
    }
    event->kind = EVENT_DISTURBANCE;
    return check_range(text, name, event->value, c->lo, c->hi, c->unit, err, err_size);
}

/* Copies what stands before `end`; false when it is empty or does not fit. */
static bool cut(const char *from, const char *end, char *to, size_t size)
{
    size_t n = (size_t)(end - from);
    if (n == 0 || n >= size) {
        return false;
    }
    (void)memcpy(to, from, n);
    to[n] = '\0';
    return true;
}

/* An event this plant would take: its first disturbance as it is, else an option of what it measures. */
static void append_example(char *text, size_t size, const struct plant_class *class)
{
    const struct plant_channel *measured = NULL;
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        if (c->kind == PLANT_DISTURBANCE) {
            sim_append(text, size, ", as in 600:%s=%g", c->name, c->nominal);
            return;
        }
        measured = c->kind == PLANT_MEASUREMENT && measured == NULL ? c : measured;
    }
    if (measured != NULL) {
        sim_append(text, size, ", as in 600:%s.bias=1", measured->name);
    }
}

bool events_add(struct events *e, const struct plant_class *class, const char *text, char *err,
                size_t err_size)
{
    char time[64];
    char name[64];
    struct event event = {.time_s = 0.0};
    const char *colon = strchr(text, ':');
    const char *equals = colon != NULL ? strchr(colon, '=') : NULL;
    if (equals == NULL || !cut(text, colon, time, sizeof(time)) ||
        !cut(colon + 1, equals, name, sizeof(name))) {
        (void)sim_fail(err, err_size, "--event %s: expected T:NAME=VALUE", text);
        append_example(err, err_size, class);
        return false;
    }
    if (!sim_parse_number(time, &event.time_s) || event.time_s < 0.0) {
        return sim_fail(err, err_size,
                        "--event %s: the time \"%s\" must be a number of seconds, 0 or more", text,
                        time);
    }
    if (!sim_parse_number(equals + 1, &event.value)) {
        return sim_fail(err, err_size, "--event %s: the value \"%s\" is not a number", text,
                        equals + 1);
    }
    char *dot = strchr(name, '.');
    bool good;
    if (dot != NULL) {
        *dot = '\0';
        size_t unused;
        bool board = strcmp(name, "board") == 0 && find(class, name, &unused) == NULL;
        if (is_for_pins(e, class, name, dot + 1)) {
            good = add_pins(e, &event, class, text, name, dot + 1, err, err_size);
        } else if (e->wiring != NULL && !board && find(class, name, &unused) == NULL) {
            (void)sim_fail(err, err_size,
                           "--event %s: neither the plant nor the wiring has \"%s\"; wired are ",
                           text, name);
            wiring_append_names(e->wiring, err, err_size);
            good = false;
        } else {
            good = board ? add_fault(&event, text, dot + 1, err, err_size)
                         : add_option(&event, class, text, name, dot + 1, err, err_size);
        }
    } else {
        good = add_plain(&event, class, text, name, err, err_size);
    }
    if (!good) {
        return false;
    }
    if (e->n == EVENTS_MAX) {
        return sim_fail(err, err_size, "--event %s: more than %d events", text, EVENTS_MAX);
    }
    e->list[e->n] = event;
    e->n++;
    return true;
}
