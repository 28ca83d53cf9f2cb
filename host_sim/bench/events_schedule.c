/* The order of a run's events: what only shows in it is checked, and each is carried out when its time has come. */
#include <string.h>

#include "bench/events.h"
#include "bench/text.h"
#include "plants/plant_inputs.h"

_Static_assert(EVENTS_MAX + SWINGS_MAX <= PLANT_CHANGES_MAX, "all events may come at one time");

static void sort_by_time(struct events *e)
{
    for (size_t i = 1; i < e->n; i++) { /* insertion: keeps the order of equal times */
        struct event moving = e->list[i];
        size_t k = i;
        for (; k > 0 && e->list[k - 1].time_s > moving.time_s; k--) {
            e->list[k] = e->list[k - 1];
        }
        e->list[k] = moving;
    }
}

/* A swing about where the disturbance stands then, as far as events say; it begins at its nominal value. */
static bool check_swings(const struct events *e, const struct plant_class *class, size_t channel,
                         char *err, size_t err_size)
{
    const struct plant_channel *c = &class->channels[channel];
    double middle = c->nominal;
    double amplitude = 0.0;
    for (size_t i = 0; i < e->n; i++) {
        const struct event *event = &e->list[i];
        if (event->channel != channel ||
            (event->kind != EVENT_DISTURBANCE && event->kind != EVENT_SWING)) {
            continue;
        }
        middle = event->kind == EVENT_DISTURBANCE ? event->value : middle;
        amplitude = event->kind == EVENT_SWING ? event->value : amplitude;
        bool last_of_time = true;
        for (size_t k = i + 1; k < e->n && e->list[k].time_s <= event->time_s; k++) {
            last_of_time = last_of_time && e->list[k].channel != channel;
        }
        if (last_of_time && (middle - amplitude < c->lo || middle + amplitude > c->hi)) {
            return sim_fail(err, err_size,
                            "--event: from %g s %s swings from %g to %g; it must stay within %g to "
                            "%g %s",
                            event->time_s, c->name, middle - amplitude, middle + amplitude, c->lo,
                            c->hi, c->unit);
        }
    }
    return true;
}

bool events_finish(struct events *e, const struct plant_class *class, char *err, size_t err_size)
{
    sort_by_time(e);
    for (size_t c = 0; c < class->n_channels; c++) {
        double lo = class->channels[c].lo;
        double hi = class->channels[c].hi;
        if (!check_swings(e, class, c, err, err_size)) {
            return false;
        }
        for (size_t i = 0; i < e->n; i++) {
            const struct event *event = &e->list[i];
            if (event->kind != EVENT_OPTION || event->channel != c) {
                continue;
            }
            lo = event->option == OPTION_LO ? event->value : lo;
            hi = event->option == OPTION_HI ? event->value : hi;
            bool last_of_time = true; /* both limits may move at one time, in either order */
            for (size_t k = i + 1; k < e->n && e->list[k].time_s <= event->time_s; k++) {
                last_of_time = last_of_time && e->list[k].channel != c;
            }
            if (lo > hi && last_of_time) {
                return sim_fail(err, err_size,
                                "--event: at %g s %s.lo is %g and %s.hi is %g; lo must not be "
                                "above hi",
                                event->time_s, class->channels[c].name, lo, class->channels[c].name,
                                hi);
            }
        }
    }
    return true;
}

/* A later event that is done sets the same thing. */
static bool overridden(const struct events *e, size_t at)
{
    const struct event *x = &e->list[at];
    for (size_t i = at + 1; i < e->next; i++) {
        const struct event *later = &e->list[i];
        if (later->kind == x->kind && x->kind != EVENT_BOARD && later->channel == x->channel &&
            later->option == x->option && strcmp(later->pins, x->pins) == 0) {
            return true;
        }
    }
    return false;
}

static void drop_overridden(struct events *e)
{
    size_t kept = 0;
    size_t done = 0;
    for (size_t i = 0; i < e->n; i++) {
        bool past = i < e->next;
        if (!past || !overridden(e, i)) {
            e->list[kept] = e->list[i];
            kept++;
            done += past ? 1u : 0u;
        }
    }
    e->n = kept;
    e->next = done;
}

bool events_insert(struct events *e, const struct plant_class *class, const char *text, char *err,
                   size_t err_size)
{
    static struct event before[EVENTS_MAX];
    if (e->n == EVENTS_MAX) {
        drop_overridden(e);
    }
    size_t n = e->n;
    size_t next = e->next;
    (void)memcpy(before, e->list, sizeof(before));
    if (!events_add(e, class, text, err, err_size)) {
        return false;
    }
    struct event *added = &e->list[n];
    if (next > 0 && added->time_s < e->list[next - 1].time_s) {
        added->time_s = e->list[next - 1].time_s; /* nothing is put among what is done */
    }
    if (!events_finish(e, class, err, err_size)) {
        (void)memcpy(e->list, before, sizeof(before));
        e->n = n;
        return false;
    }
    return true;
}

/* Value of an input after the changes of this time. */
static double stands_at(const struct plant_class *class, const struct plant *plant, size_t channel,
                        const struct plant_change *change, size_t n)
{
    for (; n > 0; n--) {
        if (change[n - 1].channel == channel) {
            return change[n - 1].value;
        }
    }
    return class->value(plant, channel);
}

bool events_apply(struct events *e, double time_s, struct plant *plant, struct instruments *in,
                  char *err, size_t err_size)
{
    struct plant_change change[PLANT_CHANGES_MAX];
    size_t changes = 0;
    struct sim_swing *swing;
    for (; e->next < e->n && e->list[e->next].time_s <= time_s; e->next++) {
        const struct event *event = &e->list[e->next];
        switch (event->kind) {
        case EVENT_DISTURBANCE:
            if (!swings_moved(&e->swings, event->channel, event->value)) {
                change[changes] = (struct plant_change){event->channel, event->value};
                changes++;
            }
            break;
        case EVENT_SWING:
        case EVENT_PERIOD:
            swing = swings_of(&e->swings, event->channel,
                              stands_at(in->class, plant, event->channel, change, changes));
            if (swing == NULL) {
                return sim_fail(err, err_size, "--event: more than %d disturbances that swing",
                                SWINGS_MAX);
            }
            if (event->kind == EVENT_PERIOD) {
                swing->period_s = event->value;
            } else {
                swing_set_amplitude(swing, event->value, time_s);
            }
            break;
        case EVENT_OPTION:
            instruments_set(in, event->channel, event->option, event->value);
            break;
        case EVENT_NOISE:
            instruments_noise(in, event->value);
            break;
        case EVENT_PINS:
            if (e->board == NULL || !transport_pins_fault(e->board, event->pins, event->value)) {
                return sim_fail(err, err_size, "--event: the board does not take the fault %s=%g",
                                event->pins, event->value);
            }
            break;
        case EVENT_BOARD:
            if (e->board == NULL ||
                !transport_fault(e->board, fault_table[event->fault].name, event->value)) {
                return sim_fail(err, err_size,
                                "--event: board.%s is a fault of a virtual board (--port "
                                "board:PATH), and the firmware runs on none",
                                fault_table[event->fault].name);
            }
            break;
        }
    }
    changes = swings_add(&e->swings, time_s, change, changes);
    return changes == 0 || plant_set_inputs(in->class, plant, change, changes, err, err_size);
}
