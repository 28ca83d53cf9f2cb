/* Supervision of a self-tuner, step by step: what has been seen and what the regressions result to are made up. */
#include <math.h>
#include <string.h>

#include "kinds/gmv/gmv_supervise_state.h"
#include "unity.h"

#define TUNE  20u
#define CHECK 10u
#define REACH 5u

static struct gmv_supervise s;
static struct gmv_supervise_config config;
static struct gmv_observation seen;
static struct gmv_result result;

void setUp(void)
{
    config = (struct gmv_supervise_config){.on = true,
                                           .loops = 1,
                                           .tries = 3,
                                           .tune_steps = TUNE,
                                           .check_steps = CHECK,
                                           .day_steps = 1000,
                                           .reach = REACH,
                                           .excite = 3,
                                           .gain_least = 0.001f,
                                           .quiet = 0.2f,
                                           .burst = 25,
                                           .better = 0.05f};
    seen = (struct gmv_observation){.acting = 1, .good = 1, .setpoint = {0.5f, 0.5f}};
    result = (struct gmv_result){.complete = 3,
                                 .error = {0.01f, 0.01f},
                                 .standstill = {0.02f, 0.02f},
                                 .information = {0.1f, 0.1f},
                                 .forgetting = {0.99f, 0.99f},
                                 .parameters = {3, 3},
                                 .gain = {0.1f, 0.1f},
                                 .estimated = {0.1f, 0.1f},
                                 .excited = 3,
                                 .outcome = {.times = 1, .decay = 0.9f}};
    gmv_supervise_init(&s, &config);
}

void tearDown(void) {}

/* A step in which the MV moves. The trial that was asked for is over in the next step. */
static uint8_t step(void)
{
    static bool asked;
    seen.move[0] = seen.move[0] > 0 ? -0.001f : 0.001f;
    seen.move[1] = seen.move[0];
    result.trial_done = asked;
    (void)gmv_supervise_look(&s, &seen);
    uint8_t wish = gmv_supervise_judge(&s, &seen, &result);
    asked = wish & GMV_WISH_TRIAL;
    return wish;
}

static uint8_t steps(unsigned n)
{
    uint8_t wish = 0;
    while (n--)
        wish = (uint8_t)(wish | step());
    return wish;
}

static void self_tunes(void)
{
    (void)steps(TUNE + CHECK + 5);
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

/* ---- adoption ---- */

static void a_model_is_tried_after_the_time_of_tuning_and_on_data_that_came_later(void)
{
    TEST_ASSERT_EQUAL_HEX8(0, steps(TUNE - 1));
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_CANDIDATE | GMV_WISH_TRIAL, step());
    TEST_ASSERT_EQUAL_HEX8(0, steps(CHECK - 1));
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_LAW | GMV_WISH_PROPOSE, step());
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

static void the_law_does_not_take_over_in_the_midst_of_an_answer_to_a_setpoint(void)
{
    (void)steps(TUNE + CHECK - 2);
    seen.setpoint[0] = 0.6f;
    (void)steps(REACH);
    TEST_ASSERT_EQUAL(GMV_TUNING, s.status.state);
    (void)steps(2);
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

static void a_setpoint_that_never_rests_is_waited_for_as_long_as_a_test(void)
{
    for (unsigned k = 0; k < TUNE + 2 * CHECK - 1; k++) {
        seen.setpoint[0] = k % 2 ? 0.5f : 0.6f;
        (void)step();
        TEST_ASSERT_EQUAL(GMV_TUNING, s.status.state);
    }
    (void)steps(2);
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

static void without_excitation_it_goes_on_tuning(void)
{
    result.excited = 0;
    TEST_ASSERT_EQUAL_HEX8(0, steps(10 * TUNE));
    result.excited = 1;
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_CANDIDATE | GMV_WISH_TRIAL, step());
}

static void refused_for(enum gmv_refusal why)
{
    uint8_t wish = steps(TUNE + CHECK);
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_CANDIDATE | GMV_WISH_TRIAL | GMV_WISH_REFUSED, wish);
    TEST_ASSERT_EQUAL(GMV_TUNING, s.status.state);
    TEST_ASSERT_EQUAL(why, s.status.refusal);
}

