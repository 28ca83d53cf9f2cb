#include "supervise/config.h"
#if COMMISSION_CHANNELS

#include "commission/commission.h"

#include <stdatomic.h>
#include <string.h>

#include "base/crc32.h"
#include "base/elapsed.h"

#include "commission/model.h"

#define NOISE_FLOOR     REAL_C(7e-5) /* of span: what 12 bits of conversion leave */
#define AMPLITUDE_MOST  REAL_C(0.25) /* of span, while it is being found */
#define AMPLITUDE_FIRST REAL_C(0.02)
#define ROOM_LEAST      REAL_C(0.005) /* of span, to either side of where it is held */
#define FOLLOW_TICKS    REAL_C(5.0)   /* a valve on its way to a step is no fault */
#define CLIMBS          REAL_C(0.7) /* second half of a level over the first: 1 for an integrator */
#define HELD_TICKS      REAL_C(3.5)   /* without a believed reading */
#define MISSED_MOST     8u            /* samples in a row that a test can do without */
#define LONGER          3u /* times the half before, where an output did not come to rest */
#define LONGER_MOST     3u
#define HALF_MOST       1000u       /* samples */
#define SHARE_LEAST     REAL_C(0.5) /* no half is shorter than this share of the longest before */

static const char *const why_texts[WHY_COUNT] = {
    [WHY_NOT] = "",
    [WHY_ASKED] = "asked for",
    [WHY_SAFE] = "safe state",
    [WHY_LOST] = "measurement is not believed",
    [WHY_INTERLOCK] = "an interlock holds the output",
    [WHY_ACTUATOR] = "the output does not follow its command",
    [WHY_HAND] = "moved by somebody else",
    [WHY_CONFIG] = "another configuration was applied",
    [WHY_RESTLESS] = "does not come to rest before the test",
    [WHY_LIMIT] = "went past its test limit",
    [WHY_AWAY] = "does not come back after the test: unstable or integrating",
    [WHY_INTEGRATES] = "integrates: only plants that come to rest by themselves can be tested",
    [WHY_NO_INPUT] = "every input was skipped",
    [WHY_NUMBERS] = "the analysis refused the model",
    [WHY_SAMPLES] = "samples were missing",
    [WHY_RESET] = "the board was reset",
    [WHY_TRIAL_LIMIT] = "went past its test limit on trial",
    [WHY_TRIAL_SLOW] = "took far longer than predicted on trial",
    [WHY_TRIAL_PEAK] = "overshot far more than predicted on trial",
    [WHY_TRIAL_REST] = "did not come to rest on trial",
    [WHY_SEQUENCE] = "a sequence is under way; `seq` shows it",
};

const char *commission_why_text(enum commission_why why)
{
    return why < WHY_COUNT ? why_texts[why] : "";
}

void commission_init(struct commission *c, struct event_queue *events)
{
    memset(c, 0, sizeof *c);
    c->events = events;
}

void commission_was_reset(struct commission *c)
{
    c->phase = COMMISSION_ENDED;
    c->why = WHY_RESET;
    event_put(c->events, 0, EVENT_COMMISSION_ENDED, NULL, 0.0f, WHY_RESET);
}

static bool is_testing(const struct commission *c)
{
    return c->phase == COMMISSION_TESTING || c->phase == COMMISSION_FITTING ||
           c->phase == COMMISSION_ANALYSING || c->phase == COMMISSION_PAUSED;
}

bool commission_has_proposal(const struct commission *c)
{
    return c->phase == COMMISSION_READY && c->work.analysis.designed;
}

enum err commission_may(const struct commission *c, enum commission_ask ask, const char **wanted)
{
    bool possible;
    switch (ask) {
    case COMMISSION_ASK_BEGIN:
        *wanted = c->wants_old
                      ? "the old settings are on their way back; an open transaction holds "
                        "them up: apply or abandon it"
                      : "is under way already; `commission abort` first";
        possible = !is_testing(c) && c->phase != COMMISSION_TRIAL && !c->wants_old;
        break;
    case COMMISSION_ASK_PAUSE:
    case COMMISSION_ASK_SKIP:
        *wanted = "only while an input is tested";
        possible = c->phase == COMMISSION_TESTING;
        break;
    case COMMISSION_ASK_RESUME:
        *wanted = "only after `commission pause`";
        possible = c->phase == COMMISSION_PAUSED;
        break;
    case COMMISSION_ASK_REPEAT:
        *wanted = "only while a later input is tested";
        possible = c->phase == COMMISSION_TESTING && c->at > 0;
        break;
    case COMMISSION_ASK_ABORT:
        *wanted = "nothing is under way";
        possible = is_testing(c) || c->phase == COMMISSION_TRIAL;
        break;
    case COMMISSION_ASK_TRIAL:
        *wanted = "there is no proposal; `commission` says how far it is";
        possible = commission_has_proposal(c) && !c->wants_old;
        break;
    default:
        *wanted = "there is nothing to reject";
        possible = c->phase == COMMISSION_READY;
        break;
    }
    return possible ? ERR_OK : ERR_STATE;
}

