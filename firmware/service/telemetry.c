#include "service/telemetry.h"

#include <string.h>

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
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &c->measurement[i];
        row->measurement[i] = span_to_eu(s->measurement[i].value, m->lo, m->hi);
        row->quality[i] = (uint8_t)s->measurement[i].quality;
        const struct output_config *o = &c->output[i];
        row->commanded[i] = span_to_eu(s->output[i].commanded, o->lo, o->hi);
        row->applied[i] = span_to_eu(s->output[i].applied, o->lo, o->hi);
    }
    for (unsigned i = 0; i < CONFIG_LOOPS; i++) {
        row->mode[i] = (uint8_t)s->loop[i].mode;
        if (!s->plan->loop[i].used)
            continue;
        const struct measurement_config *m = &c->measurement[s->plan->loop[i].pv];
        row->setpoint[i] = span_to_eu(s->loop[i].setpoint, m->lo, m->hi);
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

void telemetry_header(const struct plan *plan, struct text *line)
{
    const struct config *c = &plan->config;
    text_str(line, "H,");
    text_u32(line, TELEMETRY_FORMAT);
    text_str(line, ",number,time[s],state,ev");
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        if (!c->measurement[i].name[0])
            continue;
        column(line, c->measurement[i].name, "", c->measurement[i].unit);
        column(line, c->measurement[i].name, ".q", NULL);
    }
    for (unsigned i = 0; i < CONFIG_LOOPS; i++) {
        if (!plan->loop[i].used)
            continue;
        column(line, c->loop[i].name, ".mode", NULL);
        column(line, c->loop[i].name, ".sp", c->measurement[plan->loop[i].pv].unit);
    }
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        if (!c->output[i].name[0])
            continue;
        column(line, c->output[i].name, ".cmd", c->output[i].unit);
        column(line, c->output[i].name, ".app", c->output[i].unit);
    }
    text_str(line, ",stat.tick");
}

static void number(struct text *line, float x)
{
    text_char(line, ',');
    text_float9(line, x);
}

static void whole(struct text *line, uint32_t x)
{
    text_char(line, ',');
    text_u32(line, x);
}

void telemetry_row(const struct telemetry_row *row, struct text *line)
{
    const struct config *c = &row->plan->config;
    text_str(line, "T,");
    text_u32(line, TELEMETRY_FORMAT);
    whole(line, row->number);
    text_char(line, ',');
    text_seconds(line, row->time_ms);
    whole(line, row->state);
    whole(line, row->events);
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        if (!c->measurement[i].name[0])
            continue;
        number(line, row->measurement[i]);
        whole(line, row->quality[i]);
    }
    for (unsigned i = 0; i < CONFIG_LOOPS; i++) {
        if (!row->plan->loop[i].used)
            continue;
        whole(line, row->mode[i]);
        number(line, row->setpoint[i]);
    }
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        if (!c->output[i].name[0])
            continue;
        number(line, row->commanded[i]);
        number(line, row->applied[i]);
    }
    whole(line, row->cycles);
}
