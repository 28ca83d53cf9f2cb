#include "commission/start_stop.h"

#include "commission/background.h"
#include "commission/commission_state.h"
#include "commission/direction.h"
#include "commission/lease.h"
#include "commission/status.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"

#include <stddef.h>
#include <string.h>

/* The large parts stay as they are, because this is a tick; whoever uses them next clears them. */
void commission_forget(struct commission *c, const struct supervisor *s)
{
    background_give_up(&c->background);
    status_begin(&c->status, s->time_ms);
    lease_begin(&c->lease);
    memset((char *)c + offsetof(struct commission, requests), 0,
           sizeof *c - offsetof(struct commission, requests));
    outputs_begin(&c->outputs, s);
    inputs_begin(&c->inputs);
    memset(c->work->element, 0, sizeof c->work->element);
    memset(c->work->sensor, 0, sizeof c->work->sensor);
}

void commission_release(struct commission *c, struct supervisor *s)
{
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++)
        supervisor_excite(s, inputs_get(&c->inputs, k)->output, num_zero());
}

void commission_end(struct commission *c, struct supervisor *s, enum commission_reason reason,
                    const char *subject, real_t value)
{
    enum commission_phase phase = status_phase(&c->status);
    bool in_trial = phase == COMMISSION_TRIAL || phase == COMMISSION_WATCHING;
    commission_release(c, s);
    /* Outputs go back to where they were held, because an interlock or the operator may have moved them; unless somebody
     * else decides now. */
    bool others =
        in_trial || reason == REASON_HAND || reason == REASON_CONFIG || reason == REASON_SAFE;
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        const struct tested_input *in = inputs_get(&c->inputs, k);
        if (!others)
            s->mv[in->output].manual = num_from_float(in->test_base);
        if (!in_trial && in->rounds > 0) /* a part of the model */
            status_set_unseen(&c->status, true);
    }
    background_give_up(&c->background);
    status_end(&c->status, reason, subject, value, s->time_ms);
}

void commission_end_by_output(struct commission *c, struct supervisor *s,
                              enum commission_reason reason, uint8_t j, real_t value)
{
    commission_end(c, s, reason, outputs_name(&c->outputs, s, j), value);
}

static void put_event(const struct commission *c, const struct supervisor *s, enum event_code code,
                      const char *subject, float value, uint8_t detail)
{
    event_put(status_events(&c->status), s->time_ms, code, subject, value, detail);
}

void commission_say(const struct commission *c, const struct supervisor *s, enum event_code code,
                    const char *subject, float value)
{
    put_event(c, s, code, subject, value, 0);
}

void commission_say_of_all(const struct commission *c, const struct supervisor *s,
                           enum event_code code, float value, uint8_t detail)
{
    put_event(c, s, code, NULL, value, detail);
}

void commission_say_of_output(const struct commission *c, const struct supervisor *s,
                              enum event_code code, uint8_t j, float value, uint8_t detail)
{
    put_event(c, s, code, outputs_name(&c->outputs, s, j), value, detail);
}

/* Name of the input whose turn it is, or of the direction. */
static const char *present_input_name(const struct commission *c, const struct supervisor *s)
{
    return inputs_is_direction(&c->inputs)
               ? DIRECTION_NAME
               : s->plan->config.mv[inputs_under_test(&c->inputs)->output].name;
}

void commission_fail(struct commission *c, struct supervisor *s, real_t value)
{
    commission_end(c, s, REASON_NUMBERS, present_input_name(c, s), value);
}

void commission_say_of_input(const struct commission *c, const struct supervisor *s,
                             enum event_code code, float value, uint8_t detail)
{
    put_event(c, s, code, present_input_name(c, s), value, detail);
}
