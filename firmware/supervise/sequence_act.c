/* Does the action of a row of a sequence, as if an operator had asked for it. */
#include "supervise/sequence_act.h"
#include "exchange/span.h"
#include "supervise/loop_request.h"

static bool ask_loop(struct supervisor *s, enum request_kind kind, uint8_t loop,
                     enum loop_mode mode, float value)
{
    struct request r = {.kind = kind,
                        .loop = loop,
                        .output = PLAN_NONE,
                        .mode = (uint8_t)mode,
                        .plan = s->plan->serial,
                        .value = value};
    return loop_request(s, &r);
}

static bool set_mode(struct supervisor *s, uint8_t loop, enum loop_mode mode)
{
    struct sequence *q = &s->sequence;
    if (!ask_loop(s, REQUEST_MODE, loop, mode, 0.0f))
        return false;
    uint16_t bit = (uint16_t)(1u << loop);
    q->working = (uint16_t)(mode == LOOP_MANUAL ? q->working & ~bit : q->working | bit);
    return true;
}

static bool drive(struct supervisor *s, uint8_t output, float value)
{
    uint8_t loop = s->plan->owner[output];
    bool done;
    if (loop != PLAN_NONE) {
        done =
            set_mode(s, loop, LOOP_MANUAL) && ask_loop(s, REQUEST_OUTPUT, loop, LOOP_MANUAL, value);
    } else {
        struct request r = {.kind = REQUEST_OUTPUT,
                            .loop = PLAN_NONE,
                            .output = output,
                            .plan = s->plan->serial,
                            .value = value};
        done = loop_request(s, &r);
    }
    if (done)
        s->sequence.driven = (uint16_t)(s->sequence.driven | 1u << output);
    return done;
}

void measurement_offset(struct supervisor *s, uint8_t i, bool on)
{
    struct measurement_state *m = &s->measurement[i];
    const struct measurement_config *c = &s->plan->config.measurement[i];
    if (m->offset.on == on)
        return;
    m->offset.on = on;
    /* A value that stands in for a reading is no reading, so there is nothing to correct. */
    num_t step = num_from_float((on ? -c->offset.eu : c->offset.eu) / (c->hi - c->lo));
    if (m->seen && !m->alarm) {
        m->value = num_add(m->value, step);
        m->raw += on ? -c->offset.eu : c->offset.eu;
        lag_reset(&m->filter, m->value);
    }
    for (uint8_t k = 0; k < CONFIG_LOOPS; k++)
        if (s->plan->loop[k].used && s->plan->loop[k].pv == i)
            s->loop[k].transfer_pending = true;
    event_put(s->events, s->time_ms, EVENT_OFFSET, c->name, on ? c->offset.eu : 0.0f, 0);
}

static void drop_guards(struct supervisor *s, uint8_t measurement)
{
    for (uint8_t k = 0; k < CONFIG_STEPS; k++)
        if (s->plan->step[k].measurement == measurement)
            s->sequence.guards &= ~(UINT32_C(1) << k);
}

bool sequence_act(struct supervisor *s, uint8_t k)
{
    static const enum loop_mode modes[] = {
        [STEP_MANUAL] = LOOP_MANUAL, [STEP_AUTO] = LOOP_AUTO, [STEP_CASCADE] = LOOP_CASCADE};
    const struct step_config *c = &s->plan->config.step[k];
    uint8_t what = s->plan->step[k].what;
    switch (c->action) {
    case STEP_OUT:
        return drive(s, what, c->value);
    case STEP_MANUAL:
    case STEP_AUTO:
    case STEP_CASCADE:
        return set_mode(s, what, modes[c->action]);
    case STEP_SETPOINT:
        return ask_loop(s, REQUEST_SETPOINT, what, LOOP_AUTO, c->value);
    case STEP_OFFSET_ON:
    case STEP_OFFSET_OFF:
        measurement_offset(s, what, c->action == STEP_OFFSET_ON);
        return true;
    case STEP_GUARD:
        s->sequence.guards |= UINT32_C(1) << k;
        s->sequence.violated_ms[k] = 0;
        return true;
    case STEP_DROP:
        drop_guards(s, what);
        return true;
    default:
        return true;
    }
}