enum err commission_put(struct commission *c, enum commission_ask ask, const char **wanted)
{
    enum commission_ask before = (enum commission_ask)c->ask;
    if (before != COMMISSION_ASK_NONE && ask != COMMISSION_ASK_ABORT) {
        *wanted = "what was asked before waits for the next sample";
        return ERR_BUSY;
    }
    if (before == COMMISSION_ASK_BEGIN || before == COMMISSION_ASK_TRIAL) {
        c->ask = COMMISSION_ASK_NONE; /* not begun, so there is nothing to end */
        c->wants_old = before == COMMISSION_ASK_TRIAL;
        return ERR_OK;
    }
    enum err err = commission_may(c, ask, wanted);
    if (!err)
        c->ask = (uint8_t)ask;
    return err;
}

/* Only a new beginning overwrites them, and only the main loop asks for one. */
bool commission_has_results(const struct commission *c)
{
    return c->analysed && c->ask != COMMISSION_ASK_BEGIN;
}

/* ---- channels ---- */

static real_t held_at(const struct supervisor *s, uint8_t j)
{
    return num_to_float(s->output[j].manual);
}

uint32_t commission_channels(const struct config *config)
{
    uint32_t sum = 0;
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &config->measurement[i];
        const struct output_config *o = &config->output[i];
        float span[] = {m->lo, m->hi, o->lo, o->hi};
        sum = crc32_update(sum, m->name, sizeof m->name);
        sum = crc32_update(sum, o->name, sizeof o->name);
        sum = crc32_update(sum, span, sizeof span);
    }
    return sum;
}

/* Smaller of the ways to both operating limits, fraction of span. */
static real_t room(const struct supervisor *s, uint8_t j, real_t held)
{
    const struct output_config *o = &s->plan->config.output[j];
    real_t lo = (o->min - o->lo) / (o->hi - o->lo), hi = (o->max - o->lo) / (o->hi - o->lo);
    return held - lo < hi - held ? held - lo : hi - held;
}

static bool input_is_tested(const struct supervisor *s, uint8_t j)
{
    const struct output_config *o = &s->plan->config.output[j];
    return o->name[0] && o->test && s->output[j].bound;
}

static bool measurement_is_tested(const struct supervisor *s, uint8_t i)
{
    const struct measurement_config *m = &s->plan->config.measurement[i];
    return m->name[0] && m->test && s->measurement[i].bound;
}

static bool believed(const struct supervisor *s, uint8_t i)
{
    return s->measurement[i].seen && s->measurement[i].quality == QUALITY_GOOD;
}

/* A reading or two that are not believed are held, and change little; more are a lost measurement. */
static bool is_lost(const struct supervisor *s, uint8_t i)
{
    const struct measurement_state *m = &s->measurement[i];
    return !believed(s, i) && m->alarm &&
           (m->lost || !quality_usable(m->quality) ||
            elapsed_ms(s->time_ms, m->good_ms) > HELD_TICKS * REAL_C(1000.0) * s->plan->tick_s);
}

/* The loop that acts on output j, itself or through others, or PLAN_NONE. */
static uint8_t acting(const struct supervisor *s, uint8_t j)
{
    uint8_t i = s->plan->owner[j];
    return i != PLAN_NONE && s->loop[i].mode != LOOP_MANUAL ? i : PLAN_NONE;
}

static enum err refuse(const char **what, const char **wanted, const char *name, const char *text)
{
    *what = name;
    *wanted = text;
    return ERR_STATE;
}

static bool sequence_runs(const struct supervisor *s)
{
#if CONFIG_STEPS
    return sequence_active(&s->sequence);
#else
    (void)s;
    return false;
#endif
}

