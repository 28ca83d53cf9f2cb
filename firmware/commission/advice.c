#include "commission/advice.h"

#include <string.h>

#include "base/assertion.h"
#include "commission/analysis_job.h"
#include "commission/by_relay.h"
#include "commission/certainty.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/lease.h"
#include "commission/next_test.h"
#include "commission/sensor_advice.h"
#include "commission/status.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"

#define TIME_MORE    REAL_C(1.25) /* for the error of the time constant */
#define LONGEST_SET  REAL_C(1e6)  /* s, largest test.longest and test_time */
#define STEP_SMALLER REAL_C(0.5) /* of the step that went past a limit, over the share it reached */
#define ROOM_USED    REAL_C(0.7) /* share of a limit that larger steps may use */
#define WORTH        REAL_C(1.3) /* smallest factor for a setting that is worth a start-up */
#define STEPS_MORE   REAL_C(4.0) /* factor for steps that noise hides */
#define NOISE_SDS    REAL_C(4.0) /* how far noise alone takes a measurement */
#define NOISE_MOST   REAL_C(1000.0)
#define ROUNDS_MORE  4u /* costs nothing where fewer do */
#define ROUNDS_MOST  16u
#define WINDOW_MORE                                                                                \
    16u /* a window must see many waves, and a start-up that waits in vain takes long */
#define WINDOW_MOST 1000u
#define LARGER      REAL_C(2.0) /* of the least step that a coarse sensor shows */

static bool results_are_there(const struct commission *c)
{
    return lease_holds(&c->lease);
}

/* Index of the output with that name; -1: none. */
static int output_named(const struct commission *c, const struct supervisor *s, const char *name)
{
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++)
        if (strcmp(outputs_name(&c->outputs, s, j), name) == 0)
            return j;
    return -1;
}

/* A half of `needed_s` for an input, by the setting that binds. False: none does. */
static bool longer_half(const struct supervisor *s, uint8_t mv, uint8_t measurement,
                        real_t needed_s, struct advice *a)
{
    REFLUX_ASSERT(mv < CHANNEL_MAX);
    const struct config *config = &s->plan->config;
    real_t given_s = config->mv[mv].start_up.time_s, longest_s = config->test.longest_s;
    bool timed = given_s > REAL_C(0.0);
    real_t most_s = (real_t)COMMISSION_HALF_MOST * s->plan->tick_s;
    *a = (struct advice){.kind = timed ? ADVICE_TIME : ADVICE_LONGEST,
                         .input = mv,
                         .measurement = measurement,
                         .value =
                             needed_s < most_s && needed_s < LONGEST_SET ? needed_s : REAL_C(0.0),
                         .present = timed ? given_s : longest_s};
    return a->present > REAL_C(0.0) && needed_s > a->present;
}

/* The input under test has no place in a start-up; the others go on without it. */
static unsigned leave_input(const struct commission *c, uint8_t measurement, struct advice *a)
{
    *a = (struct advice){.kind = ADVICE_LEAVE,
                         .input = inputs_under_test(&c->inputs)->output,
                         .measurement = measurement};
    return inputs_count(&c->inputs) > 1;
}

/* Output j was still climbing when the longest half of the present input ended. */
static unsigned after_slow(const struct commission *c, const struct supervisor *s, uint8_t j,
                           struct advice *a)
{
    const struct tested_input *in = inputs_under_test(&c->inputs);
    const struct identified *f = model_fitted(&c->model, j);
    uint8_t measurement = outputs_measurement(&c->outputs, j);
    /* Beyond all lengths where the time is not known: the board then finds it. */
    real_t needed_s = (real_t)COMMISSION_HALF_MOST * s->plan->tick_s;
    if (identified_is_timed(f))
        needed_s = TIME_MORE * identified_over_s(f);
    if (longer_half(s, in->output, measurement, needed_s, a))
        return 1;
    return leave_input(c, measurement, a);
}

