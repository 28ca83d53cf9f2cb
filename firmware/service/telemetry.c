#include "service/telemetry.h"

#include <string.h>

#include "exchange/sampling.h"

void telemetry_init(struct telemetry *t)
{
    memset(t, 0, sizeof *t);
    spsc_init(&t->index, TELEMETRY_QUEUE_SIZE);
}

void telemetry_capture(struct telemetry *t, const struct supervisor *s, uint32_t number,
                       uint32_t events, uint32_t cycles)
{
    uint32_t every = t->every;
    if (every == 0 || s->ticks % every != 0)
        return;
    if (!spsc_can_write(&t->index)) {
        t->lost++;
        return;
    }
    struct telemetry_row *row = &t->slot[spsc_write_index(&t->index)];
    const struct config *c = &s->plan->config;
    row->plan = s->plan;
    row->number = number;
    row->time_ms = s->time_ms;
    row->state = (uint8_t)s->state;
    row->events = events;
    row->cycles = cycles;
    for (unsigned i = 0; i < s->placed[PLACED_MEASUREMENTS]; i++) {
        const struct measurement_config *m = &c->measurement[i];
        row->measurement[i] = span_to_eu(s->measurement[i].value, m->lo, m->hi);
        row->quality[i] = (uint8_t)s->measurement[i].quality;
    }
    for (unsigned i = 0; i < s->placed[PLACED_MVS]; i++) {
        const struct mv_config *o = &c->mv[i];
        row->commanded[i] = span_to_eu(s->mv[i].commanded, o->lo, o->hi);
        row->applied[i] = span_to_eu(s->mv[i].applied, o->lo, o->hi);
    }
    for (unsigned i = 0; i < s->placed[PLACED_LOOPS]; i++) {
        row->mode[i] = (uint8_t)s->loop[i].mode;
        if (!s->plan->loop[i].used)
            continue;
        const struct measurement_config *m = &c->measurement[s->plan->loop[i].pv];
        row->setpoint[i] = span_to_eu(s->loop[i].setpoint, m->lo, m->hi);
    }
    row->sequence = sequence_phase(&s->sequence);
    row->step = (uint8_t)(row->sequence == SEQUENCE_IDLE ? 0u : sequence_row(&s->sequence) + 1u);
    row->offsets = 0;
    row->fresh = 0;
    for (unsigned i = 0; i < s->placed[PLACED_MEASUREMENTS]; i++) {
        const struct measurement_state *m = &s->measurement[i];
        row->offsets = (uint16_t)(row->offsets | (measurement_offset_is_on(m) ? 1u << i : 0u));
        row->fresh = (uint16_t)(row->fresh | (sampling_is_fresh(m) ? 1u << i : 0u));
    }
    spsc_write_done(&t->index);
}

static void column(struct text *line, const char *name, const char *suffix, const char *unit)
{
    text_char(line, ',');
    text_str(line, name);
    text_str(line, suffix);
    if (unit) {
        text_char(line, '[');
        text_str(line, unit[0] ? unit : "-");
        text_char(line, ']');
    }
}

/* The pieces of a line: head, measurements, loops, outputs, tail. */
enum part { PART_HEAD, PART_MEASUREMENT, PART_LOOP, PART_OUTPUT, PART_TAIL, PART_NONE };

static enum part part_of(unsigned n, unsigned *i)
{
    static const unsigned sizes[] = {1, CHANNEL_MAX, CONFIG_LOOPS, CHANNEL_MAX, 1};
    unsigned part = 0;
    while (part < PART_NONE && n >= sizes[part])
        n -= sizes[part++];
    *i = n;
    return (enum part)part;
}

