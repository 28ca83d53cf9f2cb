#include "commission/by_relay.h"

#include "commission/adoption.h"
#include "commission/analysis_single.h"
#include "commission/blocking.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/next_test.h"
#include "commission/requests.h"
#include "commission/start_stop.h"
#include "commission/status.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "commission/tests.h"

#include <string.h>

#define HYSTERESIS       REAL_C(3.0)   /* noise deviations */
#define HYSTERESIS_LEAST REAL_C(0.001) /* of span: residual motion is no response */
#define FIRST            REAL_C(0.02)
#define FIRST_MOST       REAL_C(0.05)
#define WANTED_NOISE     REAL_C(0.5) /* of test.noise: a cycle repeats itself, a step does not */
#define WANTED_SHARE     REAL_C(0.5) /* largest wanted swing of the measurement, share of its limit */
#define WANTED_LEAST     REAL_C(3.0)   /* least wanted swing, in hystereses */
#define PATIENCE         2u            /* windows without a response before the amplitude grows */
#define DRIFT_PATIENCE   3u            /* windows before a faster slope counts as a drift */
#define REST_PATIENCE    20u           /* windows before the test gives up waiting for rest */
#define DRIFT_SHARE      REAL_C(0.3)   /* share of a limit that a drift may use in a window */
#define PAST_NOISE       REAL_C(3.0)   /* standard deviations past the limit */
#define GAIN_MOST        REAL_C(100.0) /* of a loop: loopN.gain */

#define TRIAL_STEP REAL_C(0.05) /* of span */

static const struct test_config *settings(const struct supervisor *s)
{
    return &s->plan->config.test;
}

static uint32_t window(const struct supervisor *s)
{
    uint16_t n = settings(s)->window;
    return n < STEADY_BLOCKS ? STEADY_BLOCKS : n;
}

void commission_start_relay(struct commission *c, struct supervisor *s)
{
    struct relay_test *t = &c->work->relay;
    memset(t, 0, sizeof *t);
    t->resting = true;
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++)
        t->limit[j] =
            commission_limit(&s->plan->config.measurement[outputs_measurement(&c->outputs, j)]);
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        c->by_relay.mode[i] = (uint8_t)supervisor_mode(s, i);
    struct steady_config rest = {.outputs = outputs_count(&c->outputs),
                                 .block = window(s) / STEADY_BLOCKS,
                                 .h_s = s->plan->tick_s,
                                 .noise_floor = NOISE_FLOOR,
                                 .motion_limit = REAL_C(3.0),
                                 .variance_limit = REAL_C(4.0)};
    status_enter(&c->status, COMMISSION_RELAY, s->time_ms);
    outputs_mark_sample(&c->outputs, s);
    enum err err = steady_init(&t->steady, &rest);
    if (err)
        commission_fail(c, s, (real_t)err);
}

void commission_begin_relay(struct commission *c, struct supervisor *s)
{
    const char *what, *wanted;
    uint8_t loop = requests_relay_loop(&c->requests);
    /* In another plan the index may be another loop's. */
    if (s->plan->serial != requests_relay_serial(&c->requests) || loop >= CONFIG_LOOPS ||
        !s->plan->loop[loop].used || commission_may_relay(s, loop, &what, &wanted) != ERR_OK) {
        commission_say(c, s, EVENT_REQUEST_REFUSED, NULL, 0.0f);
        return;
    }
    commission_forget(c, s);
    c->by_relay.latest = true;
    c->by_relay.loop = loop;
    outputs_add(&c->outputs, s->plan->loop[loop].pv);
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (i != s->plan->loop[loop].pv && commission_measurement_is_tested(s, i))
            outputs_add(&c->outputs, i);
    uint8_t mv = s->plan->loop[loop].mv;
    inputs_add(&c->inputs, mv, commission_test_base(s, mv));
    commission_say(c, s, EVENT_COMMISSION_BEGUN, s->plan->config.loop[loop].name, 1.0f);
    commission_start_relay(c, s);
}

static real_t hysteresis(const struct steady_result *at)
{
    real_t h = HYSTERESIS * at->noise_sd;
    return h > HYSTERESIS_LEAST ? h : HYSTERESIS_LEAST;
}

/* All measurements are at rest. A steady slope counts as a drift: at once if it stays within the hysteresis, after some
 * waiting if it is a small part of a limit. */
static bool relay_at_rest(struct commission *c, const struct supervisor *s,
                          struct steady_result *at, uint8_t *culprit)
{
    const struct relay_test *t = &c->work->relay;
    uint32_t n = window(s);
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        *culprit = j;
        if (steady_look(&t->steady, j, &at[j]) != ERR_OK)
            return false;
        if (at[j].state == STEADY_SETTLED)
            continue;
        real_t carried = real_abs(at[j].slope_per_s) * s->plan->tick_s * (real_t)n;
        bool long_since = t->waited > DRIFT_PATIENCE * n;
        if (at[j].state != STEADY_MOVING || t->waited < n + n / 2u ||
            carried > (long_since ? DRIFT_SHARE * t->limit[j] : hysteresis(&at[j])))
            return false;
    }
    return true;
}