/* A step past the limit of measurement j, by what was reached and what the guard foresaw. Below the noise floor no step is seen. */
static unsigned after_limit(const struct commission *c, const struct supervisor *s, uint8_t j,
                            struct advice *a)
{
    const struct tested_input *in = inputs_under_test(&c->inputs);
    const struct mv_config *o = &s->plan->config.mv[in->output];
    uint8_t measurement = outputs_measurement(&c->outputs, j);
    bool by_relay = by_relay_is_latest(&c->by_relay);
    real_t step =
        by_relay ? c->work->relay.relay.amplitude : experiment_amplitude(&c->work->experiment);
    real_t foreseen =
        real_abs(in->cut_predicted) / commission_limit(&s->plan->config.measurement[measurement]);
    real_t reached = in->worst > foreseen ? in->worst : foreseen;
    real_t smaller = STEP_SMALLER * step / (reached > REAL_C(1.0) ? reached : REAL_C(1.0));
    if (!(step > REAL_C(0.0)))
        return 0;
    if (!(smaller > NOISE_FLOOR))
        return by_relay ? 0 : leave_input(c, measurement, a);
    *a = (struct advice){.kind = ADVICE_STEP,
                         .input = in->output,
                         .measurement = measurement,
                         .value = smaller * (o->hi - o->lo),
                         .present = step * (o->hi - o->lo)};
    return 1;
}

static unsigned after_end(const struct commission *c, const struct supervisor *s, struct advice *a)
{
    const struct config *config = &s->plan->config;
    enum commission_reason reason = status_reason(&c->status);
    int j = output_named(c, s, status_subject(&c->status));
    if (j < 0 || inputs_turn(&c->inputs) >= inputs_count(&c->inputs))
        return 0;
    unsigned window = WINDOW_MORE * config->test.window;
    switch (reason) {
    case REASON_TOO_SLOW:
    case REASON_INTEGRATES:
        return after_slow(c, s, (uint8_t)j, a);
    case REASON_LIMIT:
    case REASON_REVERSAL:
        return after_limit(c, s, (uint8_t)j, a);
    case REASON_RESTLESS:
        *a = (struct advice){.kind = ADVICE_WINDOW,
                             .measurement = outputs_measurement(&c->outputs, (uint8_t)j),
                             .value = (real_t)(window < WINDOW_MOST ? window : WINDOW_MOST),
                             .present = (real_t)config->test.window};
        return a->value > WORTH * a->present;
    default:
        return 0;
    }
}

/* A response whose end was not seen, so that its time is not known, where a setting forbids the longest half. */
static unsigned after_short(const struct commission *c, const struct supervisor *s,
                            struct advice *a)
{
    const struct analysis *analysis = &c->work->analysis;
    real_t needed_s = (real_t)COMMISSION_HALF_MOST * s->plan->tick_s;
    for (uint8_t j = 0; j < analysis->plant.outputs; j++)
        for (uint8_t i = 0; i < analysis->plant.inputs; i++) {
            uint8_t k = analysis_job_input(&c->analysis_job, i);
            if (certainty_flags(analysis, j, i) &&
                longer_half(s, inputs_get(&c->inputs, k)->output,
                            outputs_measurement(&c->outputs, j), needed_s, a))
                return 1;
        }
    return 0;
}

/* A set length binds, and nothing is known that says how long it should be: the board finds it. open: a response is not seen to
 * its end, else a half must have been as long as that. */
static unsigned after_longest(const struct commission *c, const struct supervisor *s, bool open,
                              struct advice *a)
{
    real_t longest_s = s->plan->config.test.longest_s;
    *a = (struct advice){.kind = ADVICE_LONGEST, .measurement = CHANNEL_MAX, .present = longest_s};
    if (!(longest_s > REAL_C(0.0)))
        return 0;
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++)
        if (open || inputs_get(&c->inputs, k)->half_s > longest_s - s->plan->tick_s)
            return 1;
    return 0;
}

static bool has_line(const struct advice *a, unsigned n, uint8_t input)
{
    for (unsigned i = 0; i < n; i++)
        if ((a[i].kind == ADVICE_LARGER || a[i].kind == ADVICE_STRONGER) && a[i].input == input)
            return true;
    return false;
}

/* Share of a limit that the tests of an input have used, without what noise takes. */
static real_t share_moved(const struct commission *c, const struct supervisor *s,
                          const struct tested_input *in)
{
    real_t by_noise = REAL_C(0.0);
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        uint8_t i = outputs_measurement(&c->outputs, j);
        real_t share = NOISE_SDS * outputs_noise(&c->outputs)[j] /
                       commission_limit(&s->plan->config.measurement[i]);
        by_noise = share > by_noise ? share : by_noise;
    }
    return in->worst > by_noise ? in->worst - by_noise : REAL_C(0.0);
}