enum err commission_may_begin(const struct supervisor *s, const char **what, const char **wanted)
{
    const struct config *config = &s->plan->config;
    unsigned outputs = 0, inputs = 0;
    *what = NULL;
    if (sequence_runs(s))
        return refuse(what, wanted, NULL, why_texts[WHY_SEQUENCE]);
    if (s->state == SUPERVISOR_SAFE)
        return refuse(
            what, wanted, NULL,
            "the plant is in the safe state; bring it to its operating point by hand first");
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        if (!measurement_is_tested(s, i))
            continue;
        outputs++;
        if (!believed(s, i))
            return refuse(what, wanted, config->measurement[i].name,
                          "is not believed; wait for good readings, or set its test to off");
    }
    for (uint8_t j = 0; j < CHANNEL_MAX; j++) {
        if (!input_is_tested(s, j))
            continue;
        inputs++;
        uint8_t loop = acting(s, j);
        if (loop != PLAN_NONE)
            return refuse(what, wanted, config->loop[loop].name, "acts; `mode NAME manual` first");
        if (s->output[j].forced)
            return refuse(what, wanted, config->output[j].name, "is held by an interlock");
        if (room(s, j, held_at(s, j)) < ROOM_LEAST)
            return refuse(what, wanted, config->output[j].name,
                          "stands at its operating limit: no room to step both ways");
    }
    if (outputs == 0)
        return refuse(what, wanted, NULL, "no measurement of the plant is configured for tests");
    if (inputs == 0)
        return refuse(what, wanted, NULL, "no manipulated variable is configured for tests");
    return ERR_OK;
}

static uint8_t pair_measurement(const struct commission *c, uint8_t k)
{
    return c->measurement[c->work.analysis.pairs.output[k]];
}

static uint8_t pair_output(const struct commission *c, uint8_t k)
{
    return c->input[c->column[c->work.analysis.pairs.input[k]]].output;
}

/* The command has not been followed for longer than a valve needs. */
static bool is_deaf(const struct supervisor *s, uint8_t j)
{
    return s->output[j].alarm && elapsed_ms(s->time_ms, s->output[j].differs_ms) >
                                     FOLLOW_TICKS * REAL_C(1000.0) * s->plan->tick_s;
}

/* What stands in the way of a trial, whether it has begun or not. */
static enum commission_why hindrance(const struct commission *c, const struct supervisor *s,
                                     const char **subject)
{
    const struct config *config = &s->plan->config;
    *subject = NULL;
    if (s->state == SUPERVISOR_SAFE)
        return WHY_SAFE;
    if (sequence_runs(s))
        return WHY_SEQUENCE;
    for (uint8_t k = 0; k < c->work.analysis.pairs.n; k++) {
        uint8_t i = pair_measurement(c, k), j = pair_output(c, k);
        *subject = config->measurement[i].name;
        if (!s->measurement[i].seen || s->measurement[i].lost ||
            !quality_usable(s->measurement[i].quality))
            return WHY_LOST;
        *subject = config->output[j].name;
        if (s->output[j].forced)
            return WHY_INTERLOCK;
        if (is_deaf(s, j))
            return WHY_ACTUATOR;
    }
    *subject = NULL;
    return WHY_NOT;
}

enum err commission_may_try(const struct commission *c, const struct supervisor *s,
                            const char **what, const char **wanted)
{
    enum commission_why why = hindrance(c, s, what);
    *wanted = commission_why_text(why);
    return why == WHY_NOT ? ERR_OK : ERR_STATE;
}

/* ---- ending ---- */

static void release(struct commission *c, struct supervisor *s)
{
    for (uint8_t k = 0; k < c->inputs; k++)
        supervisor_excite(s, c->input[k].output, num_zero());
}

static void end(struct commission *c, struct supervisor *s, enum commission_why why,
                const char *subject, real_t value)
{
    bool on_trial = c->phase == COMMISSION_TRIAL;
    release(c, s);
    /* An interlock or the operator may have moved what was held; back to it, unless somebody else decides now. */
    bool others = on_trial || why == WHY_HAND || why == WHY_CONFIG || why == WHY_SAFE;
    for (uint8_t k = 0; k < c->inputs && !others; k++)
        s->output[c->input[k].output].manual = num_from_float(c->input[k].held);
    c->phase = COMMISSION_ENDED;
    c->why = why;
    c->value = value;
    memset(c->subject, 0, sizeof c->subject);
    for (unsigned i = 0; subject && subject[i] && i + 1 < sizeof c->subject; i++)
        c->subject[i] = subject[i];
    c->job = JOB_NONE;
    c->ended_ms = s->time_ms;
    event_put(c->events, s->time_ms, on_trial ? EVENT_TRIAL_FAILED : EVENT_COMMISSION_ENDED,
              subject, value, (uint8_t)why);
}