static enum err begin_cycle(struct commission *c, const struct supervisor *s,
                            const struct steady_result *at)
{
    struct relay_test *t = &c->work->relay;
    const struct tested_input *in = inputs_under_test(&c->inputs);
    const struct mv_config *o = &s->plan->config.mv[in->output];
    real_t room = commission_room(s, in->output, in->test_base);
    real_t longest_s = settings(s)->longest_s;
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        bool drifts = real_abs(at[j].slope_per_s) > REAL_C(2.0) * at[j].slope_sd_per_s;
        outputs_set_noise(&c->outputs, j, at[j].noise_sd);
        t->slope_per_s[j] = drifts ? at[j].slope_per_s : REAL_C(0.0);
        t->rest[j] = at[j].mean + t->slope_per_s[j] * at[j].age_s;
    }
    struct relay_config x = {
        .h_s = s->plan->tick_s,
        .reference = t->rest[0],
        .sign = s->plan->config.loop[c->by_relay.loop].own.action == LOOP_DIRECT ? -1 : 1,
        .noise_sd = at[0].noise_sd,
        .drift = t->slope_per_s[0] * s->plan->tick_s,
        .hysteresis = hysteresis(&at[0]),
        .amplitude = o->start_up.step / (o->hi - o->lo),
        .most = room, /* half of the span at most, since it is to the nearer limit */
        .wanted = WANTED_NOISE * settings(s)->noise_multiple * at[0].noise_sd,
        .patience = PATIENCE * window(s),
        .half_most = longest_s > 0.0f ? commission_samples(s, longest_s) : COMMISSION_HALF_PLENTY,
    };
    if (x.amplitude > x.most)
        x.amplitude = x.most;
    if (x.wanted < WANTED_LEAST * x.hysteresis)
        x.wanted = WANTED_LEAST * x.hysteresis;
    x.first = x.wanted > FIRST_MOST ? FIRST_MOST : x.wanted < FIRST ? FIRST : x.wanted;
    if (x.first > REAL_C(0.5) * x.most)
        x.first = REAL_C(0.5) * x.most;
    if (x.wanted > WANTED_SHARE * t->limit[0])
        x.wanted = WANTED_SHARE * t->limit[0];
    if (x.half_most <= x.patience)
        x.half_most = x.patience + 1u;
    t->resting = false;
    return relay_begin(&t->relay, &x);
}

/* Gives the largest share of its limit that a measurement has used. False: one has been past its limit for two samples,
 * noise apart. */
static bool relay_within_limits(struct commission *c, const struct supervisor *s, const real_t *y,
                                real_t *share, uint8_t *culprit)
{
    struct relay_test *t = &c->work->relay;
    *share = REAL_C(0.0);
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        real_t carried = t->slope_per_s[j] * s->plan->tick_s * (real_t)t->cycling;
        real_t away = real_abs(steady_away(y[j] - t->rest[j], carried, t->limit[j]));
        if (away > *share * t->limit[j])
            *share = away / t->limit[j];
        bool over = away > t->limit[j] + PAST_NOISE * outputs_noise(&c->outputs)[j];
        t->over[j] = over ? (uint8_t)(t->over[j] + 1u) : 0;
        if (t->over[j] >= 2) {
            *culprit = j;
            return false;
        }
    }
    return true;
}

/* The proposal takes the place of the analysis of a whole plant; the relay is in the same memory. */
static void propose(struct commission *c, const struct supervisor *s,
                    const struct relay_result *found, const struct tuning *tuning)
{
    real_t step = TRIAL_STEP, settled_s = BY_RELAY_SETTLES * found->period_s;
    struct trial_loop predicted = {.iae = BY_RELAY_IAE * found->period_s * step,
                                   .peak = BY_RELAY_PEAK,
                                   .settled_s = settled_s,
                                   .moved = BY_RELAY_MOVES * real_abs(found->gain) * step};
    analysis_single_loop(&c->work->analysis, tuning, step, &predicted,
                         ADOPTION_DURATION * settled_s);
    inputs_set_half_least(&c->inputs, commission_samples(s, settled_s));
}