/* Largest step of input k that range and limits leave room for, fraction of span. */
static real_t step_most(const struct commission *c, const struct supervisor *s, uint8_t k)
{
    const struct tested_input *in = inputs_get(&c->inputs, k);
    real_t most = commission_room(s, in->output, in->test_base);
    real_t moved = share_moved(c, s, in);
    if (moved * most > ROOM_USED * in->amplitude)
        most = ROOM_USED * in->amplitude / moved;
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        const struct shape_found *f = &c->work->element[j][k].found;
        real_t gain = real_abs(f->shape.gain) + REAL_C(2.0) * f->sd[SHAPE_GAIN];
        real_t limit =
            commission_limit(&s->plan->config.measurement[outputs_measurement(&c->outputs, j)]);
        if (gain * most > ROOM_USED * limit)
            most = ROOM_USED * limit / gain;
    }
    return most;
}

/* Larger steps of all inputs that have none of the n lines yet, as far as their limits leave room: of those whose step is given one by
 * one, of the others by the multiple of noise. Returns the number of lines then. */
static unsigned larger_steps(const struct commission *c, const struct supervisor *s,
                             struct advice *a, unsigned n)
{
    real_t now = s->plan->config.test.noise_multiple, more = STEPS_MORE;
    bool grows = false;
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        const struct tested_input *in = inputs_get(&c->inputs, k);
        const struct mv_config *o = &s->plan->config.mv[in->output];
        real_t most = step_most(c, s, k), moved = share_moved(c, s, in);
        if (in->rounds == 0 || !(in->amplitude > REAL_C(0.0)) || has_line(a, n, in->output))
            continue;
        if (!(o->start_up.step > 0.0f)) {
            /* A response below the multiple has been held back by something else. */
            grows = grows || (!in->small && WORTH * in->amplitude <
                                                (most < AMPLITUDE_MOST ? most : AMPLITUDE_MOST));
            if (moved * more > ROOM_USED)
                more = ROOM_USED / moved;
            continue;
        }
        if (STEPS_MORE * in->amplitude < most)
            most = STEPS_MORE * in->amplitude;
        if (n < ADVICE_MOST && most > WORTH * in->amplitude)
            a[n++] = (struct advice){.kind = ADVICE_STRONGER,
                                     .input = in->output,
                                     .measurement = CHANNEL_MAX,
                                     .value = most * (o->hi - o->lo),
                                     .present = in->amplitude * (o->hi - o->lo)};
    }
    real_t value = now * more < NOISE_MOST ? now * more : NOISE_MOST;
    if (n < ADVICE_MOST && grows && value > WORTH * now)
        a[n++] = (struct advice){
            .kind = ADVICE_NOISE, .measurement = CHANNEL_MAX, .value = value, .present = now};
    return n;
}

static unsigned more_rounds(const struct supervisor *s, struct advice *a)
{
    unsigned now = s->plan->config.test.rounds, more = ROUNDS_MORE * now;
    *a = (struct advice){.kind = ADVICE_ROUNDS,
                         .measurement = CHANNEL_MAX,
                         .value = (real_t)(more < ROUNDS_MOST ? more : ROUNDS_MOST),
                         .present = (real_t)now};
    return now < ROUNDS_MOST;
}

static unsigned relay_of_a_pair(const struct commission *c, struct advice *a)
{
    const struct analysis *analysis = &c->work->analysis;
    if (analysis->pairs.n == 0)
        return 0;
    uint8_t k = analysis_job_input(&c->analysis_job, analysis->pairs.input[0]);
    *a =
        (struct advice){.kind = ADVICE_RELAY,
                        .input = inputs_get(&c->inputs, k)->output,
                        .measurement = outputs_measurement(&c->outputs, analysis->pairs.output[0])};
    return 1;
}

