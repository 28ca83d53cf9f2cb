/* commission/trial_plan.c: how large the steps of a trial are and how long they last, on either side of each bound, from a design
 * that is made up. */
#include <string.h>

#include "commission/proposal.h"
#include "commission_space.h"
#include "supervisor_bench.h"

static struct commission c;
static struct config *cf;
static struct analysis *a;
static const struct adoption *t;

#define NEAR(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(2e-6, wanted, (double)(value))

/* top (T1 by reflux) and bottom (T10 by heat) are two pairs, T5 has no loop; outputs at half, limits of 0.2. */
void setUp(void)
{
    bench_start();
    cf = &bench.plan[bench.current].config;
    cf->test.window = 40;
    for (unsigned i = 0; i < CHANNEL_MAX; i++)
        cf->measurement[i].start_up.limit = cf->measurement[i].start_up.critical = 0;
    memset(&c, 0, sizeof c);
    commission_lease(&c);
    a = &c.work->analysis;
    t = &c.adoption;
    c.outputs.channels = commission_channels(cf);
    c.outputs.n = 3;
    c.inputs.n = 2;
    c.outputs.measurement[0] = T5; /* in another order than the pairs */
    c.outputs.measurement[1] = T1;
    c.outputs.measurement[2] = T10;
    c.inputs.input[1].output = 1;
    c.analysis_job.column[1] = 1;
    a->plant.outputs = 3;
    a->plant.inputs = a->pairs.n = 2;
    a->pairs.output[0] = 1;
    a->pairs.output[1] = 2;
    a->pairs.input[1] = 1;
    a->config.step = REAL_C(0.05);
    a->horizon_s = 300;
    for (unsigned k = 0; k < 2; k++) {
        a->predicted[k] = (struct trial_loop){.iae = 9, .peak = REAL_C(0.1), .settled_s = 100};
        a->tried[k].iae = (real_t)(1 + k);
        a->tried[k].left = REAL_C(0.001);
    }
    c.inputs.half_least = 100;
    c.outputs.noise_sd[1] = REAL_C(0.001);
    for (unsigned i = 0; i < 4; i++)
        bench.s.measurement[i].value = N(0.4);
}
void tearDown(void) {}

static void prepare(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_prepare_trial(&c, &bench.s, cf));
}

static double step(void)
{
    prepare();
    return (double)t->loop[0].step;
}

static void measurements_come_in_the_order_of_the_loops_and_the_others_after_them(void)
{
    prepare();
    TEST_ASSERT_EQUAL_UINT8(2, t->n);
    TEST_ASSERT_EQUAL_UINT8(0, t->n_inner);
    TEST_ASSERT_EQUAL_UINT8(3, t->channels);
    static const uint8_t measurements[] = {T1, T10, T5}, outputs[] = {1, 2, 0};
    for (unsigned k = 0; k < 3; k++) {
        TEST_ASSERT_EQUAL_UINT8(measurements[k], t->channel[k].measurement);
        TEST_ASSERT_EQUAL_UINT8(outputs[k], t->channel[k].output);
        NEAR(0.2, t->channel[k].limit);
    }
    NEAR(0.001, t->channel[0].noise_sd);
    TEST_ASSERT_EQUAL_UINT8(TOP, t->loop[0].loop);
    TEST_ASSERT_EQUAL_UINT8(BOTTOM, t->loop[1].loop);
    NEAR(2.0, t->loop[1].predicted.iae);
    NEAR(0.1, t->loop[1].predicted.peak);
    NEAR(0.001, t->loop[1].left);
    NEAR(0.05, t->loop[1].size);
}

static void a_step_lasts_one_and_a_half_times_as_long_as_predicted_but_no_longer_than_foreseen(void)
{
    prepare();
    NEAR(150.0, t->loop[0].duration_s);
    a->predicted[0].settled_s = 199;
    prepare();
    NEAR(298.5, t->loop[0].duration_s);
    a->predicted[0].settled_s = 201;
    prepare();
    NEAR(300.0, t->loop[0].duration_s);
}

static void rest_is_looked_for_over_a_window_that_sees_the_slowest_response(void)
{
    static const uint32_t cases[][3] = {/* half, window set, window */
                                        {100, 40, 100}, {39, 40, 40},     {0, 15, 16},
                                        {17, 15, 17},   {9999, 40, 9999}, {10001, 40, 10000}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        c.inputs.half_least = cases[n][0];
        cf->test.window = (uint16_t)cases[n][1];
        prepare();
        TEST_ASSERT_EQUAL_UINT32(cases[n][0], t->back);
        TEST_ASSERT_EQUAL_UINT32(cases[n][2], t->window);
    }
}