/* Anything that is not a test's to decide. */
static enum commission_why disturbance(const struct commission *c, const struct supervisor *s,
                                       const char **subject)
{
    const struct config *config = &s->plan->config;
    *subject = NULL;
    if (s->plan->serial != c->plan_serial)
        return WHY_CONFIG;
    /* Somebody may have left it again within this very tick. */
    if (s->state == SUPERVISOR_SAFE || s->safe_count != c->safe_count)
        return WHY_SAFE;
    for (uint8_t j = 0; j < c->outputs; j++) {
        *subject = config->measurement[c->measurement[j]].name;
        if (is_lost(s, c->measurement[j]))
            return WHY_LOST;
    }
    for (uint8_t k = 0; k < c->inputs; k++) {
        uint8_t j = c->input[k].output;
        *subject = config->output[j].name;
        if (s->output[j].forced)
            return WHY_INTERLOCK;
        if (is_deaf(s, j))
            return WHY_ACTUATOR;
        if (acting(s, j) != PLAN_NONE || num_to_float(s->output[j].manual) != c->input[k].held)
            return WHY_HAND;
    }
    *subject = NULL;
    return WHY_NOT;
}

/* ---- tests ---- */

static const char *input_name(const struct commission *c, const struct supervisor *s)
{
    return s->plan->config.output[c->input[c->order[c->at]].output].name;
}

static uint32_t samples(const struct supervisor *s, real_t seconds)
{
    return (uint32_t)(seconds / s->plan->tick_s + REAL_C(0.5));
}

/* What the operator, and earlier rounds, know of the times of this input. */
static uint32_t least_half(const struct commission *c, const struct supervisor *s, uint8_t k,
                           struct experiment_config *x)
{
    const struct config *config = &s->plan->config;
    real_t longest_s = REAL_C(0.0);
    for (unsigned p = 0; p < CONFIG_PAIRS; p++) {
        const struct pair_config *pair = &config->pair[p];
        if (!pair->measurement[0] || config_find_output(config, pair->output) != c->input[k].output)
            continue;
        uint8_t i = config_find_measurement(config, pair->measurement);
        const struct measurement_config *m = &config->measurement[i];
        const struct output_config *o = &config->output[c->input[k].output];
        if (pair->time_s * REAL_C(4.0) > longest_s)
            longest_s = pair->time_s * REAL_C(4.0);
        real_t gain = real_abs(pair->gain) * (o->hi - o->lo) / (m->hi - m->lo);
        /* A first amplitude that brings the output a quarter of the way to its limit. */
        for (uint8_t j = 0; gain > REAL_C(0.0) && j < c->outputs; j++)
            if (c->measurement[j] == i)
                x->amplitude_first = x->limit[j] * REAL_C(0.25) / gain;
    }
    for (uint8_t j = 0; c->input[k].rounds > 0 && j < c->outputs; j++) {
        const struct identified *e = &c->element[j][k].fit;
        real_t time_s = e->dead_time_s + REAL_C(4.0) * e->time_constant_s;
        if (!(e->flags & IDENTIFIED_NO_GAIN) && time_s > longest_s)
            longest_s = time_s;
    }
    uint32_t known = samples(s, longest_s);
    if (known < c->input[k].half_wanted)
        known = c->input[k].half_wanted;
    uint32_t before = (uint32_t)(SHARE_LEAST * (real_t)c->half_least);
    return known > before ? known : before;
}

static enum err begin_input(struct commission *c, const struct supervisor *s)
{
    const struct config *config = &s->plan->config;
    uint8_t k = c->order[c->at];
    const struct output_config *o = &config->output[c->input[k].output];
    real_t ways = room(s, c->input[k].output, c->input[k].held);
    struct experiment_config x = {
        .outputs = c->outputs,
        .h_s = s->plan->tick_s,
        .window = config->test.window < STEADY_BLOCKS ? STEADY_BLOCKS : config->test.window,
        .noise_floor = NOISE_FLOOR,
        .amplitude = o->test_step / (o->hi - o->lo),
        .amplitude_first = AMPLITUDE_FIRST,
        .amplitude_max = ways,
        .noise_multiple = config->test.noise_multiple,
        .half = samples(s, o->test_time_s),
        .blank_s = config->test.blank_s,
        .line_guard = config->test.guard == TEST_GUARD_LINE};
    for (uint8_t j = 0; j < c->outputs; j++) {
        const struct measurement_config *m = &config->measurement[c->measurement[j]];
        x.limit[j] = m->test_limit > 0.0f ? m->test_limit / (m->hi - m->lo) : TEST_LIMIT_DEFAULT;
        if (m->test_critical)
            x.limit[j] *= REAL_C(0.5);
        if (c->input[k].rounds > 0)
            x.dead_time_s[j] = c->element[j][k].fit.dead_time_s;
    }
    if (x.amplitude > x.amplitude_max)
        x.amplitude = x.amplitude_max;
    if (x.amplitude <= REAL_C(0.0)) {
        if (c->input[k].rounds > 0)
            x.amplitude_first = c->input[k].amplitude; /* it was large enough, or all there is */
        if (x.amplitude_max > AMPLITUDE_MOST)
            x.amplitude_max = AMPLITUDE_MOST;
    }
    x.half_most = config->test.longest_s > 0.0f ? samples(s, config->test.longest_s) : HALF_MOST;
    if (x.half_most < x.half)
        x.half_most = x.half;
    if (x.half_most <= x.window)
        x.half_most = x.window + 1u;
    x.half_least = least_half(c, s, k, &x);
    if (x.half_least < x.window)
        x.half_least = x.window;
    if (x.half_least > x.half_most)
        x.half_least = x.half_most;
    if (!(x.amplitude_first > NOISE_FLOOR))
        x.amplitude_first = NOISE_FLOOR;
    c->phase = COMMISSION_TESTING;
    c->phase_ms = s->time_ms;
    return experiment_begin(&c->work.test.experiment, &x);
}

