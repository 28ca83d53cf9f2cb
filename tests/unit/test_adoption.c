/* commission/adoption.[ch]: accepted loops on trial, on the supervisor, with a plant of two by two that may be another than
 * the one predicted with. In the number format of the preset. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commission/adoption.h"
#include "commission/adoption_state.h"
#include "commission/by_relay.h"
#include "commission/origin_state.h"
#include "csv.h"
#include "fopdt_plant.h"
#include "step_records.h"
#include "supervisor_bench.h"

#define SEED 20240714u

static struct adoption a;
static struct steady rest;
static struct origin operating;
static struct fopdt_plant element[2][2];
static struct random_source noise;
static double noise_sd, load;  /* fractions of span */
static double drift[2], third; /* ... a sample, of the measurements; of T5, which no loop holds */
static unsigned turn_at, now;  /* samples: the drift turns round there, if it is not 0 */
static double drifted[2];
static double horizon_s; /* of a step, at most */

/* The plant as it is predicted with. */
static const double gains[2][2] = {{0.8, 0.2}, {0.15, 1.0}};
#define LAG_S  60.0
#define DEAD_S 10

/* Sizes of a step and of the tests before it: longest step, samples of rest, samples until a response is over. */
#define HORIZON_S 350
#define WINDOW    96
#define BACK      250

static void loops(void)
{
    static const char *const pairs[] = {"loop1.action", "reverse", "loop1.gain", "2.5",
                                        "loop1.ti",     "60",      "loop2.gain", "2",
                                        "loop2.ti",     "60",      NULL};
    put_all(pairs);
}

static void predict(void)
{
    static struct interact_plant plant;
    static struct loops proposed;
    static struct trial trial;
    memset(&plant, 0, sizeof plant);
    memset(&proposed, 0, sizeof proposed);
    plant.outputs = plant.inputs = 2;
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++)
            plant.element[j][i] = (struct fopdt){.gain = (real_t)gains[j][i],
                                                 .time_constant_s = (real_t)LAG_S,
                                                 .dead_time_s = DEAD_S};
    proposed.interval_s = 1;
    proposed.derivative_filter = 8;
    proposed.pairs.n = 2;
    for (uint8_t k = 0; k < 2; k++) {
        proposed.pairs.output[k] = proposed.pairs.input[k] = k;
        proposed.tuning[k] =
            (struct tuning){.gain = k ? 2 : REAL_C(2.5), .ti_s = 60, .action = TUNING_REVERSE};
    }
    memset(&a, 0, sizeof a);
    a.n = 2;
    a.channels = 3;
    a.channel[2] = (struct adoption_channel){.measurement = T5, .output = 2, .limit = REAL_C(0.05)};
    a.window = WINDOW;
    operating = (struct origin){0};
    a.back = BACK;
    for (uint8_t k = 0; k < 2; k++) {
        struct trial_config c = {
            .loop = k, .size = REAL_C(0.05), .setpoint_weight = 1, .mark_s = (real_t)horizon_s};
        TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&trial, &plant, &proposed, &c));
        while (trial_step(&trial) == ERR_BUSY)
            ;
        TEST_ASSERT_TRUE(trial.bounded);
        a.loop[k] = (struct adoption_loop){.loop = k,
                                           .step = k ? -REAL_C(0.04) : REAL_C(0.03),
                                           .predicted = trial.loop[k],
                                           .left = trial.mark.left,
                                           .size = REAL_C(0.05)};
        a.loop[k].predicted.iae = trial.mark.iae;
        a.loop[k].duration_s = (real_t)fmin(1.5 * (double)trial.loop[k].settled_s, horizon_s);
        a.channel[k] = (struct adoption_channel){
            .measurement = k, .output = k, .noise_sd = (real_t)noise_sd, .limit = REAL_C(0.1)};
    }
}

/* times: of every gain, slower: of every lag. */
static void plant_is(double times, double slower)
{
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++)
            fopdt_plant_init(&element[j][i], times * gains[j][i], slower * LAG_S, DEAD_S, 1.0, 0.5,
                             0.0);
}

