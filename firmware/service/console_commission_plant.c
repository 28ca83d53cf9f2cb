/* What automatic start-up begins with (`commission plant`), and what the accepted loops did on trial (`trial`). Listings like
 * those of console_commission_model.c. */
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
