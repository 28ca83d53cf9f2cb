#include "commission/tests.h"

#include "commission/background.h"
#include "commission/blocking.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/direction.h"
#include "commission/experiment.h"
#include "commission/model.h"
#include "commission/next_test.h"
#include "commission/requests.h"
#include "commission/start_stop.h"
#include "commission/status.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"

void commission_start_input(struct commission *c, struct supervisor *s)
{
    struct experiment_config x;
    next_test_config(c, s, &x);
    outputs_age_origin(&c->outputs, &c->origin, s);
    status_enter(&c->status, COMMISSION_TESTING, s->time_ms);
    enum err err = experiment_begin(&c->work->experiment, &x);
    if (err)
        commission_fail(c, s, (real_t)err);
}

void commission_begin(struct commission *c, struct supervisor *s)
{
    const char *what, *wanted;
    if (commission_may_begin(s, &what, &wanted) != ERR_OK) {
        commission_say(c, s, EVENT_REQUEST_REFUSED, what, 0.0f);
        return;
    }
    commission_forget(c, s);
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (commission_measurement_is_tested(s, i))
            outputs_add(&c->outputs, i);
    for (uint8_t j = 0; j < CHANNEL_MAX; j++)
        if (commission_input_is_tested(s, j))
            inputs_add(&c->inputs, j, commission_test_base(s, j));
    uint8_t turn = 0, inputs = inputs_count(&c->inputs);
    for (unsigned critical = 2; critical-- > 0;)
        for (uint8_t k = 0; k < inputs; k++)
            if (s->plan->config.mv[inputs_get(&c->inputs, k)->output].start_up.critical == critical)
                inputs_line_up(&c->inputs, turn++, k);
    commission_say(c, s, EVENT_COMMISSION_BEGUN, NULL, (float)inputs);
    commission_start_input(c, s);
}

/* The main loop gets two seconds for a fit. */
static void ask_for_fit(struct commission *c, const struct supervisor *s, enum background_task task)
{
    background_ask(&c->background, task, 1u + commission_samples(s, REAL_C(2.0)));
}

static void end_test(struct commission *c, struct supervisor *s)
{
    const struct experiment *x = &c->work->experiment;
    struct test_result result = {.amplitude = experiment_amplitude(x),
                                 .half_s = experiment_half_s(x),
                                 .worst = limits_worst(experiment_limits(x)),
                                 .took_s = status_phase_s(&c->status, s->time_ms),
                                 .cut = experiment_is_cut(x),
                                 .small = experiment_is_small(x)};
    inputs_note_test(&c->inputs, &result);
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        outputs_set_noise(&c->outputs, j, experiment_before(x, j)->noise_sd);
        sensor_watch_note(&c->work->sensor[j]);
    }
    commission_say_of_input(c, s, EVENT_TEST_DONE, result.half_s, inputs_round(&c->inputs));
    status_enter(&c->status, COMMISSION_FITTING, s->time_ms);
    model_begin_fit(c);
    ask_for_fit(c, s, TASK_FIT);
}

void commission_test(struct commission *c, struct supervisor *s)
{
    struct experiment *x = &c->work->experiment;
    real_t y[CHANNEL_MAX];
    enum experiment_phase before = experiment_phase(x);
    enum err err = ERR_OK;
    uint32_t missed = outputs_see_sample(&c->outputs, s);
    if (experiment_has_begun(x) && missed > MISSED_MOST + 1u) {
        commission_end(c, s, REASON_SAMPLES, NULL, (real_t)(missed - 1u));
        return;
    }
    for (; experiment_has_begun(x) && missed > 1 && !err; missed--)
        err = experiment_missed(x);
    outputs_read(&c->outputs, s, y);
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        sensor_watch_step(&c->work->sensor[j], y[j]);
        experiment_know_sensor(x, j, sensor_watch_coarse(&c->work->sensor[j]),
                               sensor_watch_noted(&c->work->sensor[j]));
    }
    if (background_take(&c->background, status_events(&c->status), s->time_ms))
        experiment_take_interim_fit(x);
    if (!err)
        err = experiment_step(x, y);
    if (err) {
        commission_fail(c, s, REAL_C(0.0));
        return;
    }
    if (inputs_is_direction(&c->inputs))
        direction_excite(c, s, experiment_level(x));
    else
        supervisor_excite(s, inputs_under_test(&c->inputs)->output,
                          num_from_float(experiment_level(x)));
    if (experiment_wants_interim_fit(x) && !background_is_asked(&c->background) &&
        requests_pending(&c->requests) == COMMISSION_ASK_NONE)
        ask_for_fit(c, s, TASK_INTERIM_FIT);
    if (before == EXPERIMENT_REST && experiment_phase(x) == EXPERIMENT_UP)
        commission_say_of_input(c, s, EVENT_TEST_STEP, experiment_amplitude(x),
                                inputs_round(&c->inputs));
    if (before == EXPERIMENT_UP && experiment_phase(x) > EXPERIMENT_UP && experiment_is_cut(x)) {
        inputs_note_cut(&c->inputs, experiment_culprit(x), experiment_predicted(x));
        commission_say(c, s, EVENT_TEST_CUT, outputs_name(&c->outputs, s, experiment_culprit(x)),
                       experiment_predicted(x));
    }
    if (experiment_phase(x) == EXPERIMENT_FAILED) {
        static const enum commission_reason reason[] = {[EXPERIMENT_FINE] = REASON_NUMBERS,
                                                        [EXPERIMENT_RESTLESS] = REASON_RESTLESS,
                                                        [EXPERIMENT_LIMIT] = REASON_LIMIT,
                                                        [EXPERIMENT_AWAY] = REASON_AWAY,
                                                        [EXPERIMENT_LEFT] = REASON_LEFT};
        inputs_note_worst(&c->inputs, limits_worst(experiment_limits(x)));
        commission_end_by_output(c, s, reason[experiment_failure(x)], experiment_culprit(x),
                                 limits_worst(experiment_limits(x)));
    } else if (experiment_phase(x) == EXPERIMENT_DONE) {
        end_test(c, s);
    }
}