static void measure(void)
{
    for (unsigned j = 0; j < 2; j++) {
        drifted[j] += turn_at && now >= turn_at ? -drift[j] : drift[j];
        double y = 0.45 + element[j][0].y + element[j][1].y + (j == 0 ? load : 0.0) + drifted[j];
        if (noise_sd > 0.0)
            y += noise_sd * normal(&noise);
        reading(j, 60.0 + 100.0 * y);
    }
    reading(T5, 60.0 + 100.0 * (0.5 + third * (element[0][0].y + element[0][1].y)));
    now++;
}

static void go_on(void)
{
    supervisor_control(&bench.s);
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++)
            fopdt_plant_step(&element[j][i], sent(i));
    bench_events();
}

/* At rest with both outputs at half, in manual. */
static void begin(double times, double slower)
{
    bench_start_with(loops);
    plant_is(times, slower);
    out(TOP, 5);
    out(BOTTOM, 1);
    for (int n = 0; n < 5; n++) {
        measure();
        validate();
        go_on();
    }
    predict();
    adoption_hold(&a, &bench.s);
    TEST_ASSERT_EQUAL_INT(ERR_OK, adoption_begin(&a, &bench.s, &operating, &rest));
}

static enum adoption_result one_tick(void)
{
    measure();
    validate();
    enum adoption_result r = adoption_tick(&a, &bench.s);
    go_on();
    return r;
}

static enum adoption_result run(void)
{
    enum adoption_result r = ADOPTION_RUNNING;
    for (unsigned n = 0; r == ADOPTION_RUNNING && n < 100000; n++)
        r = one_tick();
    return r;
}

static void ticks_on_trial(unsigned n)
{
    while (!happened(EVENT_SETPOINT, "top"))
        TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, one_tick());
    while (n--)
        TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, one_tick());
}

void setUp(void)
{
    noise.state = SEED;
    noise_sd = load = third = 0.0;
    drift[0] = drift[1] = drifted[0] = drifted[1] = 0.0;
    turn_at = now = 0;
    horizon_s = HORIZON_S;
}
void tearDown(void) {}

static void the_plant_that_was_predicted_passes_and_is_where_it_was(void)
{
    begin(1, 1);
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, a.result);
    for (unsigned k = 0; k < 2; k++) {
        const struct adoption_loop *l = &a.loop[k];
        double scale = fabs((double)l->step) / (double)l->size;
        TEST_ASSERT_DOUBLE_WITHIN(0.15, 1.0, (double)l->iae / (scale * (double)l->predicted.iae));
        TEST_ASSERT_DOUBLE_WITHIN(0.05, (double)l->predicted.peak, (double)l->peak);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.45, setpoint_of(k));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.5, sent(k));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, (double)l->test_base);
        TEST_ASSERT_EQUAL_INT(LOOP_AUTO, bench.s.loop[k].mode);
    }
}

static void noise_alone_fails_nothing(void)
{
    noise_sd = 0.003;
    for (unsigned seed = 0; seed < 20; seed++) {
        noise.state = SEED + seed;
        begin(1, 1);
        TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    }
}

static void a_plant_a_fifth_stronger_or_weaker_still_passes(void)
{
    for (double times = 0.8; times < 1.3; times += 0.4) {
        begin(times, 1);
        TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    }
}

static void a_plant_four_times_as_strong_does_not(void)
{
    begin(4, 1);
    enum adoption_result r = run();
    TEST_ASSERT_TRUE(r == ADOPTION_OVERSHOOT || r == ADOPTION_RESTLESS || r == ADOPTION_PAST_LIMIT);
    TEST_ASSERT_EQUAL_INT(r, a.result);
}

static void a_plant_that_has_turned_round_is_stopped_at_a_limit(void)
{
    begin(-1, 1);
    TEST_ASSERT_EQUAL_INT(ADOPTION_PAST_LIMIT, run());
}

static void a_plant_a_tenth_as_strong_takes_too_long(void)
{
    begin(0.1, 1);
    enum adoption_result r = run();
    TEST_ASSERT_TRUE(r == ADOPTION_SLOW || r == ADOPTION_RESTLESS);
}

static void a_load_that_carries_it_past_its_limit_ends_it(void)
{
    begin(1, 1);
    ticks_on_trial(20);
    load = 0.25;
    TEST_ASSERT_EQUAL_INT(ADOPTION_PAST_LIMIT, run());
    TEST_ASSERT_EQUAL_UINT8(0, a.culprit);
}

