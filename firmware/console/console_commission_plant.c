/* `commission plant` and `plan`: what automatic start-up begins with. `commission trial`: what the accepted loops did on trial. The
 * listings are like those of console_commission_model.c. */
#include "commission/commission.h"
#include "commission/expected.h"
#include "console/commission_listings.h"
#include "console/commission_words.h"
#include "console/phrases.h"
#include "hal/tick.h"
#include "io/plant_link.h"

/* With channels at the board's pins and at the link: that of the link, as long as there is one. */
static const char *plant_name(const struct service *s)
{
    const struct pins_config *pins = &service_in_force(s)->config.pins;
    bool link = pins_leave_link(pins) && (s->link->state == IO_READY || !pins_are_source(pins));
    return link ? s->link->name : "board's pins";
}

/* Lists the channels that the plant announces, configured or not. Another plant may announce itself to the tick meanwhile. */
bool commission_plant_line(struct client *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    bool more = true;
    hal_tick_lock();
    unsigned outputs = s->io.count(s->io.context, false);
    unsigned inputs = s->io.count(s->io.context, true);
    if (n == 0 && outputs + inputs == 0) {
        text_str(line, NO_PLANT);
    } else if (n == 0) {
        text_str(line, "plant tick");
        text_named_float(line, "s", (float)s->io.tick_ms(s->io.context) / 1000.0f);
        text_named_str(line, "name", plant_name(s));
    } else if (n <= outputs + inputs) {
        bool manipulated = n > outputs;
        uint8_t i = (uint8_t)(n - 1u - (manipulated ? outputs : 0u));
        struct io_channel channel = s->io.channel(s->io.context, manipulated, i);
        text_str(line, manipulated ? "output " : "measurement ");
        text_str(line, channel.name);
        text_named_str(line, "unit", channel.unit);
        text_named_float(line, "lo", channel.lo);
        text_named_float(line, "hi", channel.hi);
        if (manipulated)
            text_named_float(line, "safe", channel.safe);
    } else {
        more = false;
    }
    hal_tick_unlock();
    return more;
}

/* Lists what `commission begin` would move, by how much and for about how long, with the settings in force. */
bool commission_plan_line(struct client *c, unsigned n, struct text *line)
{
    const struct supervisor *s = c->service->supervisor;
    const struct config *config = client_settings(c);
    if (n == 0) {
        hal_tick_lock();
        struct expected all = expected_of(s);
        hal_tick_unlock();
        text_str(line, "plan");
        text_named_u32(line, "inputs", all.inputs);
        text_named_u32(line, "outputs", all.outputs);
        text_named_u32(line, "rounds", config->test.rounds);
        text_named_float(line, "hours at least", (float)(all.least_s / REAL_C(3600.0)));
        text_named_float(line, "at most", (float)(all.most_s / REAL_C(3600.0)));
        return true;
    }
    n--;
    if (n < CHANNEL_MAX) {
        hal_tick_lock();
        struct expected_input e = expected_of_input(s, (uint8_t)n);
        hal_tick_unlock();
        const struct mv_config *o = &config->mv[n];
        float span = o->hi - o->lo;
        if (!e.tested)
            return true;
        text_str(line, "input ");
        text_str(line, o->name);
        text_named_float(line, "held", o->lo + (float)e.test_base * span);
        text_named_float(line, "step", (float)e.first * span);
        text_named_float(line, "at most", (float)e.most * span);
        text_char(line, ' ');
        commission_unit(line, o->unit);
        return true;
    }
    n -= CHANNEL_MAX;
    if (n >= CHANNEL_MAX)
        return false;
    const struct measurement_config *m = &config->measurement[n];
    if (!m->name[0] || !m->start_up.test || !s->measurement[n].bound)
        return true;
    text_str(line, "output ");
    text_str(line, m->name);
    float limit =
        m->start_up.limit > 0.0f ? m->start_up.limit : (float)TEST_LIMIT_DEFAULT * (m->hi - m->lo);
    text_named_float(line, "limit", m->start_up.critical ? 0.5f * limit : limit);
    text_char(line, ' ');
    commission_unit(line, m->unit);
    return true;
}

bool commission_trial_line(struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct config *config = client_settings(c);
    unsigned loops = adoption_loops(&m->adoption);
    enum commission_phase phase = status_phase(&m->status);
    bool was = phase == COMMISSION_TRIAL || phase == COMMISSION_KEPT ||
               phase == COMMISSION_RETURNED || phase == COMMISSION_ENDED;
    if (!was || loops == 0 || !commission_had_results(m)) {
        if (n == 0)
            text_str(line, "no trial yet: `commission accept` begins one");
        return n == 0;
    }
    if (n >= loops)
        return false;
    const struct adoption_loop *l = adoption_loop(&m->adoption, n);
    uint8_t measurement = adoption_channel(&m->adoption, n)->measurement;
    const struct measurement_config *y = &config->measurement[measurement];
    float span = y->hi - y->lo;
    bool back = l->step < REAL_C(0.0);
    float scale = (float)(back ? -l->step : l->step) / (float)l->size;
    text_str(line, "trial ");
    text_str(line, y->name);
    put_word(line, config->mv[l->output].name);
    text_named_float(line, "step", (float)l->step * span);
    text_named_float(line, "iae", (float)l->iae * span);
    text_named_float(line, "predicted", (float)l->predicted.iae * scale * span);
    text_named_float(line, "overshoot", (float)l->peak);
    text_named_float(line, "predicted", (float)l->predicted.peak);
    return true;
}
