#include "commission/blocking.h"

#include "base/assertion.h"
#include "base/elapsed.h"
#include "commission/analysis_job.h"
#include "commission/analysis_structure.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/sequence_runs.h"
#include "commission/status.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "exchange/sampling.h"

#define ROOM_LEAST   REAL_C(0.005) /* of span, least room to either side */
#define FOLLOW_TICKS REAL_C(5.0)   /* time that a valve may take to follow */
#define FAR_OFF      REAL_C(0.1)   /* of span, distance from the command on trial */
#define HELD_TICKS   REAL_C(3.5)   /* longest time without a valid reading */

/* The measurement is lost: one or two invalid readings are held and change little, more do not. */
static bool is_lost(const struct supervisor *s, uint8_t i)
{
    REFLUX_ASSERT(i < CHANNEL_MAX);
    const struct measurement_state *m = &s->measurement[i];
    return !channel_is_valid(s, i) && m->alarm &&
           (m->lost || !quality_usable(m->quality) ||
            elapsed_ms(s->time_ms, m->valid_ms) > HELD_TICKS * REAL_C(1000.0) * s->plan->tick_s);
}

/* Returns the loop that acts on output j, directly or through others, or PLAN_NONE. */
static uint8_t acting(const struct supervisor *s, uint8_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    uint8_t i = s->plan->owner[j];
    return i != PLAN_NONE && s->loop[i].mode != LOOP_MANUAL ? i : PLAN_NONE;
}

/* The measurement is not sampled in every base tick; held values would look like rest, because noise, rest and peaks are
 * judged in every tick. */
static bool comes_rarely(const struct supervisor *s, uint8_t i)
{
    REFLUX_ASSERT(i < CHANNEL_MAX);
    return sampling_every(&s->plan->config.measurement[i]) > 1;
}

static enum err blocked_by(const char **what, const char **wanted, const char *name,
                           const char *text)
{
    *what = name;
    *wanted = text;
    return ERR_STATE;
}

/* Checks what holds for every test. */
static enum err may_test(const struct supervisor *s, const char **what, const char **wanted)
{
    *what = NULL;
    if (sequence_runs(s))
        return blocked_by(what, wanted, NULL, commission_reason_text(REASON_SEQUENCE));
    if (s->state == SUPERVISOR_SAFE)
        return blocked_by(what, wanted, NULL,
                          "the plant is in the safe state; start it by hand first");
    if (supervisor_excited_by(s))
        return blocked_by(what, wanted, supervisor_excited_by(s),
                          commission_reason_text(REASON_EXCITED));
    return ERR_OK;
}

enum err commission_may_begin(const struct supervisor *s, const char **what, const char **wanted)
{
    const struct config *config = &s->plan->config;
    unsigned outputs = 0, inputs = 0;
    enum err err = may_test(s, what, wanted);
    if (err)
        return err;
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        if (!commission_measurement_is_tested(s, i))
            continue;
        outputs++;
        if (comes_rarely(s, i))
            return blocked_by(what, wanted, config->measurement[i].name,
                              "is not sampled in every base tick; set its test to off");
        if (!channel_is_valid(s, i))
            return blocked_by(what, wanted, config->measurement[i].name,
                              "is not valid; wait for good readings, or set its test to off");
        if (channel_is_at_end(s, i))
            return blocked_by(what, wanted, config->measurement[i].name,
                              "reads an end of its span; widen the span, or set its test to off");
    }
    for (uint8_t j = 0; j < CHANNEL_MAX; j++) {
        if (!commission_input_is_tested(s, j))
            continue;
        inputs++;
        uint8_t loop = acting(s, j);
        if (loop != PLAN_NONE)
            return blocked_by(what, wanted, config->loop[loop].name,
                              "is not in manual; `mode NAME manual` first");
        if (s->mv[j].interlocked)
            return blocked_by(what, wanted, config->mv[j].name, "is held by an interlock");
        if (commission_room(s, j, commission_test_base(s, j)) < ROOM_LEAST)
            return blocked_by(what, wanted, config->mv[j].name,
                              "is at its operating limit: no room to step both ways");
    }
    if (outputs == 0)
        return blocked_by(what, wanted, NULL,
                          "no measurement of the plant is configured for tests");
    if (inputs == 0)
        return blocked_by(what, wanted, NULL, "no manipulated variable is configured for tests");
    return ERR_OK;
}

enum err commission_may_relay(const struct supervisor *s, uint8_t loop, const char **what,
                              const char **wanted)
{
    const struct loop_plan *l = &s->plan->loop[loop];
    const struct loop_config *config = &s->plan->config.loop[loop];
    enum err err = may_test(s, what, wanted);
    if (err)
        return err;
    if (l->mv == PLAN_NONE)
        return blocked_by(what, wanted, config->name, "drives a loop; test that one");
    if (plan_kind(s->plan, loop)->positions)
        return blocked_by(what, wanted, config->name, "has two positions and no settings to find");
    if (s->loop[loop].mode != LOOP_MANUAL)
        return blocked_by(what, wanted, config->name, "is not in manual; `mode NAME manual` first");
    if (!s->mv[l->mv].bound)
        return blocked_by(what, wanted, s->plan->config.mv[l->mv].name,
                          "is missing: the plant does not announce it");
    if (s->mv[l->mv].interlocked)
        return blocked_by(what, wanted, s->plan->config.mv[l->mv].name, "is held by an interlock");
    if (comes_rarely(s, l->pv))
        return blocked_by(what, wanted, s->plan->config.measurement[l->pv].name,
                          "is not sampled in every base tick; a relay test needs that");
    if (!channel_is_valid(s, l->pv))
        return blocked_by(what, wanted, s->plan->config.measurement[l->pv].name,
                          "is not valid; wait for good readings");
    if (commission_room(s, l->mv, commission_test_base(s, l->mv)) < ROOM_LEAST)
        return blocked_by(what, wanted, s->plan->config.mv[l->mv].name,
                          "is at its operating limit: no room to step both ways");
    return ERR_OK;
}