static void a_small_load_in_the_middle_is_outlived(void)
{
    begin(1, 1);
    ticks_on_trial(5);
    load = 0.005;
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
}

static void a_loop_taken_to_manual_ends_it(void)
{
    begin(1, 1);
    ticks_on_trial(20);
    mode(BOTTOM, LOOP_MANUAL);
    TEST_ASSERT_EQUAL_INT(ADOPTION_HAND, run());
    TEST_ASSERT_EQUAL_UINT8(1, a.culprit);
}

static void a_loop_that_does_not_go_to_automatic_ends_it(void)
{
    begin(1, 1);
    while (bench.s.loop[BOTTOM].mode != LOOP_AUTO)
        TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, one_tick());
    bench.s.loop[TOP].mode = LOOP_MANUAL; /* as if it had been refused */
    TEST_ASSERT_EQUAL_INT(ADOPTION_HAND, run());
    TEST_ASSERT_EQUAL_UINT8(0, a.culprit);
}

static void a_loop_put_into_automatic_at_rest_ends_it(void)
{
    begin(1, 1);
    for (unsigned n = 0; n < 10; n++)
        TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, one_tick());
    mode(BOTTOM, LOOP_AUTO);
    TEST_ASSERT_EQUAL_INT(ADOPTION_HAND, run());
    TEST_ASSERT_EQUAL_UINT8(1, a.culprit);
}

/* 45 s are no time for it to come to rest: a fifth of the step and more is left, and less than that is asked of no other. */
static void what_is_predicted_to_be_left_at_the_end_of_a_step_is_no_unrest(void)
{
    horizon_s = 45;
    begin(1, 1);
    for (unsigned k = 0; k < 2; k++)
        TEST_ASSERT_TRUE(fabs((double)a.loop[k].left) > 0.2 * 0.05);
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    begin(1, 1);
    a.loop[0].left = a.loop[1].left = 0;
    TEST_ASSERT_EQUAL_INT(ADOPTION_RESTLESS, run());
}

static void one_loop_after_the_other_is_stepped(void)
{
    unsigned first = 0, second = 0;
    begin(1, 1);
    for (enum adoption_result r = ADOPTION_RUNNING; r == ADOPTION_RUNNING;) {
        r = one_tick();
        bool away0 = fabs(setpoint_of(TOP) - 0.45) > 0.01,
             away1 = fabs(setpoint_of(BOTTOM) - 0.45) > 0.01;
        TEST_ASSERT_FALSE(away0 && away1);
        TEST_ASSERT_FALSE(away0 && second > 0);
        first += away0;
        second += away1;
    }
    TEST_ASSERT_TRUE(first > 20 && second > 20);
}

static void a_drift_takes_the_setpoints_with_it_and_all_inputs_stay_where_they_were(void)
{
    noise_sd = 0.001;
    for (unsigned seed = 0; seed < 20; seed++) {
        setUp();
        noise.state = SEED + seed;
        noise_sd = 0.001;
        drift[0] = 2e-4; /* 12 % of span and more until the end, where the limit is 10 % */
        drift[1] = -2e-4;
        begin(1, 1);
        TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
        TEST_ASSERT_TRUE(a.drifting);
        for (unsigned k = 0; k < 2; k++) {
            TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.5, sent(k));
            TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.45 + drifted[k], setpoint_of(k));
            TEST_ASSERT_TRUE(fabs(drifted[k]) > 0.12);
        }
    }
}

static void what_the_tests_have_left_comes_off_the_limits(void)
{
    begin(1, 1);
    operating.fixed = true;
    for (unsigned k = 0; k < 3; k++)
        operating.channel[k].level = REAL_C(0.45);
    operating.channel[1].left = REAL_C(-0.07); /* of 0.1; its step is 0.04 */
    TEST_ASSERT_EQUAL_INT(ADOPTION_LEFT, run());
    TEST_ASSERT_EQUAL_UINT8(1, a.culprit);
    begin(1, 1);
    operating.fixed = true;
    operating.channel[1].level = REAL_C(0.45);
    operating.channel[1].left = REAL_C(-0.045);
    operating.channel[0].level = REAL_C(0.45);
    operating.channel[2].level = REAL_C(0.5);
    a.loop[1].step = REAL_C(-0.06); /* within 0.1, and not within what is left of it */
    TEST_ASSERT_EQUAL_INT(ADOPTION_PAST_LIMIT, run());
    TEST_ASSERT_EQUAL_UINT8(1, a.culprit);
}