static void start_input(struct commission *c, struct supervisor *s)
{
    enum err err = begin_input(c, s);
    if (err)
        end(c, s, WHY_NUMBERS, input_name(c, s), (real_t)err);
}

static void begin(struct commission *c, struct supervisor *s)
{
    const char *what, *wanted;
    struct event_queue *events = c->events;
    if (commission_may_begin(s, &what, &wanted) != ERR_OK) {
        event_put(events, s->time_ms, EVENT_REQUEST_REFUSED, what, 0.0f, 0);
        return;
    }
    commission_init(c, events);
    c->plan_serial = s->plan->serial;
    c->channels = commission_channels(&s->plan->config);
    c->safe_count = s->safe_count;
    c->began_ms = s->time_ms;
    c->round = 1;
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (measurement_is_tested(s, i))
            c->measurement[c->outputs++] = i;
    for (uint8_t j = 0; j < CHANNEL_MAX; j++) {
        if (!input_is_tested(s, j))
            continue;
        c->input[c->inputs].output = j;
        c->input[c->inputs++].held = held_at(s, j);
    }
    uint8_t n = 0;
    for (unsigned critical = 2; critical-- > 0;)
        for (uint8_t k = 0; k < c->inputs; k++)
            if (s->plan->config.output[c->input[k].output].test_critical == critical)
                c->order[n++] = k;
    event_put(events, s->time_ms, EVENT_COMMISSION_BEGUN, NULL, (float)c->inputs, 0);
    start_input(c, s);
}

static void ask_for(struct commission *c, enum model_job job, uint32_t ticks)
{
    c->job_done = false;
    c->job_ticks = 0;
    c->job_due = ticks;
    c->job_number = c->job_number + 1u;
    c->job = (uint8_t)job; /* last: from here on the background may work */
}

/* The analysis of a large plant takes a small board some seconds; the plant is at rest meanwhile. */
static void analyse(struct commission *c, const struct supervisor *s)
{
    c->phase = COMMISSION_ANALYSING;
    c->phase_ms = s->time_ms;
    model_begin_analysis(c, &s->plan->config, s->plan->tick_s);
    ask_for(c, JOB_ANALYSE, 1u + samples(s, REAL_C(20.0)));
}

/* The next input that has not been skipped, or the analysis. */
static void next_input(struct commission *c, struct supervisor *s)
{
    do
        c->at++;
    while (c->at < c->inputs && c->input[c->order[c->at]].skipped);
    if (c->at < c->inputs)
        start_input(c, s);
    else
        analyse(c, s);
}

static void next_round(struct commission *c, struct supervisor *s)
{
    c->round++;
    c->at = 0;
    if (c->input[c->order[0]].skipped)
        next_input(c, s);
    else
        start_input(c, s);
}

static void end_test(struct commission *c, struct supervisor *s)
{
    const struct experiment *x = &c->work.test.experiment;
    struct tested_input *in = &c->input[c->order[c->at]];
    in->amplitude = x->amplitude;
    in->half_s = (real_t)x->half * x->config.h_s;
    in->cut = x->cut;
    in->small = x->small;
    if (x->worst > in->worst)
        in->worst = x->worst;
    if (x->half > c->half_least && !x->cut)
        c->half_least = x->half;
    for (uint8_t j = 0; j < c->outputs; j++)
        c->noise_sd[j] = x->before[j].noise_sd;
    event_put(c->events, s->time_ms, EVENT_TEST_DONE, input_name(c, s), in->half_s, c->round);
    c->phase = COMMISSION_FITTING;
    c->phase_ms = s->time_ms;
    model_begin_fit(c);
    ask_for(c, JOB_FIT, 1u + samples(s, REAL_C(2.0)));
}