static uint8_t pair_measurement(const struct commission *c, uint8_t k)
{
    REFLUX_ASSERT(k < c->work->analysis.pairs.n);
    return outputs_measurement(&c->outputs, c->work->analysis.pairs.output[k]);
}

static uint8_t pair_output(const struct commission *c, uint8_t k)
{
    REFLUX_ASSERT(k < c->work->analysis.pairs.n);
    uint8_t input = analysis_job_input(&c->analysis_job, c->work->analysis.pairs.input[k]);
    return inputs_get(&c->inputs, input)->output;
}

/* The output has not followed its command for longer than a valve needs. */
static bool is_not_following(const struct supervisor *s, uint8_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return s->mv[j].alarm && elapsed_ms(s->time_ms, s->mv[j].differs_ms) >
                                 FOLLOW_TICKS * REAL_C(1000.0) * s->plan->tick_s;
}

/* The output is far from its command. A slow output always lags behind a loop that moves it with every sample; one that does
 * not respond gets far off. */
static bool is_far_off(const struct supervisor *s, uint8_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    const struct mv_state *o = &s->mv[j];
    real_t apart = num_to_float(num_sub(o->constrained, o->readback));
    return real_abs(apart) > FAR_OFF;
}

static bool is_gone(const struct supervisor *s, uint8_t i)
{
    REFLUX_ASSERT(i < CHANNEL_MAX);
    const struct measurement_state *m = &s->measurement[i];
    return !m->seen || m->lost || !quality_usable(m->quality);
}

enum commission_reason blocking_reason(const struct commission *c, const struct supervisor *s,
                                       const char **subject)
{
    const struct config *config = &s->plan->config;
    *subject = NULL;
    if (s->state == SUPERVISOR_SAFE)
        return REASON_SAFE;
    if (sequence_runs(s))
        return REASON_SEQUENCE;
    *subject = supervisor_excited_by(s);
    if (*subject)
        return REASON_EXCITED;
    for (uint8_t k = 0; k < c->work->analysis.pairs.n; k++) {
        uint8_t i = pair_measurement(c, k), j = pair_output(c, k);
        uint8_t inner = analysis_inner_of(&c->work->analysis, k);
        *subject = config->measurement[i].name;
        if (is_gone(s, i))
            return REASON_LOST;
        if (inner != INTERACT_NONE) {
            *subject = outputs_name(&c->outputs, s, inner);
            if (is_gone(s, outputs_measurement(&c->outputs, inner)))
                return REASON_LOST;
        }
        *subject = config->mv[j].name;
        if (s->mv[j].interlocked)
            return REASON_INTERLOCK;
        if (is_not_following(s, j) &&
            (status_phase(&c->status) != COMMISSION_TRIAL || is_far_off(s, j)))
            return REASON_ACTUATOR;
    }
    *subject = NULL;
    return REASON_NOT;
}

enum err commission_may_try(const struct commission *c, const struct supervisor *s,
                            const char **what, const char **wanted)
{
    enum commission_reason reason = blocking_reason(c, s, what);
    *wanted = commission_reason_text(reason);
    return reason == REASON_NOT ? ERR_OK : ERR_STATE;
}

enum commission_reason commission_interruption(const struct commission *c,
                                               const struct supervisor *s)
{
    if (!outputs_plan_in_force(&c->outputs, s))
        return REASON_CONFIG;
    /* The safe state may have been left again within this very tick. */
    return outputs_were_safe(&c->outputs, s) ? REASON_SAFE : REASON_NOT;
}

enum commission_reason commission_disturbance(const struct commission *c,
                                              const struct supervisor *s, const char **subject)
{
    const struct config *config = &s->plan->config;
    enum commission_reason reason = commission_interruption(c, s);
    *subject = NULL;
    if (reason != REASON_NOT)
        return reason;
    if (s->state == SUPERVISOR_SAFE)
        return REASON_SAFE;
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        *subject = outputs_name(&c->outputs, s, j);
        if (is_lost(s, outputs_measurement(&c->outputs, j)))
            return REASON_LOST;
    }
    int end = outputs_at_end(&c->outputs);
    if (end >= 0) {
        *subject = outputs_name(&c->outputs, s, (uint8_t)end);
        return REASON_SPAN;
    }
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        const struct tested_input *in = inputs_get(&c->inputs, k);
        uint8_t j = in->output;
        *subject = config->mv[j].name;
        if (s->mv[j].interlocked)
            return REASON_INTERLOCK;
        if (is_not_following(s, j))
            return REASON_ACTUATOR;
        if (acting(s, j) != PLAN_NONE || num_to_float(s->mv[j].manual) != in->test_base)
            return REASON_HAND;
    }
    *subject = NULL;
    return REASON_NOT;
}
