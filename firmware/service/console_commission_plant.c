/* What automatic start-up begins with (`commission plant`), how the plant hangs together (`structure`), and what the
 * accepted loops did on trial (`trial`). Listings like those of console_commission_model.c. */
#include "commission/commission.h"
#include "hal/tick.h"
#include "service/console.h"
#include "service/plant_link.h"

#if COMMISSION_CHANNELS

static void number(struct text *t, const char *name, float x)
{
    text_char(t, ' ');
    text_str(t, name);
    text_char(t, ' ');
    text_float(t, x);
}

static void word(struct text *t, const char *name, const char *value)
{
    text_char(t, ' ');
    text_str(t, name);
    text_char(t, ' ');
    text_str(t, value[0] ? value : "-");
}

static void whole(struct text *t, const char *name, uint32_t x)
{
    text_char(t, ' ');
    text_str(t, name);
    text_char(t, ' ');
    text_u32(t, x);
}

/* As the plant announces them, configured or not. The tick may be told of another plant meanwhile. */
bool commission_plant_line(struct console *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    bool there = true;
    hal_tick_lock();
    unsigned outputs = s->io.count(s->io.context, false);
    unsigned inputs = s->io.count(s->io.context, true);
    if (n == 0 && outputs + inputs == 0) {
        text_str(line, "no plant is connected");
    } else if (n == 0) {
        text_str(line, "plant tick");
        number(line, "s", (float)s->io.tick_ms(s->io.context) / 1000.0f);
        word(line, "name", s->link->name);
    } else if (n <= outputs + inputs) {
        bool manipulated = n > outputs;
        uint8_t i = (uint8_t)(n - 1u - (manipulated ? outputs : 0u));
        struct io_channel channel = s->io.channel(s->io.context, manipulated, i);
        text_str(line, manipulated ? "input " : "output ");
        text_str(line, channel.name);
        word(line, "unit", channel.unit);
        number(line, "lo", channel.lo);
        number(line, "hi", channel.hi);
        if (manipulated)
            number(line, "safe", channel.safe);
    } else {
        there = false;
    }
    hal_tick_unlock();
    return there;
}

static const struct config *settings(const struct console *c)
{
    return &c->service->plan[c->service->in_force].config;
}

/* Names of pair k. */
static void pair(const struct console *c, unsigned k, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct pairs *p = &m->work.analysis.pairs;
    text_char(line, ' ');
    text_str(line, settings(c)->measurement[m->measurement[p->output[k]]].name);
    text_char(line, ' ');
    text_str(line, settings(c)->output[m->input[m->column[p->input[k]]].output].name);
}

static void block_line(const struct structure *s, unsigned b, struct text *line)
{
    text_str(line, "block");
    whole(line, "number", b + 1u);
    whole(line, "part", s->block[b].part + 1u);
    whole(line, "pairs", s->block[b].size);
    number(line, "worst_lambda", (float)s->block[b].worst_lambda);
    text_str(line, " driven_by");
    if (!s->block[b].driven_by)
        text_str(line, " -");
    for (unsigned i = 0; i < s->blocks; i++) {
        if (!(s->block[b].driven_by >> i & 1u))
            continue;
        text_char(line, ' ');
        text_u32(line, i + 1u);
    }
}

static void way_line(const struct console *c, unsigned from, unsigned to, struct text *line)
{
    const struct analysis *a = &c->service->commission->work.analysis;
    struct cross_way way;
    if (from == to || structure_cross_way(&a->plant, &a->pairs, &a->structure, (uint8_t)from,
                                          (uint8_t)to, &way) != ERR_OK)
        return;
    text_str(line, "way from");
    pair(c, from, line);
    text_str(line, " to");
    pair(c, to, line);
    number(line, "gain", (float)way.gain);
    number(line, "lead", (float)way.lead_s);
    number(line, "lag", (float)way.lag_s);
    number(line, "dead", (float)way.dead_s);
    number(line, "late", (float)way.late_s);
}

bool commission_structure_line(struct console *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct analysis *a = &m->work.analysis;
    if (!commission_has_results(m) || !a->has_structure) {
        if (n == 0)
            text_str(line, "structure none: it is looked for once the pairing is determined");
        return n == 0;
    }
    const struct structure *s = &a->structure;
    if (n == 0) {
        text_str(line, "structure");
        whole(line, "parts", s->parts);
        whole(line, "blocks", s->blocks);
        return true;
    }
    n--;
    if (n < s->blocks) {
        block_line(s, n, line);
        return true;
    }
    n -= s->blocks;
    if (n < a->pairs.n) {
        unsigned b = s->pair_block[n];
        text_str(line, "member");
        pair(c, n, line);
        whole(line, "block", b + 1u);
        word(line, "single_loop", s->block[b].mimo >> n & 1u ? "no" : "yes");
        return true;
    }
    n -= a->pairs.n;
    if (n >= (unsigned)a->pairs.n * a->pairs.n)
        return false;
    way_line(c, n / a->pairs.n, n % a->pairs.n, line);
    return true;
}

bool commission_trial_line(struct console *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct adoption *t = &m->adoption;
    bool was = m->phase == COMMISSION_TRIAL || m->phase == COMMISSION_KEPT ||
               m->phase == COMMISSION_RETURNED || m->phase == COMMISSION_ENDED;
    if (!was || t->n == 0 || !commission_has_results(m)) {
        if (n == 0)
            text_str(line, "no trial yet: `commission accept` begins one");
        return n == 0;
    }
    if (n >= t->n)
        return false;
    const struct adoption_loop *l = &t->loop[n];
    const struct measurement_config *y =
        &settings(c)->measurement[m->measurement[m->work.analysis.pairs.output[n]]];
    float span = y->hi - y->lo;
    bool back = l->step < REAL_C(0.0);
    float scale = (float)(back ? -l->step : l->step) / (float)l->size;
    text_str(line, "trial");
    pair(c, n, line);
    number(line, "step", (float)l->step * span);
    number(line, "iae", (float)l->iae * span);
    number(line, "predicted", (float)l->predicted.iae * scale * span);
    number(line, "overshoot", (float)l->peak);
    number(line, "predicted", (float)l->predicted.peak);
    return true;
}

#endif
