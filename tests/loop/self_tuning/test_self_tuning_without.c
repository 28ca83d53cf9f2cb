/* Without the self-tuner: it is switched off, given up, loses what it reads, and comes back. A handover is without a bump when the
 * output moves no more than the law that takes over calls for by itself; the self-tuner's own first step moves nothing. */
#include "bench.h"
#include "hal/identity.h"

#define SINGLE SELF_TUNING "/single.conf"
#define PAIR   SELF_TUNING "/pair.conf"

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

/* What a PI moves between two samples, kW. */
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

/* What feedforward adds is no move of the law's, and no error of the model. */
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
    TEST_ASSERT_EQUAL_DOUBLE(0, inside("use1_3")); /* there is one parameter more: the bias */
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

/* ---- however fast the board is ---- */

static char rows[400000];

static void keep_rows(void)
{
    for (char *line = strtok(board.said, "\n"); line; line = strtok(NULL, "\n"))
        if (strncmp(line, "T,", 2) == 0 || strncmp(line, "! ", 2) == 0) {
            strcat(rows, line);
            strcat(rows, "\n");
        }
    board_forget();
}

static void hear_what_is_said(void)
{
    uint8_t byte;
    struct frame f;
    size_t n;
    while ((n = memory_port_take(HAL_UART_CONSOLE, board.said + board.n_said,
                                 SAID_MAX - 1 - board.n_said)) != 0) {
        board.n_said += n;
        board.said[board.n_said] = '\0';
    }
    while (memory_port_take(HAL_UART_LINK, &byte, 1))
        if (frame_decode(&board.decoder, byte, &f))
            plant_answers(&f);
}

/* A turn of the main loop for each of the tick's, and no more than the answer to a sample takes. Whether that was more than
 * one. */
static bool slow_step(void)
{
    struct link_sample sample;
    struct frame f;
    unsigned before = board.commands, turns = 0;
    instruments_measure(&instruments, plant, TICK_S, &sample);
    sample.number = ++board.number;
    sample.time_ms = board.time_ms;
    pack_sample(&sample, &f);
    link_give(&f);
    for (; board.commands == before; turns++) {
        TEST_ASSERT_TRUE(turns < 10000);
        memory_port_turn();
        hear_what_is_said();
    }
    instruments_command(&instruments, &board.command);
    TEST_ASSERT_TRUE(instruments_drive(&instruments, plant, TICK_S, plant_err, sizeof plant_err));
    board.time_ms += board.tick_ms;
    TEST_ASSERT_TRUE(
        kind->advance(plant, (double)board.time_ms / 1000.0, plant_err, sizeof plant_err));
    return turns > 1;
}

/* Tuning, trial and takeover. Samples that have waited. */
static unsigned logs(bool slow)
{
    unsigned waited = 0;
    column_at_rest(SINGLE, 1);
    ask_ok("set block1.excite 0");
    in_auto();
    setpoint("bottom", base + 0.5);
    plant_steps(2);
    ask_ok("log on");
    rows[0] = '\0';
    board_forget();
    for (unsigned k = 0; k < 160; k++) {
        if (k % 20 == 0 && k && k != 60 &&
            k != 80) { /* an answer takes long: the trial would be over */
            board_run();
            keep_rows();
            setpoint("bottom", base + (k / 20 % 2 ? 0 : 0.5));
            board_forget();
        }
        if (slow)
            waited += slow_step();
        else
            plant_step();
        if (!slow)
            board_run();
        keep_rows();
    }
    board_run();
    keep_rows();
    TEST_ASSERT_TRUE(state_is(SELF_TUNING_STATE));
    return waited;
}

static void the_log_is_the_same_however_fast_the_board_is(void)
{
    static char fast[sizeof rows];
    (void)logs(false);
    snprintf(fast, sizeof fast, "%s", rows);
    TEST_ASSERT_TRUE(strlen(fast) > 1000);
    plant_power_off();
    TEST_ASSERT_TRUE_MESSAGE(logs(true) > 0, "no sample ever met work under way");
    TEST_ASSERT_TRUE(strcmp(fast, rows) == 0);
}

/* ---- what is refused ---- */

static void is_refused(const char *change, const char *words)
{
    ask_ok("begin");
    ask_ok(change);
    ask_refused("apply", "RANGE");
    TEST_ASSERT_TRUE_MESSAGE(said(words), board.said);
    ask_ok("abandon");
}