static void what_predicts_no_better_than_as_it_is_is_not_adopted(void)
{
    result.error[0] = 0.021f;
    refused_for(GMV_REFUSED_PREDICTION);
}

static void a_gain_of_the_wrong_sign_is_not_adopted(void)
{
    result.gain[0] = -0.1f;
    refused_for(GMV_REFUSED_GAIN);
}

static void a_gain_that_is_next_to_nothing_is_not_adopted(void)
{
    result.gain[0] = 0.0005f;
    refused_for(GMV_REFUSED_GAIN);
}

static void a_loop_that_would_not_die_away_is_not_adopted(void)
{
    result.outcome.decay = 1.01f;
    refused_for(GMV_REFUSED_POLES);
}

static void a_law_that_saves_less_than_it_must_of_the_pis_error_is_not_adopted(void)
{
    result.outcome.ratio = 0.951f;
    refused_for(GMV_REFUSED_PI);
    result.outcome.ratio = 0.949f;
    (void)steps(CHECK + 2);
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

static void a_law_that_would_shake_the_mv_for_nothing_at_rest_is_not_adopted(void)
{
    result.outcome.shakes = true;
    refused_for(GMV_REFUSED_PI);
    result.outcome.shakes = false;
    (void)steps(CHECK + 2);
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

static void numbers_that_are_none_are_not_adopted(void)
{
    result.error[0] = NAN;
    refused_for(GMV_REFUSED_PREDICTION);
    setUp();
    result.gain[0] = NAN;
    refused_for(GMV_REFUSED_GAIN);
    setUp();
    result.outcome.decay = NAN;
    refused_for(GMV_REFUSED_POLES);
    setUp();
    result.outcome.ratio = NAN;
    refused_for(GMV_REFUSED_PI);
}

static void without_a_trial_nothing_is_adopted_however_long_the_test(void)
{
    for (unsigned k = 0; k < TUNE + 3 * CHECK; k++) {
        seen.move[0] = seen.move[0] > 0 ? -0.001f : 0.001f;
        (void)gmv_supervise_look(&s, &seen);
        (void)gmv_supervise_judge(&s, &seen, &result);
        TEST_ASSERT_EQUAL(GMV_TUNING, s.status.state);
    }
    result.trial_done = true;
    (void)gmv_supervise_judge(&s, &seen, &result);
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

static void after_a_refusal_it_is_tried_again_and_adopted_when_it_passes(void)
{
    result.error[0] = 0.03f;
    refused_for(GMV_REFUSED_PREDICTION);
    result.error[0] = 0.01f;
    TEST_ASSERT_TRUE(steps(CHECK + 2) & GMV_WISH_LAW);
}

static void a_loop_that_joins_during_the_test_begins_it_anew(void)
{
    config.loops = 2;
    gmv_supervise_init(&s, &config);
    seen.good = 3;
    (void)steps(TUNE + CHECK - 1);
    TEST_ASSERT_TRUE(s.status.testing);
    seen.acting = 3;
    TEST_ASSERT_EQUAL_HEX8(0, step());
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_CANDIDATE | GMV_WISH_TRIAL, step());
    TEST_ASSERT_EQUAL_HEX8(0, steps(CHECK - 1));
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_LAW | GMV_WISH_PROPOSE, step());
    TEST_ASSERT_EQUAL_HEX8(3, s.tested_loops);
}

static void spoilt_samples_are_no_part_of_the_test(void)
{
    (void)steps(TUNE);
    seen.good = 0;
    result.error[0] = 1;
    (void)step();
    seen.good = 1;
    (void)steps(REACH); /* the reading is among the data for so long */
    result.error[0] = 0.01f;
    TEST_ASSERT_TRUE(steps(CHECK) & GMV_WISH_LAW);
}

static void with_ask_it_waits_for_the_proposal(void)
{
    config.ask = true;
    gmv_supervise_init(&s, &config);
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_CANDIDATE | GMV_WISH_TRIAL | GMV_WISH_PROPOSE,
                           steps(TUNE + CHECK));
    TEST_ASSERT_EQUAL(GMV_WAITING, s.status.state);
    TEST_ASSERT_EQUAL_HEX8(0, steps(50));
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_LAW, gmv_supervise_accepted(&s, true));
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