static void test(struct commission *c, struct supervisor *s)
{
    struct experiment *x = &c->work.test.experiment;
    uint8_t k = c->order[c->at];
    real_t y[CHANNEL_MAX];
    enum experiment_phase before = x->phase;
    enum err err = ERR_OK;
    uint32_t missed = samples(s, elapsed_ms(s->time_ms, c->sample_ms) / REAL_C(1000.0));
    c->sample_ms = s->time_ms;
    if (x->begun && missed > MISSED_MOST + 1u) {
        end(c, s, WHY_SAMPLES, NULL, (real_t)(missed - 1u));
        return;
    }
    for (; x->begun && missed > 1 && !err; missed--)
        err = experiment_missed(x);
    for (uint8_t j = 0; j < c->outputs; j++)
        y[j] = num_to_float(s->measurement[c->measurement[j]].value);
    if (c->job == JOB_LOOK && ++c->job_ticks >= c->job_due && c->job_done) {
        c->job = JOB_NONE;
        experiment_looked(x);
    }
    if (!err)
        err = experiment_step(x, y);
    if (err) {
        end(c, s, WHY_NUMBERS, input_name(c, s), REAL_C(0.0));
        return;
    }
    supervisor_excite(s, c->input[k].output, num_from_float(x->level));
    if (x->looking && c->job == JOB_NONE)
        ask_for(c, JOB_LOOK, 1u + samples(s, REAL_C(2.0)));
    if (before == EXPERIMENT_REST && x->phase == EXPERIMENT_UP)
        event_put(c->events, s->time_ms, EVENT_TEST_STEP, input_name(c, s), x->amplitude, c->round);
    if (before == EXPERIMENT_UP && x->phase == EXPERIMENT_DOWN && x->cut) {
        c->input[k].cut_by = x->culprit;
        c->input[k].cut_predicted = x->predicted;
        event_put(c->events, s->time_ms, EVENT_TEST_CUT,
                  s->plan->config.measurement[c->measurement[x->culprit]].name, x->predicted, 0);
    }
    if (x->phase == EXPERIMENT_FAILED) {
        static const enum commission_why why[] = {[EXPERIMENT_FINE] = WHY_NUMBERS,
                                                  [EXPERIMENT_RESTLESS] = WHY_RESTLESS,
                                                  [EXPERIMENT_LIMIT] = WHY_LIMIT,
                                                  [EXPERIMENT_AWAY] = WHY_AWAY};
        c->input[k].worst = x->worst;
        end(c, s, why[x->failure], s->plan->config.measurement[c->measurement[x->culprit]].name,
            x->worst);
    } else if (x->phase == EXPERIMENT_DONE) {
        end_test(c, s);
    }
}

/* ---- results ---- */

/* An output that looks like an integrator may only be slow: once more with three times the half, as long as that fits and
 * no output was near its limit. */
static bool test_longer(struct commission *c, struct supervisor *s)
{
    const struct experiment *x = &c->work.test.experiment;
    struct tested_input *in = &c->input[c->order[c->at]];
    if (x->cut || x->config.half > 0 || x->at_longest || in->longer == LONGER_MOST)
        return false;
    in->longer++;
    in->half_wanted = LONGER * x->half;
    event_put(c->events, s->time_ms, EVENT_TEST_LONGER, input_name(c, s),
              (real_t)in->half_wanted * x->config.h_s, in->longer);
    start_input(c, s);
    return true;
}

static void take_fit(struct commission *c, struct supervisor *s)
{
    uint8_t k = c->order[c->at];
    if (c->job_error) {
        end(c, s, WHY_NUMBERS, input_name(c, s), (real_t)c->job_error);
        return;
    }
    for (uint8_t j = 0; j < c->outputs; j++) {
        if (c->climbs[j] < CLIMBS)
            continue;
        if (test_longer(c, s))
            return;
        /* A step that was cut short says less: there the fit must think so, too. */
        if (c->work.test.experiment.cut && !(c->fitted[j].flags & IDENTIFIED_INTEGRATING))
            continue;
        end(c, s, WHY_INTEGRATES, s->plan->config.measurement[c->measurement[j]].name,
            c->input[k].worst);
        return;
    }
    model_keep(c);
    c->input[k].rounds++;
    next_input(c, s);
}