static void what_cannot_be_right_is_refused_with_what_would_be(void)
{
    column_at_rest(PAIR, 0);
    is_refused("set block1.inputs T1",
               "block1.inputs: 'gmv' needs the PVs of its loops, in their order");
    is_refused("set block1.inputs Lr,Qrb", "needs the PVs of its loops, in their order");
    is_refused("set block1.tune_gain.1 -3,0", "block1.tune_gain: 'gmv' needs a gain for each PI");
    is_refused("set block1.tune_ti.1 600,0.001", "block1.tune_ti: 'gmv' must be 0, or 0.01 s");
    is_refused("set block1.lambda.1 -1,1", "must have the sign of tune_gain, and none if relative");
    is_refused("set block1.delay.1 0,1", "block1.delay: 'gmv' needs 1 to 8 steps");
    is_refused("set block1.delay.2 1,2", "needs 0, or at least the loop's own delay");
    is_refused("set block1.check_time 200", "block1.check_time: 'gmv' must be ten steps or more");
    is_refused("set block1.tau_p.1 10000,0", "block1.tau_p: 'gmv' must be 200 steps or less");
    ask_ok("begin");
    ask_ok("set block1.na 4");
    ask_ok("set block1.nb 4");
    ask_ok("set block1.form positional");
    ask_refused("apply", "RANGE");
    TEST_ASSERT_TRUE(said("makes more than 12 parameters"));
    ask_ok("abandon");
}

/* One setting at an end of its range, the rest as it is. The block may give up, but not for want of a number; and where a loop
 * acts, its PV stays where the PI, or whoever took over, can hold it. */
static void at_the_ends_of_every_range_they_run_or_refuse(void)
{
    static const char *const ends[] = {"form positional",
                                       "way explicit",
                                       "weight delta",
                                       "weight scalar",
                                       "bias residuals",
                                       "bias none",
                                       "na 4",
                                       "nb 4",
                                       "nc 2",
                                       "delay.1 8,1",
                                       "load_delay 8",
                                       "average 8",
                                       "tau_p.1 0,0",
                                       "tau_p.1 6000,0",
                                       "tau_r.1 0,0",
                                       "tau_r.1 6000,0",
                                       "lambda.1 0,0",
                                       "lambda.1 100,0",
                                       "p0.1 1e-6,1e-6",
                                       "p0.1 1e9,1e9",
                                       "forgetting constant",
                                       "forgetting fortescue",
                                       "forgetting ydstie",
                                       "forgetting ydstie_trace",
                                       "forgetting held_trace",
                                       "forgetting reset",
                                       "forgetting bounded",
                                       "forget 0.5",
                                       "forget 1",
                                       "forget_least 0.01",
                                       "forget_least 1",
                                       "memory 1e-12",
                                       "memory 1e6",
                                       "trace 1e-6",
                                       "trace 1e12",
                                       "correction pc",
                                       "correction spc",
                                       "correct_rate 0",
                                       "correct_rate 2",
                                       "error_most 100",
                                       "error_most 1e-6",
                                       "dead_zone 100",
                                       "dead_zone 1",
                                       "normalise on",
                                       "lo.1 -100,-100",
                                       "hi.1 100,100",
                                       "hi.2 0.001,0",
                                       "supervise off",
                                       "adopt ask",
                                       "tune_gain.1 100,0",
                                       "tune_gain.1 0.001,0",
                                       "tune_ti.1 0,0",
                                       "tune_ti.1 1e6,0",
                                       "tune_time 0",
                                       "tune_time 1e6",
                                       "check_time 0",
                                       "check_time 1e6",
                                       "excite 0",
                                       "excite 1000",
                                       "gain_least 1e-6",
                                       "gain_least 1",
                                       "margin 1",
                                       "margin 10",
                                       "speed 0.0001",
                                       "speed 1",
                                       "quiet 0",
                                       "quiet 1",
                                       "burst 2",
                                       "burst 1e6",
                                       "tries 0",
                                       "tries 8",
                                       "theta1_1 100",
                                       "theta1_1 -100",
                                       "theta1_2 100",
                                       "theta1_2 -100"};
    unsigned ran = 0;
    for (unsigned k = 0; k < sizeof ends / sizeof ends[0]; k++) {
        char line[80];
        if (k)
            plant_power_off();
        column_at_rest(SINGLE, 1);
        snprintf(line, sizeof line, "set block1.%s", ends[k]);
        if (strcmp(ask(line), "ok") != 0)
            continue;
        ran++;
        in_auto();
        steps_with_a_moving_setpoint(300);
        ask_ok("events");
        TEST_ASSERT_FALSE_MESSAGE(said("BLOCK_GAVE_UP not"), line); /* a number */
        ask_ok("block 1");
    }
    printf("%u of %u ends ran\n", ran, (unsigned)(sizeof ends / sizeof ends[0]));
    TEST_ASSERT_TRUE(ran >= 60);
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
    RUN_TEST(the_log_is_the_same_however_fast_the_board_is);
    RUN_TEST(what_cannot_be_right_is_refused_with_what_would_be);
    RUN_TEST(at_the_ends_of_every_range_they_run_or_refuse);
    return UNITY_END();
}