bool telemetry_header(const struct plan *plan, unsigned n, struct text *piece)
{
    const struct config *c = &plan->config;
    unsigned i;
    switch (part_of(n, &i)) {
    case PART_HEAD:
        text_str(piece, "H,");
        text_u32(piece, TELEMETRY_FORMAT);
        text_str(piece, ",number,time[s],state,ev");
        text_str(piece, CONFIG_STEPS && plan->has_steps ? ",seq,step" : "");
        return true;
    case PART_MEASUREMENT:
        if (!c->measurement[i].name[0])
            return true;
        column(piece, c->measurement[i].name, "", c->measurement[i].unit);
        column(piece, c->measurement[i].name, ".q", NULL);
        if (measurement_offset_of(&c->measurement[i]) != 0.0f)
            column(piece, c->measurement[i].name, ".off", c->measurement[i].unit);
        if (sampling_every(&c->measurement[i]) > 1)
            column(piece, c->measurement[i].name, ".new", NULL);
        return true;
    case PART_LOOP:
        if (!plan->loop[i].used)
            return true;
        column(piece, c->loop[i].name, ".mode", NULL);
        column(piece, c->loop[i].name, ".sp", c->measurement[plan->loop[i].pv].unit);
        return true;
    case PART_OUTPUT:
        if (!c->mv[i].name[0])
            return true;
        column(piece, c->mv[i].name, ".cmd", c->mv[i].unit);
        column(piece, c->mv[i].name, ".app", c->mv[i].unit);
        return true;
    case PART_TAIL:
        text_str(piece, ",stat.tick");
        return true;
    default:
        return false;
    }
}

static bool same_channel(const char *name_a, const char *unit_a, const char *name_b,
                         const char *unit_b)
{
    return strcmp(name_a, name_b) == 0 && strcmp(unit_a, unit_b) == 0;
}

bool telemetry_same_columns(const struct plan *a, const struct plan *b)
{
    const struct config *ca = &a->config, *cb = &b->config;
    bool same = true;
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *ma = &ca->measurement[i], *mb = &cb->measurement[i];
        const struct mv_config *oa = &ca->mv[i], *ob = &cb->mv[i];
        same = same && same_channel(ma->name, ma->unit, mb->name, mb->unit) &&
               same_channel(oa->name, oa->unit, ob->name, ob->unit);
        /* A row only tells whether an offset is subtracted, so the offsets must be equal. */
        same = same && measurement_offset_of(ma) == measurement_offset_of(mb);
        same = same && (sampling_every(ma) > 1) == (sampling_every(mb) > 1);
    }
    for (unsigned i = 0; i < CONFIG_LOOPS; i++)
        same = same && a->loop[i].pv == b->loop[i].pv &&
               strcmp(ca->loop[i].name, cb->loop[i].name) == 0;
    return same && a->has_steps == b->has_steps;
}

static void put_number(struct text *line, float x)
{
    text_char(line, ',');
    text_float9(line, x);
}

static void put_whole(struct text *line, uint32_t x)
{
    text_char(line, ',');
    text_u32(line, x);
}

bool telemetry_row(const struct telemetry_row *row, unsigned n, struct text *piece)
{
    const struct config *c = &row->plan->config;
    unsigned i;
    switch (part_of(n, &i)) {
    case PART_HEAD:
        text_str(piece, "T,");
        text_u32(piece, TELEMETRY_FORMAT);
        put_whole(piece, row->number);
        text_char(piece, ',');
        text_seconds(piece, row->time_ms);
        put_whole(piece, row->state);
        put_whole(piece, row->events);
        if (CONFIG_STEPS && row->plan->has_steps) {
            put_whole(piece, row->sequence);
            put_whole(piece, row->step);
        }
        return true;
    case PART_MEASUREMENT:
        if (!c->measurement[i].name[0])
            return true;
        put_number(piece, row->measurement[i]);
        put_whole(piece, row->quality[i]);
        if (measurement_offset_of(&c->measurement[i]) != 0.0f)
            put_number(piece,
                       row->offsets & 1u << i ? measurement_offset_of(&c->measurement[i]) : 0.0f);
        if (sampling_every(&c->measurement[i]) > 1)
            put_whole(piece, row->fresh >> i & 1u);
        return true;
    case PART_LOOP:
        if (!row->plan->loop[i].used)
            return true;
        put_whole(piece, row->mode[i]);
        put_number(piece, row->setpoint[i]);
        return true;
    case PART_OUTPUT:
        if (!c->mv[i].name[0])
            return true;
        put_number(piece, row->commanded[i]);
        put_number(piece, row->applied[i]);
        return true;
    case PART_TAIL:
        put_whole(piece, row->cycles);
        return true;
    default:
        return false;
    }
}