/* Steps that coarse sensors show, where the steps were smaller. Likewise. */
static unsigned steps_for_sensors(const struct commission *c, const struct supervisor *s,
                                  struct advice *a, unsigned n)
{
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        struct sensor_advice sensor;
        if (!sensor_advice_of(c, s, j, &sensor) || !(sensor.step_least > REAL_C(0.0)) ||
            has_line(a, n, sensor.input))
            continue;
        const struct mv_config *o = &s->plan->config.mv[sensor.input];
        for (uint8_t k = 0; k < inputs_count(&c->inputs) && n < ADVICE_MOST; k++) {
            const struct tested_input *in = inputs_get(&c->inputs, k);
            real_t step = in->amplitude * (o->hi - o->lo);
            real_t most = step_most(c, s, k) * (o->hi - o->lo);
            real_t wanted = LARGER * sensor.step_least;
            if (in->output != sensor.input || most < sensor.step_least)
                continue;
            if (wanted > most)
                wanted = most;
            if (step > REAL_C(0.0) && wanted > WORTH * step)
                a[n++] = (struct advice){.kind = ADVICE_LARGER,
                                         .input = sensor.input,
                                         .measurement = outputs_measurement(&c->outputs, j),
                                         .value = wanted,
                                         .present = step};
        }
    }
    return n;
}

/* Inputs act nearly alike, and moving them together has not shown the difference, or there was no place for such a test. While the
 * other loops are closed, one input alone shows what it does beyond them. The pair with the largest relative gain is left for that:
 * without it the others are the easiest to tell apart. */
static unsigned loops_in_turn(const struct commission *c, struct advice *a)
{
    const struct analysis *analysis = &c->work->analysis;
    uint8_t n = analysis->pairs.n, last = 0;
    bool shown = inputs_has_direction(&c->inputs) || inputs_count(&c->inputs) == CHANNEL_MAX;
    if (n < 2u || !shown || inputs_tests(&c->inputs) == 0)
        return 0;
    for (uint8_t k = 1; k < n; k++)
        if (analysis->pair_lambda[k] > analysis->pair_lambda[last])
            last = k;
    uint8_t input = analysis_job_input(&c->analysis_job, analysis->pairs.input[last]);
    for (unsigned i = 0; i < 2; i++)
        a[i] = (struct advice){
            .kind = i == 0 ? ADVICE_OTHERS_FIRST : ADVICE_THEN_THIS,
            .input = inputs_get(&c->inputs, input)->output,
            .measurement = outputs_measurement(&c->outputs, analysis->pairs.output[last]),
            .value = (real_t)n * inputs_mean_test_s(&c->inputs) / REAL_C(3600.0)};
    return 2;
}

static unsigned after_analysis(const struct commission *c, const struct supervisor *s,
                               struct advice *a)
{
    const struct analysis *analysis = &c->work->analysis;
    unsigned doubts = certainty_doubts(&analysis->certainty), n = 0;
    unsigned by_noise = DOUBT_DRAWS | DOUBT_DETERMINANT | DOUBT_RANK | DOUBT_SIGN;
    /* Surer gains may have settings that serve all plants that the true one may be. */
    bool no_settings =
        analysis->verdict == PAIRING_DETERMINED && analysis->design_error == ERR_TIMEOUT;
    if (doubts & DOUBT_SHAPE) {
        n += after_short(c, s, &a[n]);
        if (n == 0)
            n += after_longest(c, s, true, &a[n]);
        if (n == 0)
            n += more_rounds(s, &a[n]);
    } else if (no_settings || (doubts & by_noise)) {
        if (doubts & (DOUBT_DETERMINANT | DOUBT_RANK))
            n += loops_in_turn(c, a);
        if (n > 0)
            return n;
        n += after_longest(c, s, false, &a[n]);
        n = steps_for_sensors(c, s, a, n);
        n = larger_steps(c, s, a, n);
        if (n < ADVICE_MOST)
            n += more_rounds(s, &a[n]);
    }
    if (n < ADVICE_MOST)
        n += relay_of_a_pair(c, &a[n]);
    return n;
}

unsigned advice_of(const struct commission *c, const struct supervisor *s, struct advice *advice)
{
    enum commission_phase phase = status_phase(&c->status);
    if (!results_are_there(c) || !outputs_are_those_of(&c->outputs, &s->plan->config))
        return 0;
    if (phase == COMMISSION_ENDED)
        return after_end(c, s, advice);
    if (phase == COMMISSION_READY && !c->work->analysis.designed)
        return after_analysis(c, s, advice);
    return 0;
}