static void a_drift_that_turns_in_the_middle_of_a_step_has_it_repeated(void)
{
    drift[0] = 2.5e-4;
    drift[1] = -2.5e-4;
    noise_sd = 0.001;
    begin(1, 1);
    ticks_on_trial(1);
    turn_at = now + 5;
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    TEST_ASSERT_TRUE(a.repeats >= 1);
}

static void a_drift_saves_no_loop_that_is_unstable(void)
{
    for (unsigned seed = 0; seed < 20; seed++) {
        setUp();
        noise.state = SEED + seed;
        noise_sd = 0.001;
        drift[0] = 2e-4;
        drift[1] = -2e-4;
        begin(seed % 2 ? 4 : -1, 1);
        enum adoption_result r = run();
        TEST_ASSERT_TRUE(r != ADOPTION_PASSED && r != ADOPTION_RUNNING);
    }
}

/* 0.0004 in the 100 s of a step: more than a twentieth of a step of 0.005, and less than of those there are. */
static void a_drift_matters_beside_the_smallest_step(void)
{
    for (unsigned k = 0; k < 3; k++) {
        setUp();
        drift[0] = 4e-6;
        begin(1, 1);
        if (k < 2)
            a.loop[k].step = REAL_C(0.005);
        while (a.stage == 0)
            TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, one_tick());
        TEST_ASSERT_EQUAL(k < 2, a.channel[0].line.drifts);
        TEST_ASSERT_EQUAL(k < 2, a.drifting);
    }
}

static void a_trial_begins_with_nothing_found_of_any_loop(void)
{
    begin(1, 1);
    for (unsigned k = 0; k < 2; k++)
        a.loop[k].iae = a.loop[k].peak = 9;
    a.turn = a.culprit = a.repeats = 1;
    a.drifting = a.placed = true;
    a.since = 77;
    a.result = a.doubt = ADOPTION_SLOW;
    TEST_ASSERT_EQUAL_INT(ERR_OK, adoption_begin(&a, &bench.s, &operating, &rest));
    for (unsigned k = 0; k < 2; k++) {
        TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)a.loop[k].iae);
        TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)a.loop[k].peak);
    }
    TEST_ASSERT_EQUAL_UINT8(0, a.turn + a.culprit + a.repeats);
    TEST_ASSERT_FALSE(a.drifting || a.placed);
    TEST_ASSERT_EQUAL_UINT32(0, a.since);
    TEST_ASSERT_EQUAL_UINT8(3, a.patience);
    TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, a.result);
    TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, a.doubt);
    TEST_ASSERT_EQUAL_UINT32(WINDOW, a.stage_ticks);
}

static void a_step_lasts_twenty_ticks_at_least_and_a_million_at_most(void)
{
    static const struct {
        double lasts;
        uint32_t ticks;
    } cases[] = {{15, 20}, {19.9, 20}, {25.5, 25}, {999999, 999999}, {2e6, 1000000}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        begin(1, 1);
        a.loop[0].duration_s = (real_t)cases[n].lasts;
        a.loop[1].duration_s = 20;
        unsigned settles = 0;
        while (a.stage != 2) { /* the step */
            settles += a.stage == 1;
            TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, one_tick());
            if (settles > 1)
                a.ticks = a.stage_ticks;
        }
        TEST_ASSERT_EQUAL_UINT32(cases[n].ticks, a.stage_ticks);
    }
}

static void an_output_that_stands_at_its_limits_is_no_good_sign(void)
{
    begin(1, 1);
    ticks_on_trial(1);
    bench.plan[bench.current].config.mv[0].max = 5.1f; /* it was thought to open to 10 */
    TEST_ASSERT_EQUAL_INT(ADOPTION_BLOCKED, run());
}

static void a_measurement_that_no_loop_holds_has_its_limit_too(void)
{
    third = 3.0;
    begin(1, 1);
    TEST_ASSERT_EQUAL_INT(ADOPTION_PAST_LIMIT, run());
    TEST_ASSERT_EQUAL_UINT8(2, a.culprit);
    TEST_ASSERT_EQUAL_UINT8(T5, a.channel[a.culprit].measurement);
}