static void a_step_stands_out_of_the_noise_within_the_limit(void)
{
    NEAR(0.05, step()); /* a quarter of the limit */
    c.outputs.noise_sd[1] = REAL_C(0.01);
    NEAR(0.08, step()); /* eight deviations */
    c.outputs.noise_sd[1] = REAL_C(0.02);
    NEAR(0.1, step()); /* half of the limit at most */
    c.outputs.noise_sd[1] = REAL_C(0.001);
    cf->measurement[T1].start_up.limit = 3; /* of 100 */
    NEAR(0.01, step());
    cf->measurement[T1].start_up.limit = 1.8f;
    NEAR(0.009, step());
}

static void a_step_goes_towards_the_middle_of_the_span(void)
{
    bench.s.measurement[T1].value = N(0.5);
    NEAR(0.05, step());
    bench.s.measurement[T1].value = N(0.501);
    NEAR(-0.05, step());
    NEAR(0.05, t->loop[1].step);
}

static void a_step_leaves_a_fifth_of_the_room_of_every_input(void)
{
    for (unsigned l = 0; l < 2; l++) {
        a->tried[0].moved[l] = REAL_C(0.399); /* by 0.05; 0.8 times 0.5 are there */
        NEAR(0.05, step());
        a->tried[0].moved[l] = REAL_C(0.5);
        NEAR(0.04, step());
        a->tried[0].moved[l] = 0;
    }
    a->tried[0].moved[0] = a->tried[0].moved[1] = REAL_C(0.5); /* the one with less room decides */
    bench.s.mv[HEAT].manual = N(0.75);
    NEAR(0.02, step());
    bench.s.mv[REFLUX].manual = N(0.125);
    NEAR(0.01, step());
    bench.s.mv[REFLUX].manual = N(0.0);
    NEAR(1e-4, step()); /* none at all: a step that is none */
    a->tried[0].moved[0] = a->tried[0].moved[1] = REAL_C(0.001);
    bench.s.mv[REFLUX].manual = N(0.5);
    bench.s.mv[HEAT].manual = N(0.5);
    cf->measurement[T1].start_up.limit = 100;
    c.outputs.noise_sd[1] = 1;
    NEAR(0.5, step());
}

static void a_step_leaves_what_no_loop_holds_within_07_of_its_limit(void)
{
    a->plant.element[0][0].gain = 2;
    a->plant.element[0][1].gain = -1;
    a->tried[0].input[0] = REAL_C(0.1);
    a->tried[0].input[1] = REAL_C(0.061); /* 0.139 of 0.14 */
    NEAR(0.05, step());
    a->tried[0].input[1] = REAL_C(0.05);
    NEAR(0.14 * 0.05 / 0.15, step());
    a->tried[0].input[0] = REAL_C(-0.1);
    a->tried[0].input[1] = REAL_C(-0.05);
    NEAR(0.14 * 0.05 / 0.15, step());
    a->plant.element[1][0].gain = a->plant.element[2][1].gain = 100; /* those that are held */
    NEAR(0.14 * 0.05 / 0.15, step());
    cf->measurement[T5].start_up.limit = 10;
    NEAR(0.07 * 0.05 / 0.15, step());
}

/* The raised gain moves the inputs by 1.25 times as much. */
static void probed(void)
{
    cf->test.probe = 1.5f;
    a->config.probe = REAL_C(1.5);
    a->loops.tuning[0].gain = 2;
    a->probe[0].moved = REAL_C(1.25);
}

static void a_probe_shortens_the_step_to_half_or_is_left_out(void)
{
    probed();
    a->tried[0].moved[0] = REAL_C(0.319); /* by 0.05; 0.8 times 0.5 are there */
    NEAR(0.05, step());
    TEST_ASSERT_TRUE(a->probe[0].planned);
    a->tried[0].moved[0] = REAL_C(0.4);
    NEAR(0.04, step());
    TEST_ASSERT_TRUE(a->probe[0].planned);
    a->tried[0].moved[0] = REAL_C(0.001);
    a->probe[0].others = REAL_C(5.5); /* of the limit of 0.2 up to 0.14 */
    NEAR(0.14 / 5.5, step());
    TEST_ASSERT_TRUE(a->probe[0].planned);
    a->probe[0].others = 6;
    NEAR(0.05, step());
    TEST_ASSERT_FALSE(a->probe[0].planned);
}