static void a_proposal_that_is_rejected_leads_back_to_tuning(void)
{
    config.ask = true;
    gmv_supervise_init(&s, &config);
    (void)steps(TUNE + CHECK);
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_REFUSED, gmv_supervise_accepted(&s, false));
    TEST_ASSERT_EQUAL(GMV_TUNING, s.status.state);
    TEST_ASSERT_EQUAL(GMV_REFUSED_BY_HAND, s.status.refusal);
    TEST_ASSERT_EQUAL_HEX8(0, steps(TUNE - 1));
}

static void bare_it_adopts_after_the_time_of_tuning_whatever_comes(void)
{
    config.on = false;
    result.gain[0] = -1;
    result.error[0] = 1;
    result.excited = 0;
    gmv_supervise_init(&s, &config);
    TEST_ASSERT_EQUAL_HEX8(0, steps(TUNE - 1));
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_LAW | GMV_WISH_CANDIDATE, step());
    TEST_ASSERT_EQUAL_HEX8(0, steps(2000));
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

static void asked_for_it_adopts_what_there_is(void)
{
    s.adopt_asked = true;
    TEST_ASSERT_TRUE(step() & GMV_WISH_LAW);
}

/* ---- ways back ---- */

static void given_up_for(enum gmv_alarm why, uint8_t wish)
{
    TEST_ASSERT_TRUE(wish & GMV_WISH_PI);
    TEST_ASSERT_TRUE(wish & GMV_WISH_FORGET);
    TEST_ASSERT_EQUAL(GMV_TUNING, s.status.state);
    TEST_ASSERT_EQUAL_HEX8(why, s.status.alarms);
}

static void a_sign_that_turns_is_given_up_in_the_same_step(void)
{
    self_tunes();
    result.gain[0] = -0.002f;
    given_up_for(GMV_ALARM_SIGN, step());
    TEST_ASSERT_EQUAL_FLOAT(-0.002f, s.status.alarm_value);
}

static void an_estimate_of_the_wrong_sign_is_given_time_to_turn_back(void)
{
    self_tunes();
    result.estimated[0] = -0.02f;
    TEST_ASSERT_FALSE(steps(4 * REACH) & GMV_WISH_PI);
    result.estimated[0] = 0.02f;
    (void)step();
    result.estimated[0] = -0.02f;
    TEST_ASSERT_FALSE(steps(4 * REACH) & GMV_WISH_PI);
    given_up_for(GMV_ALARM_SIGN, step());
    TEST_ASSERT_EQUAL_FLOAT(-0.02f, s.status.alarm_value);
}

static void the_sign_wanted_is_that_of_the_pi(void)
{
    config.negative[0] = true;
    result.gain[0] = result.estimated[0] = -0.1f;
    gmv_supervise_init(&s, &config);
    self_tunes();
    result.gain[0] = 0.1f;
    given_up_for(GMV_ALARM_SIGN, step());
}

static void a_loop_that_would_grow_is_given_up_at_the_next_check(void)
{
    self_tunes();
    result.outcome.decay = 1.02f;
    given_up_for(GMV_ALARM_POLES, steps(2 * CHECK + 4));
}

static void predictions_twice_as_bad_as_as_it_is_are_given_up_at_the_next_check(void)
{
    self_tunes();
    result.error[0] = 0.1f;
    given_up_for(GMV_ALARM_WORSE, steps(CHECK + 2));
    TEST_ASSERT_TRUE(s.status.alarm_value > 0.04f &&
                     s.status.alarm_value < 0.1f); /* the window had begun before */
}

static void the_alarm_tells_the_error_of_the_predictions_in_the_window(void)
{
    config.tune_steps = 2 * CHECK;
    gmv_supervise_init(&s, &config);
    self_tunes();
    (void)steps(CHECK - 5); /* to the end of the first window */
    result.error[0] = 0.1f;
    given_up_for(GMV_ALARM_WORSE, steps(CHECK + 1));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.1f, s.status.alarm_value);
}