static void a_setpoint_moved_by_hand_ends_it(void)
{
    begin(1, 1);
    ticks_on_trial(20);
    setpoint(BOTTOM, 110);
    TEST_ASSERT_EQUAL_INT(ADOPTION_HAND, run());
    TEST_ASSERT_EQUAL_UINT8(1, a.culprit);
}

static void an_output_moved_by_hand_at_rest_ends_it(void)
{
    begin(1, 1);
    for (unsigned n = 0; n < 10; n++)
        TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, one_tick());
    out(BOTTOM, 1.2);
    TEST_ASSERT_EQUAL_INT(ADOPTION_HAND, run());
    TEST_ASSERT_EQUAL_UINT8(1, a.culprit);
}

static void as_many_channels_as_there_are_are_taken_and_no_more(void)
{
    begin(1, 1);
    a.channels = CHANNEL_MAX + 1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, adoption_begin(&a, &bench.s, &operating, &rest));
    a.channels = 2;
    a.window = STEADY_BLOCKS - 1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, adoption_begin(&a, &bench.s, &operating, &rest));
}

/* reference/relay_family.csv: what settings by relay do to lags with dead time of 0.02 to 2 of them. */
static void the_figures_for_settings_by_relay_let_every_process_of_their_family_pass(void)
{
    FILE *f = csv_open("reference/relay_family.csv");
    double row[6];
    int rows = 0;
    for (; csv_row(f, row, 6); rows++) {
        TEST_ASSERT_TRUE(row[1] <= (double)(ADOPTION_IAE * BY_RELAY_IAE));
        TEST_ASSERT_TRUE(row[2] <= (double)(ADOPTION_PEAK + BY_RELAY_PEAK));
        TEST_ASSERT_TRUE(row[4] <= (double)BY_RELAY_MOVES);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 12.0, (double)(ADOPTION_DURATION * BY_RELAY_SETTLES));
        TEST_ASSERT_TRUE(row[5] <= 0.15); /* over the last quarter of that */
    }
    fclose(f);
    TEST_ASSERT_EQUAL_INT(7, rows);
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    RUN_TEST(the_plant_that_was_predicted_passes_and_is_where_it_was);
    RUN_TEST(noise_alone_fails_nothing);
    RUN_TEST(the_figures_for_settings_by_relay_let_every_process_of_their_family_pass);
    RUN_TEST(a_plant_a_fifth_stronger_or_weaker_still_passes);
    RUN_TEST(a_plant_four_times_as_strong_does_not);
    RUN_TEST(a_plant_that_has_turned_round_is_stopped_at_a_limit);
    RUN_TEST(a_plant_a_tenth_as_strong_takes_too_long);
    RUN_TEST(a_load_that_carries_it_past_its_limit_ends_it);
    RUN_TEST(a_small_load_in_the_middle_is_outlived);
    RUN_TEST(a_loop_taken_to_manual_ends_it);
    RUN_TEST(a_loop_that_does_not_go_to_automatic_ends_it);
    RUN_TEST(a_loop_put_into_automatic_at_rest_ends_it);
    RUN_TEST(what_is_predicted_to_be_left_at_the_end_of_a_step_is_no_unrest);
    RUN_TEST(one_loop_after_the_other_is_stepped);
    RUN_TEST(a_drift_takes_the_setpoints_with_it_and_all_inputs_stay_where_they_were);
    RUN_TEST(what_the_tests_have_left_comes_off_the_limits);
    RUN_TEST(a_drift_that_turns_in_the_middle_of_a_step_has_it_repeated);
    RUN_TEST(a_drift_saves_no_loop_that_is_unstable);
    RUN_TEST(a_drift_matters_beside_the_smallest_step);
    RUN_TEST(a_trial_begins_with_nothing_found_of_any_loop);
    RUN_TEST(a_step_lasts_twenty_ticks_at_least_and_a_million_at_most);
    RUN_TEST(an_output_that_stands_at_its_limits_is_no_good_sign);
    RUN_TEST(a_measurement_that_no_loop_holds_has_its_limit_too);
    RUN_TEST(a_setpoint_moved_by_hand_ends_it);
    RUN_TEST(an_output_moved_by_hand_at_rest_ends_it);
    RUN_TEST(as_many_channels_as_there_are_are_taken_and_no_more);
    return UNITY_END();
}