/* Would more of the same tests help? Not when the gains are already as sure as a first-order model can be. */
static bool noise_decides(const struct analysis *a)
{
    for (uint8_t j = 0; j < a->plant.outputs; j++)
        for (uint8_t k = 0; k < a->plant.inputs; k++)
            if (a->plant.gain_sd[j][k] > a->config.floor * real_abs(a->plant.element[j][k].gain))
                return true;
    return false;
}

static void take_analysis(struct commission *c, struct supervisor *s)
{
    const struct analysis *a = &c->work.analysis;
    if (c->job_error) {
        end(c, s, c->job_error == ERR_EMPTY ? WHY_NO_INPUT : WHY_NUMBERS, NULL,
            (real_t)c->job_error);
        return;
    }
    bool open = a->verdict != PAIRING_DETERMINED;
    if (open && c->round < s->plan->config.test.rounds && noise_decides(a)) {
        event_put(c->events, s->time_ms, EVENT_TEST_EXTENDED, NULL, a->probability,
                  (uint8_t)(c->round + 1u));
        next_round(c, s);
        return;
    }
    c->phase = COMMISSION_READY;
    c->analysed = true;
    c->phase_ms = c->ended_ms = s->time_ms;
    event_put(c->events, s->time_ms, open ? EVENT_NOT_DETERMINED : EVENT_PROPOSAL, NULL,
              a->probability, a->designed);
}

static void wait_for_job(struct commission *c, struct supervisor *s)
{
    if (++c->job_ticks < c->job_due || !c->job_done)
        return;
    uint8_t job = c->job;
    c->job = JOB_NONE;
    if (job == JOB_FIT)
        take_fit(c, s);
    else
        take_analysis(c, s);
}

/* ---- trial ---- */

/* The loops go to manual and their outputs to where the trial found them; but what somebody has taken in hand stays
 * there. The main loop puts the old configuration into force. */
static void back_to_old(struct commission *c, struct supervisor *s, enum commission_why why,
                        const char *subject, real_t value)
{
    const struct adoption *a = &c->adoption;
    end(c, s, why, subject, value);
    for (uint8_t k = 0; k < a->n; k++) {
        uint8_t i = a->loop[k].loop;
        if (why == WHY_HAND && s->loop[i].mode != LOOP_AUTO)
            continue;
        struct request r = {
            .kind = REQUEST_MODE, .loop = i, .output = PLAN_NONE, .mode = LOOP_MANUAL};
        memcpy(r.name, s->plan->config.loop[i].name, sizeof r.name);
        supervisor_request(s, &r);
        s->output[s->plan->loop[i].output].manual = num_from_float(a->loop[k].held);
    }
    c->phase = COMMISSION_RETURNED;
    c->wants_old = true;
}

/* What is not for the adoption to judge. True: the trial is over. */
static bool trial_is_disturbed(struct commission *c, struct supervisor *s)
{
    const char *subject;
    if (s->plan->serial != c->plan_serial) {
        end(c, s, WHY_CONFIG, NULL, REAL_C(0.0)); /* that one stays */
        return true;
    }
    enum commission_why why = s->safe_count != c->safe_count ? WHY_SAFE : WHY_NOT;
    if (why == WHY_NOT)
        why = hindrance(c, s, &subject);
    if (why == WHY_SAFE) {
        end(c, s, WHY_SAFE, NULL, REAL_C(0.0));
        c->phase = COMMISSION_RETURNED;
        c->wants_old = true; /* what was not tried to the end is not kept */
        return true;
    }
    if (why != WHY_NOT)
        back_to_old(c, s, why, subject, REAL_C(0.0));
    return why != WHY_NOT;
}

static void begin_trial(struct commission *c, struct supervisor *s)
{
    c->plan_serial = c->trial_serial;
    c->safe_count = s->safe_count;
    c->phase = COMMISSION_TRIAL;
    c->why = WHY_NOT;
    c->phase_ms = s->time_ms;
    if (s->plan->serial == c->plan_serial)
        adoption_hold(&c->adoption, s);
    if (trial_is_disturbed(c, s))
        return;
    adoption_begin(&c->adoption, s);
    event_put(c->events, s->time_ms, EVENT_TRIAL_BEGUN, NULL, (float)c->adoption.n, 0);
}

