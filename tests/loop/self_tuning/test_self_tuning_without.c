/* Without the self-tuner: it is switched off, given up, loses what it reads, and comes back. A handover is without a bump when the
 * output moves no more than the law that takes over calls for by itself; the self-tuner's own first step moves nothing. */
#include "bench.h"
#include "hal/identity.h"

#define SINGLE SELF_TUNING "/single.conf"

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

/* ---- without a bump ---- */

struct moment {
    double out, error; /* kW, degC: as the firmware has them */
};

static struct moment now(double wanted)
{
    return (struct moment){commanded("Qrb"), wanted - reads("T10")};
}

/* Move of a PI between two samples, kW. */
static double pi_moves(double gain, double ti_s, struct moment before, struct moment after)
{
    return gain * QRB_SPAN / T_SPAN *
           (fabs(after.error - before.error) + TICK_S / ti_s * fabs(after.error));
}

#define ROUNDING 1e-5 /* kW */

static void no_more_than_the_pi_moves(double gain, double ti_s, struct moment before,
                                      struct moment after)
{
    char message[80];
    double moved = fabs(after.out - before.out), most = pi_moves(gain, ti_s, before, after);
    snprintf(message, sizeof message, "moved by %g, the PI by %g", moved, most);
    TEST_ASSERT_TRUE_MESSAGE(moved <= most + ROUNDING, message);
}

/* In the midst of a setpoint step. */
static void under_way(void)
{
    tuned_in(SINGLE, 0);
    setpoint("bottom", base + 0.8);
    plant_steps(4);
    board_forget();
}

static void it_tunes_in_again(void)
{
    for (unsigned k = 0; k < 40 && !state_is(SELF_TUNING_STATE); k++)
        steps_with_a_moving_setpoint(20);
    TEST_ASSERT_TRUE(state_is(SELF_TUNING_STATE));
    setpoint("bottom", base);
    plant_steps(100);
    TEST_ASSERT_DOUBLE_WITHIN(RESOLUTION, base, truly("T10"));
}

static void switched_off_and_on_nothing_bumps(void)
{
    under_way();
    struct moment before = now(base + 0.8);
    ask_ok("block 1 off");
    plant_step();
    TEST_ASSERT_TRUE(events_say("BLOCK_GAVE_UP asked"));
    no_more_than_the_pi_moves(OWN_GAIN, OWN_TI_S, before, now(base + 0.8));
    TEST_ASSERT_TRUE(loop_is("bottom", "auto"));
    plant_steps(5);
    before = now(base + 0.8);
    ask_ok("block 1 on");
    plant_step();
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING, before.out, commanded("Qrb"));
    TEST_ASSERT_TRUE(state_is(TUNING)); /* somebody else has moved its MV meanwhile */
    it_tunes_in_again();
}

static void told_to_tune_the_pi_takes_over_without_a_bump(void)
{
    under_way();
    struct moment before = now(base + 0.8);
    ask_ok("block 1 tune");
    plant_step();
    TEST_ASSERT_TRUE(state_is(TUNING));
    no_more_than_the_pi_moves(TUNE_GAIN, TUNE_TI_S, before, now(base + 0.8));
    it_tunes_in_again();
}

static void when_the_law_takes_over_its_first_step_moves_nothing(void)
{
    column_at_rest(SINGLE, 0);
    in_auto();
    double before = 0;
    for (unsigned k = 0; k < 800 && !state_is(SELF_TUNING_STATE); k++) {
        if (k % 13 == 0)
            setpoint("bottom", base + (k / 13 % 2 ? 0 : 0.5));
        before = commanded("Qrb");
        plant_step();
    }
    TEST_ASSERT_TRUE(state_is(SELF_TUNING_STATE));
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING, before, commanded("Qrb"));
}