static void done(struct commission *c, struct supervisor *s)
{
    const char *name = s->plan->config.loop[c->by_relay.loop].name;
    struct relay_result found;
    struct tuning tuning;
    if (relay_look(&c->work->relay.relay, &found) != ERR_OK ||
        tuning_tyreus_luyben_pi(found.gain, found.period_s, &tuning, NULL) != ERR_OK) {
        commission_end(c, s, REASON_NO_CYCLE, name, inputs_under_test(&c->inputs)->worst);
        return;
    }
    if (tuning.gain > GAIN_MOST) { /* and the integral action goes with it */
        tuning.ti_s *= tuning.gain / GAIN_MOST;
        tuning.gain = GAIN_MOST;
    }
    inputs_set_amplitude(&c->inputs, found.amplitude);
    c->by_relay.finding =
        (struct relay_finding){.result = found,
                               .gain = tuning.action == TUNING_DIRECT ? -tuning.gain : tuning.gain,
                               .ti_s = tuning.ti_s,
                               .found = true};
    propose(c, s, &found, &tuning);
    status_ready(&c->status, s->time_ms);
    commission_say(c, s, EVENT_RELAY_DONE, name, (float)found.period_s);
}

static enum commission_reason reason_of(enum relay_failure failure)
{
    return failure == RELAY_NO_ANSWER    ? REASON_NO_ANSWER
           : failure == RELAY_WRONG_SIGN ? REASON_ACTION
                                         : REASON_NO_CYCLE;
}

static void cycle(struct commission *c, struct supervisor *s, const real_t *y)
{
    struct relay_test *t = &c->work->relay;
    struct relay *r = &t->relay;
    const char *loop = s->plan->config.loop[c->by_relay.loop].name;
    uint8_t culprit;
    real_t share, before = r->amplitude;
    uint32_t gone = outputs_see_sample(&c->outputs, s);
    if (gone > MISSED_MOST + 1u) {
        commission_end(c, s, REASON_SAMPLES, NULL, (real_t)(gone - 1u));
        return;
    }
    t->cycling += gone > 0 ? gone : 1u;
    bool inside = relay_within_limits(c, s, y, &share, &culprit);
    inputs_raise_worst(&c->inputs, share);
    if (!inside) {
        commission_end_by_output(c, s, REASON_LIMIT, culprit, share);
        return;
    }
    enum err err = ERR_OK;
    for (; gone > 1 && !err && r->started > 0; gone--)
        err = relay_missed(r);
    if (!err)
        err = relay_step(r, y[0], share);
    if (err) {
        commission_end(c, s, REASON_NUMBERS, loop, (real_t)err);
        return;
    }
    supervisor_excite(s, inputs_under_test(&c->inputs)->output, num_from_float(r->level));
    if (r->phase == RELAY_START && (r->started == 1 || r->amplitude > before))
        commission_say_of_input(c, s, EVENT_TEST_STEP, r->amplitude, 1);
    if (r->phase == RELAY_FAILED)
        commission_end(c, s, reason_of(r->failure), loop, inputs_under_test(&c->inputs)->worst);
    else if (r->phase == RELAY_DONE)
        done(c, s);
}

/* Returns a loop whose mode has changed since the test began, by hand or by a fallback. */
static uint8_t changed_loop(const struct commission *c, const struct supervisor *s)
{
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        if (s->plan->loop[i].used && s->loop[i].mode != c->by_relay.mode[i])
            return i;
    return PLAN_NONE;
}

void commission_relay(struct commission *c, struct supervisor *s)
{
    struct relay_test *t = &c->work->relay;
    struct steady_result at[CHANNEL_MAX] = {{0}};
    real_t y[CHANNEL_MAX] = {REAL_C(0.0)};
    uint8_t culprit, other = changed_loop(c, s);
    if (other != PLAN_NONE) {
        commission_end(c, s, REASON_HAND, s->plan->config.loop[other].name, REAL_C(0.0));
        return;
    }
    outputs_read(&c->outputs, s, y);
    if (!t->resting) {
        cycle(c, s, y);
        return;
    }
    outputs_mark_sample(&c->outputs, s);
    enum err err = steady_step(&t->steady, y);
    t->waited++;
    if (!err && relay_at_rest(c, s, at, &culprit)) {
        err = begin_cycle(c, s, at);
        if (!err)
            cycle(c, s, y);
    } else if (!err && t->waited > REST_PATIENCE * window(s) + COMMISSION_HALF_PLENTY) {
        commission_end_by_output(c, s, REASON_RESTLESS, culprit, REAL_C(0.0));
        return;
    }
    if (err)
        commission_fail(c, s, (real_t)err);
}

void by_relay_write(const struct by_relay *r, struct loop_config *l)
{
    l->own.gain = (float)real_abs(r->finding.gain);
    l->own.ti_s = (float)r->finding.ti_s;
    l->own.td_s = 0.0f;
    l->own.action = r->finding.gain < REAL_C(0.0) ? LOOP_DIRECT : LOOP_REVERSE;
}

struct relay_progress relay_test_progress(const struct relay_test *t)
{
    return (struct relay_progress){.resting = t->resting,
                                   .phase = t->relay.phase,
                                   .periods = t->relay.periods,
                                   .amplitude = t->relay.amplitude};
}