static void trial(struct commission *c, struct supervisor *s)
{
    static const enum commission_why why[] = {
        [ADOPTION_RUNNING] = WHY_NOT,
        [ADOPTION_PASSED] = WHY_NOT,
        [ADOPTION_PAST_LIMIT] = WHY_TRIAL_LIMIT,
        [ADOPTION_SLOW] = WHY_TRIAL_SLOW,
        [ADOPTION_OVERSHOOT] = WHY_TRIAL_PEAK,
        [ADOPTION_RESTLESS] = WHY_TRIAL_REST,
        [ADOPTION_NOT_AUTO] = WHY_HAND,
    };
    if (trial_is_disturbed(c, s))
        return;
    enum adoption_result r = adoption_tick(&c->adoption, s);
    if (r == ADOPTION_RUNNING)
        return;
    if (r == ADOPTION_PASSED) {
        c->phase = COMMISSION_KEPT;
        c->ended_ms = s->time_ms;
        event_put(c->events, s->time_ms, EVENT_TRIAL_KEPT, NULL, (float)c->adoption.n, 0);
        return;
    }
    const struct adoption_loop *l = &c->adoption.loop[c->adoption.culprit];
    back_to_old(c, s, why[r], s->plan->config.loop[l->loop].name, l->peak);
}

/* ---- the tick ---- */

static void pause_test(struct commission *c, struct supervisor *s)
{
    release(c, s);
    c->phase = COMMISSION_PAUSED;
    c->phase_ms = s->time_ms;
}

/* What was asked for may not make sense any more. */
static void take_ask(struct commission *c, struct supervisor *s)
{
    const char *wanted;
    enum commission_ask ask = (enum commission_ask)c->ask;
    if (ask == COMMISSION_ASK_TRIAL && (int32_t)(s->plan->serial - c->trial_serial) < 0)
        return; /* its plan comes with a later tick */
    if (ask == COMMISSION_ASK_BEGIN && c->working)
        return; /* a piece of an abandoned job still runs under this tick: next time */
    c->ask = COMMISSION_ASK_NONE;
    if (commission_may(c, ask, &wanted) != ERR_OK)
        return;
    switch (ask) {
    case COMMISSION_ASK_BEGIN:
        begin(c, s);
        break;
    case COMMISSION_ASK_PAUSE:
        pause_test(c, s);
        break;
    case COMMISSION_ASK_RESUME:
        start_input(c, s);
        break;
    case COMMISSION_ASK_SKIP:
        release(c, s);
        c->input[c->order[c->at]].skipped = true;
        next_input(c, s);
        break;
    case COMMISSION_ASK_REPEAT:
        release(c, s);
        c->at--;
        c->input[c->order[c->at]].rounds = 0;
        c->input[c->order[c->at]].skipped = false;
        start_input(c, s);
        break;
    case COMMISSION_ASK_ABORT:
        if (c->phase == COMMISSION_TRIAL)
            back_to_old(c, s, WHY_ASKED, NULL, REAL_C(0.0));
        else
            end(c, s, WHY_ASKED, NULL, REAL_C(0.0));
        break;
    case COMMISSION_ASK_TRIAL:
        begin_trial(c, s);
        break;
    default:
        c->phase = COMMISSION_IDLE;
        break;
    }
}

static void go_on(struct commission *c, struct supervisor *s)
{
    if (c->ask != COMMISSION_ASK_NONE)
        take_ask(c, s);
    if (is_testing(c)) {
        const char *subject;
        enum commission_why why = disturbance(c, s, &subject);
        if (why != WHY_NOT) {
            end(c, s, why, subject, REAL_C(0.0));
            return;
        }
    }
    if (c->phase == COMMISSION_TESTING)
        test(c, s);
    else if (c->phase == COMMISSION_FITTING || c->phase == COMMISSION_ANALYSING)
        wait_for_job(c, s);
    else if (c->phase == COMMISSION_TRIAL)
        trial(c, s);
}

void commission_tick(struct commission *c, struct supervisor *s)
{
    go_on(c, s);
    s->testing = is_testing(c) || c->phase == COMMISSION_TRIAL;
}

bool commission_waits(const struct commission *c)
{
    return c->job != JOB_NONE && !c->job_done && c->job_ticks + 1u >= c->job_due;
}

bool commission_work(struct commission *c)
{
    c->working = true;
    uint32_t number = c->job_number;
    atomic_signal_fence(memory_order_seq_cst);
    enum model_job job = (enum model_job)c->job; /* the tick may end it from here on */
    bool work = job != JOB_NONE && !c->job_done;
    bool done = work && !model_work(c, job);
    atomic_signal_fence(memory_order_seq_cst);
    if (done && c->job_number == number)
        c->job_done = true;
    c->working = false;
    return work;
}

#endif