static void at_rest_where_as_it_is_is_perfect_small_errors_are_no_reason(void)
{
    self_tunes();
    result.error[0] = 0.0009f;
    result.standstill[0] = 0;
    TEST_ASSERT_EQUAL_HEX8(0, steps(3 * CHECK) & GMV_WISH_PI);
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

/* Its moves turn in each step, and were as large from the first one on: neither bursting nor a cycle of the PV. */
static void a_law_that_does_worse_than_the_pi_before_it_is_given_up_with_its_moves(void)
{
    config.tune_steps = 200;
    gmv_supervise_init(&s, &config);
    (void)steps(200 + CHECK + 2);
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
    seen.control_error[0] = 0.02f;
    uint8_t wish = 0;
    for (unsigned k = 0; k < 200 && !wish; k++) {
        seen.move[0] = seen.move[0] > 0 ? -0.01f : 0.01f;
        (void)gmv_supervise_look(&s, &seen);
        wish = gmv_supervise_judge(&s, &seen, &result) & GMV_WISH_PI;
    }
    TEST_ASSERT_TRUE(wish);
    TEST_ASSERT_EQUAL_HEX8(GMV_ALARM_RECORD, s.status.alarms);
    TEST_ASSERT_FLOAT_WITHIN(0.5f, 10, s.status.alarm_value);
}

static void an_alarm_stands_until_the_law_computes_again(void)
{
    self_tunes();
    result.gain[0] = -0.002f;
    (void)step();
    result.gain[0] = 0.1f;
    (void)steps(TUNE + CHECK - 2);
    TEST_ASSERT_EQUAL_HEX8(GMV_ALARM_SIGN, s.status.alarms);
    (void)steps(4);
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
    TEST_ASSERT_EQUAL_HEX8(0, s.status.alarms);
}

static uint8_t lose_it_once(void)
{
    result.gain[0] = 0.1f;
    self_tunes();
    result.gain[0] = -0.1f;
    return step();
}

static void the_third_time_within_a_day_is_for_good(void)
{
    TEST_ASSERT_FALSE(lose_it_once() & GMV_WISH_GIVE_UP);
    TEST_ASSERT_FALSE(lose_it_once() & GMV_WISH_GIVE_UP);
    TEST_ASSERT_TRUE(lose_it_once() & GMV_WISH_GIVE_UP);
}

static void so_is_the_third_time_within_any_later_day(void)
{
    (void)steps(2500);
    TEST_ASSERT_FALSE(lose_it_once() & GMV_WISH_GIVE_UP);
    TEST_ASSERT_FALSE(lose_it_once() & GMV_WISH_GIVE_UP);
    TEST_ASSERT_TRUE(lose_it_once() & GMV_WISH_GIVE_UP);
}

static void what_lies_more_than_a_day_back_does_not_count(void)
{
    (void)lose_it_once();
    (void)lose_it_once();
    result.gain[0] = 0.1f;
    (void)steps(1000);
    TEST_ASSERT_FALSE(lose_it_once() & GMV_WISH_GIVE_UP);
}

static void with_no_tries_it_never_gives_up_for_good(void)
{
    config.tries = 0;
    gmv_supervise_init(&s, &config);
    for (unsigned k = 0; k < 20; k++)
        TEST_ASSERT_FALSE(lose_it_once() & GMV_WISH_GIVE_UP);
}

static void a_loop_that_comes_without_a_tried_model_sends_both_back_to_tuning(void)
{
    config.loops = 2;
    gmv_supervise_init(&s, &config);
    self_tunes(); /* the first alone */
    seen.acting = seen.good = 3;
    TEST_ASSERT_EQUAL_HEX8(GMV_WISH_PI, step());
    TEST_ASSERT_EQUAL(GMV_TUNING, s.status.state);
    TEST_ASSERT_EQUAL_HEX8(0, s.status.alarms);
    self_tunes();
    seen.acting = 1; /* one goes, and comes back */
    (void)steps(3);
    seen.acting = 3;
    (void)step();
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
}

/* ---- learning ---- */

static uint8_t looks(void)
{
    seen.move[0] = seen.move[0] > 0 ? -0.001f : 0.001f;
    return gmv_supervise_look(&s, &seen);
}

static void nothing_is_learnt_while_a_reading_that_is_not_good_is_among_the_data(void)
{
    TEST_ASSERT_EQUAL_HEX8(1, looks());
    seen.good = 0;
    TEST_ASSERT_EQUAL_HEX8(0, looks());
    TEST_ASSERT_EQUAL(GMV_RESTS_READING, s.status.rest[0]);
    seen.good = 1;
    for (unsigned k = 0; k < REACH; k++)
        TEST_ASSERT_EQUAL_HEX8(0, looks());
    TEST_ASSERT_EQUAL_HEX8(1, looks());
}

static void nothing_is_learnt_in_manual(void)
{
    seen.acting = 0;
    TEST_ASSERT_EQUAL_HEX8(0, looks());
    TEST_ASSERT_EQUAL(GMV_RESTS_MANUAL, s.status.rest[0]);
    seen.acting = 1;
    TEST_ASSERT_EQUAL_HEX8(1, looks());
}

static void nothing_is_learnt_when_the_mv_has_not_moved_for_longer_than_the_regressors_reach(void)
{
    seen.move[0] = 0;
    for (unsigned k = 0; k < REACH; k++)
        TEST_ASSERT_EQUAL_HEX8(1, gmv_supervise_look(&s, &seen));
    TEST_ASSERT_EQUAL_HEX8(0, gmv_supervise_look(&s, &seen));
    TEST_ASSERT_EQUAL(GMV_RESTS_STILL, s.status.rest[0]);
    TEST_ASSERT_EQUAL_HEX8(1, looks());
}

static void an_mv_stands_still_that_moves_by_less_than_a_hundred_thousandth_of_its_span(void)
{
    for (unsigned moves = 0; moves < 2; moves++) {
        gmv_supervise_init(&s, &config);
        seen.move[0] = moves ? 1e-5f : 0.99e-5f;
        for (unsigned k = 0; k < 2 * REACH; k++)
            (void)gmv_supervise_look(&s, &seen);
        TEST_ASSERT_EQUAL(moves ? GMV_LEARNS : GMV_RESTS_STILL, s.status.rest[0]);
    }
}

static void asked_to_rest_it_rests(void)
{
    s.gate.frozen = true;
    TEST_ASSERT_EQUAL_HEX8(0, looks());
    TEST_ASSERT_EQUAL(GMV_RESTS_ASKED, s.status.rest[0]);
}

/* With v = 0.99 and three parameters a sample usually tells 0.03, so 0.006 is quiet. */
static void it_freezes_when_samples_tell_nothing_and_thaws_when_one_tells_twice_as_much(void)
{
    result.information[0] = 0.004f;
    (void)steps(1000);
    TEST_ASSERT_EQUAL(GMV_RESTS_QUIET, s.status.rest[0]);
    result.information[0] = 0.011f;
    (void)steps(10);
    TEST_ASSERT_EQUAL(GMV_RESTS_QUIET, s.status.rest[0]);
    result.information[0] = 0.013f;
    (void)steps(2);
    TEST_ASSERT_EQUAL(GMV_LEARNS, s.status.rest[0]);
}

static void of_two_loops_the_one_whose_samples_tell_nothing_rests(void)
{
    for (unsigned quiet = 0; quiet < 2; quiet++) {
        config.loops = 2;
        gmv_supervise_init(&s, &config);
        seen.acting = seen.good = 3;
        result.information[quiet] = 0.004f;
        result.information[1 - quiet] = 0.1f;
        (void)steps(1000);
        TEST_ASSERT_EQUAL(GMV_RESTS_QUIET, s.status.rest[quiet]);
        TEST_ASSERT_EQUAL(GMV_LEARNS, s.status.rest[1 - quiet]);
    }
}

static void where_nothing_is_forgotten_nothing_is_frozen(void)
{
    result.forgetting[0] = 1;
    result.information[0] = 0;
    (void)steps(1000);
    TEST_ASSERT_EQUAL(GMV_LEARNS, s.status.rest[0]);
}

/* ---- bursting ---- */

static struct gmv_burst burst;

static bool moves(unsigned n, float first, float second)
{
    bool swings = false;
    for (unsigned k = 0; k < n; k++)
        swings = gmv_burst_step(&burst, 0.5f, k % 2 ? second : first, 25, 20) || swings;
    return swings;
}

static void moves_to_and_fro_above_the_usual_are_bursting(void)
{
    gmv_burst_begin(&burst);
    TEST_ASSERT_FALSE(moves(500, 0.002f, -0.002f));
    TEST_ASSERT_TRUE(moves(20, 0.03f, -0.03f));
}

/* An MV that turns once in so many steps, with large moves after small ones. */
static bool turns_every(unsigned steps)
{
    bool swings = false;
    gmv_burst_begin(&burst);
    TEST_ASSERT_FALSE(moves(500, 0.002f, -0.002f));
    for (unsigned k = 0; k < 400; k++) {
        float move = k / steps % 2 ? 0.03f : -0.03f;
        swings = gmv_burst_step(&burst, 0.5f, move, 4, 20) || swings;
    }
    return swings;
}

/* Four turns in about sixty steps. */
static void an_mv_that_turns_every_14_steps_swings_and_one_every_25_does_not(void)
{
    TEST_ASSERT_TRUE(turns_every(14));
    TEST_ASSERT_FALSE(turns_every(25));
}

/* The first 20 steps answer the setpoint. */
static void without_256_steps_at_rest_nothing_is_bursting(void)
{
    gmv_burst_begin(&burst);
    TEST_ASSERT_FALSE(moves(20 + 200, 0.002f, -0.002f));
    TEST_ASSERT_FALSE(moves(50, 0.03f, -0.03f));
    gmv_burst_begin(&burst);
    TEST_ASSERT_FALSE(moves(20 + 256, 0.002f, -0.002f));
    TEST_ASSERT_TRUE(moves(20, 0.03f, -0.03f));
}

static void a_load_answered_in_one_direction_is_not(void)
{
    gmv_burst_begin(&burst);
    TEST_ASSERT_FALSE(moves(500, 0.002f, -0.002f));
    TEST_ASSERT_FALSE(moves(10, 0.03f, 0.03f));
}

static void moves_that_have_always_been_large_are_not(void)
{
    gmv_burst_begin(&burst);
    TEST_ASSERT_FALSE(moves(2000, 0.03f, -0.03f));
}

static void small_moves_are_not_whatever_there_was_before(void)
{
    gmv_burst_begin(&burst);
    TEST_ASSERT_FALSE(moves(500, 0, 0));
    TEST_ASSERT_FALSE(moves(100, 0.004f, -0.004f));
}

static void the_answer_to_a_setpoint_is_not(void)
{
    gmv_burst_begin(&burst);
    TEST_ASSERT_FALSE(moves(500, 0.002f, -0.002f));
    TEST_ASSERT_FALSE(gmv_burst_step(&burst, 0.6f, 0.1f, 25, 20));
    for (unsigned k = 0; k < 19; k++)
        TEST_ASSERT_FALSE(gmv_burst_step(&burst, 0.6f, k % 2 ? 0.1f : -0.1f, 25, 20));
}

static void bursting_is_given_up_with_the_size_of_the_moves(void)
{
    self_tunes();
    for (unsigned k = 0; k < 600; k++)
        (void)step();
    TEST_ASSERT_EQUAL(GMV_SELF_TUNING, s.status.state);
    uint8_t wish = 0;
    for (unsigned k = 0; k < 30 && !(wish & GMV_WISH_PI); k++) {
        seen.move[0] = k % 2 ? 0.1f : -0.1f;
        result.trial_done = wish & GMV_WISH_TRIAL;
        (void)gmv_supervise_look(&s, &seen);
        wish = gmv_supervise_judge(&s, &seen, &result);
    }
    given_up_for(GMV_ALARM_BURST, wish);
    TEST_ASSERT_TRUE(s.status.alarm_value > 0.005f && s.status.alarm_value < 0.1f);
}

static void a_pv_that_keeps_swinging_at_rest_is_given_up_with_the_size_of_the_swing(void)
{
    self_tunes();
    uint8_t wish = 0;
    result.error[0] = 0.002f;
    for (unsigned k = 0; k < 400 && !(wish & GMV_WISH_PI); k++) {
        seen.control_error[0] = 0.03f * sinf(6.2831853f * (float)k / 9);
        wish = step();
    }
    given_up_for(GMV_ALARM_BURST, wish);
    TEST_ASSERT_FLOAT_WITHIN(0.005f, 0.03f / 1.41f, s.status.alarm_value);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_model_is_tried_after_the_time_of_tuning_and_on_data_that_came_later);
    RUN_TEST(the_law_does_not_take_over_in_the_midst_of_an_answer_to_a_setpoint);
    RUN_TEST(a_setpoint_that_never_rests_is_waited_for_as_long_as_a_test);
    RUN_TEST(without_excitation_it_goes_on_tuning);
    RUN_TEST(what_predicts_no_better_than_as_it_is_is_not_adopted);
    RUN_TEST(a_gain_of_the_wrong_sign_is_not_adopted);
    RUN_TEST(a_gain_that_is_next_to_nothing_is_not_adopted);
    RUN_TEST(a_loop_that_would_not_die_away_is_not_adopted);
    RUN_TEST(a_law_that_saves_less_than_it_must_of_the_pis_error_is_not_adopted);
    RUN_TEST(a_law_that_would_shake_the_mv_for_nothing_at_rest_is_not_adopted);
    RUN_TEST(numbers_that_are_none_are_not_adopted);
    RUN_TEST(without_a_trial_nothing_is_adopted_however_long_the_test);
    RUN_TEST(after_a_refusal_it_is_tried_again_and_adopted_when_it_passes);
    RUN_TEST(a_loop_that_joins_during_the_test_begins_it_anew);
    RUN_TEST(spoilt_samples_are_no_part_of_the_test);
    RUN_TEST(with_ask_it_waits_for_the_proposal);
    RUN_TEST(a_proposal_that_is_rejected_leads_back_to_tuning);
    RUN_TEST(bare_it_adopts_after_the_time_of_tuning_whatever_comes);
    RUN_TEST(asked_for_it_adopts_what_there_is);
    RUN_TEST(a_sign_that_turns_is_given_up_in_the_same_step);
    RUN_TEST(an_estimate_of_the_wrong_sign_is_given_time_to_turn_back);
    RUN_TEST(the_sign_wanted_is_that_of_the_pi);
    RUN_TEST(a_loop_that_would_grow_is_given_up_at_the_next_check);
    RUN_TEST(predictions_twice_as_bad_as_as_it_is_are_given_up_at_the_next_check);
    RUN_TEST(the_alarm_tells_the_error_of_the_predictions_in_the_window);
    RUN_TEST(at_rest_where_as_it_is_is_perfect_small_errors_are_no_reason);
    RUN_TEST(a_law_that_does_worse_than_the_pi_before_it_is_given_up_with_its_moves);
    RUN_TEST(an_alarm_stands_until_the_law_computes_again);
    RUN_TEST(the_third_time_within_a_day_is_for_good);
    RUN_TEST(so_is_the_third_time_within_any_later_day);
    RUN_TEST(what_lies_more_than_a_day_back_does_not_count);
    RUN_TEST(with_no_tries_it_never_gives_up_for_good);
    RUN_TEST(a_loop_that_comes_without_a_tried_model_sends_both_back_to_tuning);
    RUN_TEST(nothing_is_learnt_while_a_reading_that_is_not_good_is_among_the_data);
    RUN_TEST(nothing_is_learnt_in_manual);
    RUN_TEST(nothing_is_learnt_when_the_mv_has_not_moved_for_longer_than_the_regressors_reach);
    RUN_TEST(an_mv_stands_still_that_moves_by_less_than_a_hundred_thousandth_of_its_span);
    RUN_TEST(asked_to_rest_it_rests);
    RUN_TEST(it_freezes_when_samples_tell_nothing_and_thaws_when_one_tells_twice_as_much);
    RUN_TEST(of_two_loops_the_one_whose_samples_tell_nothing_rests);
    RUN_TEST(where_nothing_is_forgotten_nothing_is_frozen);
    RUN_TEST(moves_to_and_fro_above_the_usual_are_bursting);
    RUN_TEST(an_mv_that_turns_every_14_steps_swings_and_one_every_25_does_not);
    RUN_TEST(without_256_steps_at_rest_nothing_is_bursting);
    RUN_TEST(a_load_answered_in_one_direction_is_not);
    RUN_TEST(moves_that_have_always_been_large_are_not);
    RUN_TEST(small_moves_are_not_whatever_there_was_before);
    RUN_TEST(the_answer_to_a_setpoint_is_not);
    RUN_TEST(bursting_is_given_up_with_the_size_of_the_moves);
    RUN_TEST(a_pv_that_keeps_swinging_at_rest_is_given_up_with_the_size_of_the_swing);
    return UNITY_END();
}
