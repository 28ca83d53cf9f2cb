/* `commission relay`: settings for one loop by a relay test, and what it has found. */
#include <string.h>

#include "commission/commission.h"
#include "console/commission_listings.h"
#include "console/phrases.h"
#include "hal/tick.h"

/* The latest test; the tick may begin another at any time. */
static struct relay_finding latest(const struct client *c)
{
    hal_tick_lock();
    struct relay_finding r = *by_relay_finding(&c->service->commission->by_relay);
    hal_tick_unlock();
    return r;
}

void relay_progress_line(struct client *c, struct text *line)
{
    const struct commission *m = c->service->commission;
    hal_tick_lock();
    bool going_on = status_phase(&m->status) == COMMISSION_RELAY;
    uint8_t loop = by_relay_loop(&m->by_relay);
    struct relay_progress r = relay_test_progress(&m->work->relay);
    hal_tick_unlock();
    if (!going_on)
        return;
    text_str(line, "loop ");
    text_str(line, client_settings(c)->loop[loop].name);
    if (r.resting) {
        text_str(line, " waits for rest");
    } else if (r.phase == RELAY_START) {
        text_named_float(line, "waits for an answer to", (float)r.amplitude);
        text_str(line, " of the input's span");
    } else {
        text_named_float(line, "cycles, period", (float)(r.periods + 1u));
        text_named_float(line, "amplitude", (float)r.amplitude);
        text_str(line, " of the input's span");
    }
}

static void found_line(const struct client *c, const struct relay_finding *r, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct measurement_config *y =
        &client_settings(c)->measurement[outputs_measurement(&m->outputs, 0)];
    const struct mv_config *u = &client_settings(c)->mv[inputs_get(&m->inputs, 0)->output];
    const struct relay_result *x = &r->result;
    text_str(line, "relay ");
    text_str(line, y->name);
    put_word(line, u->name);
    text_named_float(line, "ultimate", (float)x->gain);
    text_named_float(line, "described", (float)x->described);
    text_named_float(line, "period", (float)x->period_s);
    text_named_float(line, "s amplitude", (float)x->amplitude * (u->hi - u->lo));
    text_named_float(line, "bias", (float)x->bias * (u->hi - u->lo));
    text_named_float(line, "peak", (float)x->peak * (y->hi - y->lo));
    text_named_float(line, "spread", (float)x->spread);
    text_str(line, " periods ");
    text_u32(line, x->periods);
    text_named_float(line, "worst", (float)inputs_get(&m->inputs, 0)->worst);
}

bool commission_relay_line(struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    struct relay_finding r = latest(c);
    if (!r.found || !commission_had_results(m)) {
        if (n == 0 && status_phase(&m->status) == COMMISSION_RELAY)
            relay_progress_line(c, line);
        else if (n == 0)
            text_str(line, "no relay test has been done: `commission relay LOOP`");
        return n == 0;
    }
    if (n == 0) {
        operate_startup_shown(&c->session);
        found_line(c, &r, line);
        return true;
    }
    if (n > 1)
        return false;
    text_str(line, "settings Tyreus-Luyben");
    text_named_float(line, "gain", (float)(r.gain < REAL_C(0.0) ? -r.gain : r.gain));
    text_named_float(line, "ti", (float)r.ti_s);
    text_str(line, r.gain < REAL_C(0.0) ? " s direct" : " s reverse");
    return true;
}

void commission_relay_command(struct client *c, unsigned n, char **word)
{
    struct answer a;
    if (n == 1) {
        reply_list(c, commission_relay_line, "");
        return;
    }
    uint8_t loop = config_find_loop(operate_settings(&c->session), word[1]);
    enum err err = operate_relay(&c->session, loop, &a);
    if (err == ERR_UNKNOWN)
        a.subject = word[1];
    reply_answer(c, err, &a);
}