/* The part that feedforward adds is no move of the law's, and no error of the model. */
static void with_feedforward_on_its_mv_nothing_bumps_either(void)
{
    column_at_rest(SINGLE, 0);
    ask_ok("begin");
    ask_ok("set ff1.from T1");
    ask_ok("set ff1.to Qrb");
    ask_ok("set ff1.reference 80");
    ask_ok("set ff1.gain 0.5");
    ask_ok("apply");
    in_auto();
    double before = 0;
    for (unsigned k = 0; k < 800 && !state_is(SELF_TUNING_STATE); k++) {
        if (k % 13 == 0)
            setpoint("bottom", base + (k / 13 % 2 ? 0 : 0.5));
        before = commanded("Qrb");
        plant_step();
    }
    TEST_ASSERT_TRUE(state_is(SELF_TUNING_STATE));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, before, commanded("Qrb")); /* what T1 has moved */
    plant_steps(2);
    setpoint("bottom", base);
    plant_steps(150);
    TEST_ASSERT_DOUBLE_WITHIN(RESOLUTION, base, truly("T10"));
}

static void through_manual_and_back_nothing_bumps(void)
{
    under_way();
    double before = commanded("Qrb");
    ask_ok("mode bottom manual");
    plant_steps(2);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, before, commanded("Qrb"));
    before = commanded("Qrb");
    plant_steps(20);
    TEST_ASSERT_EQUAL_DOUBLE(before, commanded("Qrb"));
    ask_ok("mode bottom auto");
    plant_step();
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING, before, commanded("Qrb"));
    TEST_ASSERT_TRUE(state_is(TUNING));
    it_tunes_in_again();
}

static void other_settings_are_taken_without_a_bump(void)
{
    static const char *const changes[] = {
        "set block1.lambda.1 3,3",   "set block1.tune_gain.1 0.4,0", "set block1.forget 0.95",
        "set block1.check_time 600", "set block1.tau_r.1 120,120",   "set block1.average 2"};
    for (unsigned k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        if (k)
            plant_power_off();
        tuned_in(SINGLE, 0);
        plant_event("T10.resolution=0"); /* so that at rest nothing moves */
        plant_steps(200);
        double before = commanded("Qrb");
        ask_ok(changes[k]);
        for (unsigned t = 0; t < 5; t++) {
            plant_step();
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-4, before, commanded("Qrb"), changes[k]);
        }
    }
}

/* Another form of the model: the estimator begins anew, under the PI. */
static void another_shape_of_the_model_begins_with_tuning(void)
{
    tuned_in(SINGLE, 0);
    ask_ok("set block1.form positional");
    plant_steps(2);
    TEST_ASSERT_TRUE(state_is(TUNING));
    TEST_ASSERT_EQUAL_DOUBLE(0, inside("use1_7")); /* there is one parameter more: the bias */
}

/* ---- what it reads ---- */

static void a_reading_that_is_not_good_is_never_learnt_from(void)
{
    tuned_in(SINGLE, 0);
    setpoint("bottom", base + 0.3);
    plant_steps(2);
    plant_event("T10.quality=2");
    plant_step();
    TEST_ASSERT_EQUAL_DOUBLE(4, inside("rests_1"));
    double f = inside("est1_1");
    plant_step();
    plant_event("T10.quality=0");
    plant_steps(2);
    TEST_ASSERT_EQUAL_DOUBLE(4, inside("rests_1")); /* it is among the data still */
    TEST_ASSERT_EQUAL_DOUBLE(f, inside("est1_1"));
    plant_steps(20);
    TEST_ASSERT_EQUAL_DOUBLE(0, inside("rests_1"));
    TEST_ASSERT_TRUE(state_is(SELF_TUNING_STATE));
}

static void where_the_measurement_stays_away_its_loop_goes_to_manual(void)
{
    tuned_in(SINGLE, 0);
    plant_event("T10.quality=3");
    plant_steps(20);
    TEST_ASSERT_TRUE(loop_is("bottom", "manual"));
    TEST_ASSERT_TRUE(alarm_says("MEASUREMENT_BAD T10"));
    plant_event("T10.quality=0");
    plant_steps(3);
    ask_ok("out bottom 0.75"); /* the interlock on T10 had cut the heater */
    plant_steps(300);
    ask_ok("mode bottom auto");
    plant_steps(2);
    TEST_ASSERT_TRUE(state_is(TUNING));
    it_tunes_in_again();
}

