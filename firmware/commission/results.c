#include "commission/results.h"

#include "commission/analysis_job.h"
#include "commission/background.h"
#include "commission/certainty.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/direction.h"
#include "commission/experiment.h"
#include "commission/limits.h"
#include "commission/model.h"
#include "commission/next_test.h"
#include "commission/sensor_advice.h"
#include "commission/start_stop.h"
#include "commission/status.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "commission/tests.h"

#define CLIMBS     REAL_C(0.7) /* second half of a level over the first: 1 for an integrator */
#define CLIMBS_TOO REAL_C(0.5) /* the same where the fit agrees */
#define TOO_LONG   REAL_C(1.5) /* for the error of a time constant that is read from two changes */
#define LONGER     3u          /* factor for the half where an output did not come to rest */
/* Gain up less gain down over their mean from which the step was too large. */
#define ASYMMETRY_MUCH   REAL_C(0.5)
#define ASYMMETRY_WANTED REAL_C(0.2)
#define SMALLER_MOST     REAL_C(0.6) /* largest smaller step, over the one that was cut */
#define SMALLER_LEAST    REAL_C(0.2)
#define SMALLER_SHARE    REAL_C(0.5)  /* share of the room that the response to it may use */
#define SMALLEST         REAL_C(2e-6) /* of span: the fits refuse an input below 1e-6 */
#define UNSEEN_MUCH      REAL_C(0.1)  /* share of a response that a cut test may miss */

/* The analysis of a large plant takes a small board some seconds; the plant is at rest meanwhile. */
static void analyse(struct commission *c, const struct supervisor *s)
{
    status_enter(&c->status, COMMISSION_ANALYSING, s->time_ms);
    analysis_job_begin(c, &s->plan->config, s->plan->tick_s);
    background_ask(&c->background, TASK_ANALYSIS, 1u + commission_samples(s, REAL_C(20.0)));
}

/* After the first round every input has moved what it can move. */
static void warn_of_sensors(const struct commission *c, const struct supervisor *s)
{
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        struct sensor_advice a;
        real_t value;
        if (!sensor_advice_of(c, s, j, &a))
            continue;
        enum sensor_fault fault = sensor_fault_of(&a, &value);
        commission_say_of_output(c, s, EVENT_SENSOR_POOR, j, value, (uint8_t)fault);
    }
}

void commission_next_input(struct commission *c, struct supervisor *s)
{
    if (inputs_next(&c->inputs)) {
        commission_start_input(c, s);
    } else {
        if (inputs_round(&c->inputs) == 1 && !inputs_has_direction(&c->inputs))
            warn_of_sensors(c, s);
        analyse(c, s);
    }
}

/* Marks the inputs for which a longer test may resolve what is open. */
static void want_longer_tests(struct commission *c)
{
    const struct analysis *a = &c->work->analysis;
    for (uint8_t i = 0; i < a->plant.inputs; i++)
        inputs_set_unsettled(&c->inputs, analysis_job_input(&c->analysis_job, i),
                             certainty_wants_longer(&a->certainty, i));
}

static void next_round(struct commission *c, struct supervisor *s)
{
    want_longer_tests(c);
    /* The other inputs are known well enough if nothing else is open. */
    if (inputs_next_round(&c->inputs,
                          certainty_doubts(&c->work->analysis.certainty) == DOUBT_SHAPE))
        commission_start_input(c, s);
    else
        commission_next_input(c, s);
}

/* Output j would take longer than any half that the board chooses itself: of a lag T, the second half of a level brings
 * exp(-half/2T) of what the first one has brought. */
static bool takes_too_long(const struct commission *c, uint8_t j)
{
    const struct experiment *x = &c->work->experiment;
    real_t climbs = model_climbs(&c->model, j);
    real_t half = (real_t)experiment_half(x);
    if (experiment_settings(x)->half_plenty == 0 || experiment_half(x) < COMMISSION_HALF_PLENTY)
        return false;
    real_t most = TOO_LONG * (real_t)COMMISSION_HALF_MOST / IDENTIFIED_OVER; /* of T, samples */
    return climbs >= real_exp(-half / (REAL_C(2.0) * most));
}

/* Repeats the test with three times the half, because an output that looks like an integrator may only be slow. Only where
 * that half is allowed and no output was near its limit. */