static void no_probe_is_planned_without_a_prediction_a_setting_or_a_gain_that_a_loop_takes(void)
{
    for (unsigned n = 0; n < 4; n++) {
        probed();
        if (n == 1)
            a->probe[0].moved = 0;
        else if (n == 2)
            cf->test.probe = 0;
        else if (n == 3)
            a->loops.tuning[0].gain = 67;
        prepare();
        TEST_ASSERT_EQUAL(n == 0, a->probe[0].planned);
    }
    TEST_ASSERT_EQUAL_PTR(a->probe, t->probe.predicted);
}

static void other_channels_and_loops_that_are_not_there_have_no_trial(void)
{
    c.outputs.channels++;
    TEST_ASSERT_EQUAL_INT(ERR_CONFLICT, proposal_prepare_trial(&c, &bench.s, cf));
    c.outputs.channels--;
    strcpy(cf->loop[BOTTOM].pv, "T5");
    TEST_ASSERT_EQUAL_INT(ERR_UNKNOWN, proposal_prepare_trial(&c, &bench.s, cf));
}

/* ---- what is written ---- */

static void loops_on_other_outputs_keep_their_places_however_short_their_names(void)
{
    bench.config = *cf;
    strcpy(bench.config.loop[TOP].name, "x");
    strcpy(bench.config.loop[TOP].out, "spare");
    struct config written = bench.config;
    c.outputs.channels = commission_channels(&written);
    c.status.phase = COMMISSION_READY;
    c.status.analysed = a->designed = true;
    a->decoupler = DECOUPLER_NOT_NEEDED;
    a->loops.tuning[0] = (struct tuning){.gain = 3, .ti_s = 50, .action = TUNING_DIRECT};
    a->loops.tuning[1] = (struct tuning){.gain = 4, .ti_s = 60, .td_s = 7};
    a->loops.derivative_filter = 8;
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_write(&c, &written));
    TEST_ASSERT_EQUAL_MEMORY(&bench.config.loop[TOP], &written.loop[TOP], sizeof written.loop[TOP]);
    const struct loop_config *first = &written.loop[1], *second = &written.loop[2];
    TEST_ASSERT_EQUAL_STRING("T1", first->name);
    TEST_ASSERT_EQUAL_STRING("T1", first->pv);
    TEST_ASSERT_EQUAL_STRING("reflux", first->out);
    TEST_ASSERT_EQUAL_STRING("heat", second->out);
    NEAR(3.0, first->own.gain);
    NEAR(50.0, first->own.ti_s);
    NEAR(7.0, second->own.td_s);
    NEAR(8.0, first->own.n);
    NEAR(1.0, first->own.b);
    NEAR(0.0, first->own.out_lo);
    NEAR(1.0, first->own.out_hi);
    TEST_ASSERT_EQUAL_UINT8(LOOP_DIRECT, first->own.action);
    TEST_ASSERT_EQUAL_UINT8(LOOP_REVERSE, second->own.action);
    TEST_ASSERT_EQUAL_UINT8(1, first->sp_track);
    TEST_ASSERT_EQUAL_UINT8(1, first->divisor);
    TEST_ASSERT_EQUAL_UINT8(0, first->decouple);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(measurements_come_in_the_order_of_the_loops_and_the_others_after_them);
    RUN_TEST(a_step_lasts_one_and_a_half_times_as_long_as_predicted_but_no_longer_than_foreseen);
    RUN_TEST(rest_is_looked_for_over_a_window_that_sees_the_slowest_response);
    RUN_TEST(a_step_stands_out_of_the_noise_within_the_limit);
    RUN_TEST(a_step_goes_towards_the_middle_of_the_span);
    RUN_TEST(a_step_leaves_a_fifth_of_the_room_of_every_input);
    RUN_TEST(a_step_leaves_what_no_loop_holds_within_07_of_its_limit);
    RUN_TEST(a_probe_shortens_the_step_to_half_or_is_left_out);
    RUN_TEST(no_probe_is_planned_without_a_prediction_a_setting_or_a_gain_that_a_loop_takes);
    RUN_TEST(other_channels_and_loops_that_are_not_there_have_no_trial);
    RUN_TEST(loops_on_other_outputs_keep_their_places_however_short_their_names);
    return UNITY_END();
}