static void without_a_disturbance_it_gives_up_and_the_loops_own_pid_acts(void)
{
    column_at_rest(SINGLE, 0);
    ask_ok("set block1.inputs T10,T1");
    in_auto();
    plant_steps(20);
    struct moment before = now(base);
    plant_event("T1.quality=3");
    for (unsigned k = 0; k < 10 && !events_say("BLOCK_GAVE_UP"); k++) {
        before = now(base);
        plant_step();
    }
    TEST_ASSERT_TRUE(events_say("BLOCK_GAVE_UP no_input"));
    no_more_than_the_pi_moves(OWN_GAIN, OWN_TI_S, before, now(base));
    TEST_ASSERT_TRUE(loop_is("bottom", "auto"));
    plant_event("T1.quality=0");
    plant_steps(3);
    ask_ok("block 1 on");
    plant_steps(2);
    TEST_ASSERT_TRUE(state_is(TUNING));
}

static void another_measurement_in_place_of_the_pv_is_found_out(void)
{
    column_at_rest(SINGLE, 0);
    ask_ok("set block1.inputs T1");
    in_auto();
    plant_steps(3);
    TEST_ASSERT_TRUE(events_say("BLOCK_GAVE_UP not_the_PV"));
    TEST_ASSERT_TRUE(loop_is("bottom", "auto"));
}

/* ---- what is kept, and what is not ---- */

static void firmware_starts_again(void)
{
    memory_port_start(); /* power has been lost */
    board.ready = false;
    board.clock_ms = 0;
    board_run();
    type("mode machine\n");
    pass(3000);
    TEST_ASSERT_TRUE(board.ready);
}

static void what_was_saved_is_there_after_a_restart_and_is_tested_anew(void)
{
    static char before[SAID_MAX];
    tuned_in(SINGLE, 0);
    plant_steps(3);
    ask_ok("save");
    double theta = parameter("block1.theta1_2");
    ask_ok("dump");
    snprintf(before, sizeof before, "%s", board.said);
    firmware_starts_again();
    plant_steps(2);
    ask_ok("dump");
    TEST_ASSERT_EQUAL_STRING(before, board.said);
    TEST_ASSERT_TRUE(theta > 0);
    TEST_ASSERT_EQUAL_DOUBLE(theta, inside("use1_2"));
    TEST_ASSERT_TRUE(state_is(TUNING));
    ask_ok("out bottom 0.75");
    ask_ok("out top 4.5");
    plant_steps(300);
    in_auto();
    it_tunes_in_again();
}

static void the_link_unplugged_and_back_it_begins_anew(void)
{
    tuned_in(SINGLE, 0);
    board.mute = true;
    pass(5000);
    plant_steps(30); /* the plant by itself, at its safe values */
    plant_connect();
    plant_steps(2);
    ask_ok("out bottom 0.75");
    ask_ok("out top 4.5");
    plant_steps(400);
    in_auto();
    plant_steps(2);
    TEST_ASSERT_TRUE(state_is(TUNING));
    it_tunes_in_again();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(switched_off_and_on_nothing_bumps);
    RUN_TEST(told_to_tune_the_pi_takes_over_without_a_bump);
    RUN_TEST(when_the_law_takes_over_its_first_step_moves_nothing);
    RUN_TEST(with_feedforward_on_its_mv_nothing_bumps_either);
    RUN_TEST(through_manual_and_back_nothing_bumps);
    RUN_TEST(other_settings_are_taken_without_a_bump);
    RUN_TEST(another_shape_of_the_model_begins_with_tuning);
    RUN_TEST(a_reading_that_is_not_good_is_never_learnt_from);
    RUN_TEST(where_the_measurement_stays_away_its_loop_goes_to_manual);
    RUN_TEST(without_a_disturbance_it_gives_up_and_the_loops_own_pid_acts);
    RUN_TEST(another_measurement_in_place_of_the_pv_is_found_out);
    RUN_TEST(what_was_saved_is_there_after_a_restart_and_is_tested_anew);
    RUN_TEST(the_link_unplugged_and_back_it_begins_anew);
    return UNITY_END();
}