static bool retry_longer_halves(struct commission *c, struct supervisor *s, uint8_t j)
{
    const struct experiment *x = &c->work->experiment;
    if (experiment_is_cut(x) || experiment_settings(x)->half > 0 || takes_too_long(c, j) ||
        experiment_half(x) >= commission_longest(s) ||
        inputs_under_test(&c->inputs)->longer_retries == LONGER_RETRIES_MAX)
        return false;
    uint32_t half = LONGER * experiment_half(x);
    uint8_t retries = inputs_want_longer(&c->inputs, half);
    commission_say_of_input(c, s, EVENT_TEST_LONGER, (real_t)half * experiment_settings(x)->h_s,
                            retries);
    commission_start_input(c, s);
    return true;
}

/* Output j looks like an integrator of the input just tested. Not where it came to rest in an earlier round. */
static bool looks_integrating(const struct commission *c, uint8_t j)
{
    bool fit_says = model_fitted(&c->model, j)->flags & CERTAINTY_OPEN_FLAGS;
    return inputs_under_test(&c->inputs)->rounds == 0 &&
           !(model_fitted(&c->model, j)->flags & IDENTIFIED_RAMP) &&
           model_climbs(&c->model, j) >= (fit_says ? CLIMBS_TOO : CLIMBS);
}

/* Repeats the test with a smaller step where an output responds very differently up and down: it is not linear over this
 * range, and terms of third order make its gain another than that at the operating point. The step grows again where noise hides the
 * response. */
static bool retry_linear_step(struct commission *c, struct supervisor *s)
{
    const struct experiment *x = &c->work->experiment;
    uint8_t k = inputs_current(&c->inputs), outputs = outputs_count(&c->outputs);
    const struct tested_input *in = inputs_get(&c->inputs, k);
    real_t worst = REAL_C(0.0);
    for (uint8_t j = 0; j < outputs; j++) {
        real_t asymmetry = real_abs((real_t)c->work->element[j][k].asymmetry) / ASYMMETRY_UNIT;
        if (asymmetry > worst)
            worst = asymmetry;
    }
    bool grown =
        experiment_record(x)->input.edges > 3u; /* a smaller one did not stand out of the noise */
    if (worst < ASYMMETRY_MUCH || grown || in->rounds > 0 || experiment_is_cut(x) ||
        experiment_settings(x)->amplitude > REAL_C(0.0) || in->linear_retries == LINEAR_RETRIES_MAX)
        return false;
    real_t amplitude = experiment_amplitude(x) * ASYMMETRY_WANTED / worst;
    uint8_t retries = inputs_want_linear(&c->inputs, amplitude);
    commission_say_of_input(c, s, EVENT_TEST_SMALLER, amplitude, retries);
    commission_start_input(c, s);
    return true;
}

/* Repeats the test with a smaller step where the guard has cut it before the responses were over. An amplitude that is given
 * stays. */
static bool retry_smaller_step(struct commission *c, struct supervisor *s)
{
    const struct experiment *x = &c->work->experiment;
    uint8_t outputs = outputs_count(&c->outputs);
    real_t a = SMALLER_MOST * experiment_amplitude(x);
    bool missing = experiment_is_one_sided(x);
    for (uint8_t j = 0; j < outputs; j++) {
        const struct identified *f = model_fitted(&c->model, j);
        real_t room = limits_room(x, j), most = real_abs(f->gain) + REAL_C(2.0) * f->gain_sd;
        if (f->flags & IDENTIFIED_NO_GAIN)
            continue;
        if (model_unseen(x, f) > UNSEEN_MUCH)
            missing = true;
        if (!(most * a < SMALLER_SHARE * room))
            a = SMALLER_SHARE * room / most;
    }
    if (!experiment_is_cut(x) || !missing || !experiment_settings(x)->repeats)
        return false;
    if (a < SMALLER_LEAST * experiment_amplitude(x))
        a = SMALLER_LEAST * experiment_amplitude(x);
    if (a < SMALLEST)
        return false;
    /* It takes at least as long again; under a drift it may have been the drift that took so long. */
    if (!experiment_drifts(x))
        inputs_want_half(&c->inputs, experiment_half(x));
    uint8_t retries = inputs_want_uncut(&c->inputs, a);
    commission_say_of_input(c, s, EVENT_TEST_SMALLER, a, retries);
    commission_start_input(c, s);
    return true;
}

/* Output j climbs to the end of the longest level: it is slow if the fit knows its time constant, else it integrates. */
static enum commission_reason reason_of_climb(const struct commission *c, uint8_t j)
{
    const struct identified *f = model_fitted(&c->model, j);
    bool timed = f->time_constant_sd_s > REAL_C(0.0) && identified_is_timed(f);
    return timed ? REASON_TOO_SLOW : REASON_INTEGRATES;
}

static void take_fit(struct commission *c, struct supervisor *s)
{
    enum err err = model_error(&c->model);
    if (err) {
        commission_fail(c, s, (real_t)err);
        return;
    }
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        /* The lags of the inputs nearly cancel in a direction; what is left may climb for long. */
        if (inputs_is_direction(&c->inputs) || !looks_integrating(c, j))
            continue;
        if (retry_longer_halves(c, s, j) || retry_smaller_step(c, s))
            return;
        /* A cut step says less: the fit must agree. */
        if (c->work->experiment.cut && !(model_fitted(&c->model, j)->flags & CERTAINTY_OPEN_FLAGS))
            continue;
        commission_end_by_output(c, s, reason_of_climb(c, j), j,
                                 inputs_under_test(&c->inputs)->worst);
        return;
    }
    if (retry_smaller_step(c, s) || retry_linear_step(c, s))
        return;
    const struct experiment *x = &c->work->experiment;
    if (experiment_is_one_sided(x) && inputs_is_direction(&c->inputs)) {
        inputs_skip(&c->inputs); /* the inputs are known without it */
        commission_next_input(c, s);
        return;
    }
    if (experiment_is_one_sided(x)) {
        commission_end_by_output(c, s, REASON_REVERSAL, experiment_culprit(x),
                                 experiment_predicted(x));
        return;
    }
    model_keep(c);
    inputs_count_round(&c->inputs);
    if (inputs_is_direction(&c->inputs)) {
        commission_next_input(c, s);
        return;
    }
    uint32_t lasts = commission_samples(s, commission_lasts(c, inputs_current(&c->inputs)));
    if (lasts > inputs_half_least(&c->inputs) && inputs_round(&c->inputs) == 1)
        inputs_set_half_least(&c->inputs, lasts);
    commission_next_input(c, s);
}

/* More tests would help. Not where the gains, and what was measured along a direction, are as certain as a model can be. */
static bool more_would_help(const struct analysis *a)
{
    if (certainty_doubts(&a->certainty) & DOUBT_SHAPE)
        return true;
    for (uint8_t j = 0; j < a->plant.outputs; j++) {
        real_t along = REAL_C(0.0);
        for (uint8_t k = 0; k < a->plant.inputs; k++) {
            along += a->plant.share[k] * a->plant.element[j][k].gain;
            if (a->plant.gain_sd[j][k] > a->config.floor * real_abs(a->plant.element[j][k].gain))
                return true;
        }
        if (a->plant.along_sd[j] > a->config.floor * real_abs(along))
            return true;
    }
    return false;
}

static void take_analysis(struct commission *c, struct supervisor *s)
{
    const struct analysis *a = &c->work->analysis;
    enum err err = analysis_job_error(&c->analysis_job);
    if (err) {
        bool empty = err == ERR_EMPTY;
        commission_end(c, s, empty ? REASON_NO_INPUT : REASON_NUMBERS, NULL,
                       empty ? REAL_C(0.0) : (real_t)err);
        return;
    }
    /* Surer gains may have settings that serve all plants that the true one may be. */
    bool open = a->verdict != PAIRING_DETERMINED ||
                (!a->designed && a->design_error == ERR_TIMEOUT &&
                 inputs_round(&c->inputs) < s->plan->config.test.rounds);
    uint8_t round = inputs_round(&c->inputs);
    /* With one round in the settings each input gets one test, and there is no test of a direction. */
    if (open && s->plan->config.test.rounds > 1u && direction_is_wanted(c)) {
        want_longer_tests(c);
        direction_line_up(c);
        commission_say(c, s, EVENT_TEST_EXTENDED, DIRECTION_NAME, a->probability);
        commission_start_input(c, s);
        return;
    }
    if (open && round < s->plan->config.test.rounds && more_would_help(a)) {
        commission_say_of_all(c, s, EVENT_TEST_EXTENDED, a->probability, (uint8_t)(round + 1u));
        next_round(c, s);
        return;
    }
    status_ready(&c->status, s->time_ms);
    /* PROPOSAL only comes with settings, because a script that sees it waits for a trial. */
    if (a->designed)
        commission_say_of_all(c, s, EVENT_PROPOSAL, a->probability, 1);
    else
        commission_say_of_all(c, s, EVENT_NOT_DETERMINED, a->probability,
                              (uint8_t) - (int)a->design_error);
}

void commission_wait_for_job(struct commission *c, struct supervisor *s)
{
    if (!background_take(&c->background, status_events(&c->status), s->time_ms))
        return;
    if (background_task(&c->background) == TASK_FIT)
        take_fit(c, s);
    else
        take_analysis(c, s);
}
