/* Without the worked family: what it is served by is lost, given up, switched off, of another build, and comes back. A handover
 * is without a bump when the output moves no more than the law that takes over calls for by itself. */
#include "worked_family_bench.h"

#include "hal/identity.h"

#include "turn_bench.h"

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
    double out[2], error[2]; /* lb/min, %w: as the firmware has them */
};

static struct moment now(double top, double bottom)
{
    return (struct moment){{commanded("R"), commanded("S")},
                           {top - reads("xD"), bottom - reads("xB")}};
}

/* Move of a PI between two samples: gain times (change of the error + its share of ti). A setpoint that does not move. */
static double pi_moves(double gain, double ti_s, double before, double after)
{
    return gain * (fabs(after - before) + TICK_S / ti_s * fabs(after));
}

#define ROUNDING 1e-5 /* lb/min */

static void only_what_the_pids_call_for(struct moment before, struct moment after)
{
    double moved[2] = {fabs(after.out[0] - before.out[0]), fabs(after.out[1] - before.out[1])};
    double most[2] = {pi_moves(TOP_GAIN, TOP_TI_S, before.error[0], after.error[0]),
                      pi_moves(BOTTOM_GAIN, BOTTOM_TI_S, before.error[1], after.error[1])};
    for (unsigned i = 0; i < 2; i++) {
        char message[80];
        snprintf(message, sizeof message, "output %u moved by %g, its PID by %g", i, moved[i],
                 most[i]);
        TEST_ASSERT_TRUE_MESSAGE(moved[i] <= most[i] + ROUNDING, message);
    }
}

static void nothing_moves(struct moment before, struct moment after)
{
    for (unsigned i = 0; i < 2; i++)
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING, before.out[i], after.out[i]);
}

static bool both_are_in_auto(void)
{
    ask_ok("loop");
    return said("top auto ") && said("bottom auto ");
}

/* In the midst of a setpoint step, where everything moves. */
static void under_way(void)
{
    column_at_rest(0);
    in_auto();
    setpoint("top", 97.25);
    plant_steps(8);
    board_forget();
}

/* It takes over at what is there, and the setpoint is reached. */
static void it_comes_back(void)
{
    ask_ok("block state_feedback on");
    struct moment before = now(97.25, 0.5);
    plant_step();
    nothing_moves(before, now(97.25, 0.5));
    TEST_ASSERT_TRUE(both_are_in_auto());
    plant_steps(200);
    ask_ok("block");
    TEST_ASSERT_TRUE(said("block2 state_feedback on"));
    TEST_ASSERT_DOUBLE_WITHIN(2 * XD_RESOLUTION, 97.25, truly("xD"));
    TEST_ASSERT_DOUBLE_WITHIN(2 * XB_RESOLUTION, 0.5, truly("xB"));
}

static void switched_off_and_on_nothing_bumps(void)
{
    under_way();
    struct moment before = now(97.25, 0.5);
    ask_ok("block state_feedback off");
    plant_step();
    TEST_ASSERT_TRUE(said("BLOCK_GAVE_UP asked 2"));
    only_what_the_pids_call_for(before, now(97.25, 0.5));
    plant_steps(5);
    it_comes_back();
}

static void without_a_point_it_gives_up_and_the_pids_act(void)
{
    under_way();
    plant_event("xD.quality=2");
    struct moment before = now(97.25, 0.5);
    unsigned held = 0;
    board_forget();
    for (; !said("BLOCK_GAVE_UP xD_ahead 2") && held < 10; held++) {
        board_forget();
        plant_step();
        if (!said("BLOCK_GAVE_UP"))
            before = now(97.25, 0.5);
        TEST_ASSERT_TRUE(held * TICK_S <= POINT_HOLD_S);
    }
    TEST_ASSERT_TRUE(held * TICK_S > POINT_HOLD_S);
    only_what_the_pids_call_for(before, now(97.25, 0.5));
    TEST_ASSERT_TRUE(both_are_in_auto()); /* the measurement itself is held for longer */
    plant_event("xD.quality=0");
    plant_steps(3);
    TEST_ASSERT_TRUE(said("MEASUREMENT_GOOD xD_ahead"));
    ask_ok("block");
    TEST_ASSERT_TRUE(said("block2 state_feedback off: xD_ahead"));
    it_comes_back();
}

static void where_the_measurement_stays_away_its_loop_goes_to_manual_and_the_other_acts(void)
{
    under_way();
    plant_event("xD.quality=2");
    plant_steps(25); /* held for 20 min */
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("top manual ") && said("bottom auto "));
    plant_steps(400);
    TEST_ASSERT_DOUBLE_WITHIN(2 * XB_RESOLUTION, 0.5, truly("xB"));
}

static void other_settings_are_taken_without_a_bump(void)
{
    static const char *const changes[] = {"set block2.lambda.1 600,480", "set block2.lag.1 900,900",
                                          "set block1.dead.1 60,240"};
    for (unsigned k = 0; k < 3; k++) {
        if (k)
            plant_power_off();
        column_at_rest(0);
        plant_event("xD.resolution=0"); /* so that at rest nothing moves at all */
        plant_event("xB.resolution=0");
        in_auto();
        plant_steps(200);
        struct moment before = now(96.25, 0.5);
        ask_ok(changes[k]);
        plant_steps(3);
        nothing_moves(before, now(96.25, 0.5));
    }
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

static void what_was_saved_is_there_after_a_restart(void)
{
    static char before[SAID_MAX];
    column_at_rest(0);
    ask_ok("set block2.lambda.1 540,660");
    plant_step();
    ask_ok("save");
    ask_ok("dump");
    snprintf(before, sizeof before, "%s", board.said);
    firmware_starts_again();
    plant_steps(2); /* nothing is read before the first command */
    ask_ok("dump");
    TEST_ASSERT_EQUAL_STRING(before, board.said);
    ask_ok("out top 1.95");
    ask_ok("out bottom 1.71");
    plant_steps(300);
    TEST_ASSERT_EQUAL_DOUBLE(1, inside("observer", "gained"));
    in_auto();
    setpoint("top", 97);
    plant_steps(240);
    TEST_ASSERT_DOUBLE_WITHIN(2 * XD_RESOLUTION, 97, truly("xD"));
    ask_ok("block");
    TEST_ASSERT_TRUE(said("block2 state_feedback on"));
}

/* The steam was cut meanwhile: what the observer remembers of it is not true any more. */
static void the_link_unplugged_and_back_it_begins_anew(void)
{
    column_at_rest(0);
    in_auto();
    board.mute = true;
    pass(5000);
    plant_steps(30); /* the plant by itself, at its safe values */
    plant_connect();
    plant_step();
    TEST_ASSERT_DOUBLE_WITHIN(2 * XD_RESOLUTION, reads("xD"), reads("xD_ahead"));
    ask_ok("out top 1.95");
    ask_ok("out bottom 1.71");
    plant_steps(400);
    in_auto();
    setpoint("bottom", 0.8);
    plant_steps(240);
    TEST_ASSERT_DOUBLE_WITHIN(2 * XD_RESOLUTION, 96.25, truly("xD"));
    TEST_ASSERT_DOUBLE_WITHIN(2 * XB_RESOLUTION, 0.8, truly("xB"));
}

/* ---- however fast the board is ---- */

static char rows[200000];

static void keep_rows(void)
{
    for (char *line = strtok(board.said, "\n"); line; line = strtok(NULL, "\n"))
        if (strncmp(line, "T,", 2) == 0 || strncmp(line, "! ", 2) == 0) {
            strcat(rows, line);
            strcat(rows, "\n");
        }
    board_forget();
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
        hear();
    }
    instruments_command(&instruments, &board.command);
    TEST_ASSERT_TRUE(instruments_drive(&instruments, plant, TICK_S, plant_err, sizeof plant_err));
    board.time_ms += board.tick_ms;
    TEST_ASSERT_TRUE(
        kind->advance(plant, (double)board.time_ms / 1000.0, plant_err, sizeof plant_err));
    return turns > 1;
}

/* Samples that have waited. */
static unsigned logs(bool slow)
{
    unsigned waited = 0;
    column_at_rest(1);
    in_auto();
    ask_ok("log on");
    rows[0] = '\0';
    ask_ok("set block1.drift.1 0.0005,0.0005"); /* a gain is computed */
    setpoint("top", 97);
    board_forget();
    for (unsigned k = 0; k < 60; k++)
        if (slow)
            waited += slow_step();
        else
            plant_step();
    board_run();
    keep_rows();
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
    TEST_ASSERT_EQUAL_STRING(fast, rows);
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
    column_at_rest(0);
    is_refused("set block1.inputs R,S,xD,xB",
               "block1.inputs: 'observer' needs two measurements, then two MVs");
    is_refused("set block1.points xD_ahead", "needs two");
    is_refused("set meas3.hi 120",
               "block1.points: 'observer' needs for each the span of its measurement");
    is_refused("set block1.dead.1 60,20000", "block1.dead: 'observer' must be at most 240 steps");
    is_refused("set block1.lag.1 700000,1260",
               "block1.lag: 'observer' must be at most 10000 steps");
    is_refused("set block2.loops top", "block2.loops: 'state_feedback' needs two");
    is_refused("set block2.inputs xB_ahead,xD_ahead",
               "block2.inputs: 'state_feedback' needs the spans of the PVs");
    is_refused("set block2.lambda.1 3000,600", "must be a twentieth of lag to 1.8 times lag");
    is_refused("set block2.gain.2 0.66,-0.975", "has rows too much alike to be decoupled");
    is_refused("set block2.gain.1 0.015,-0.04", "needs an inverse of 100 or less");
    is_refused("set block2.gain.2 0.66,0", "needs a diagonal of 0.01 or more");
}

/* One setting at an end of its range, the rest as it is. At rest the points are right with every model; in automatic a wrong one
 * may make the block give up, but not for want of a number. */
static void at_the_ends_of_every_range_they_run_or_refuse(void)
{
    static const char *const ends[] = {"block1.gain.1 100,-100",
                                       "block1.gain.1 0,0",
                                       "block1.lag.1 0.001,0.001",
                                       "block1.lag.2 600000,1e6",
                                       "block1.dead.1 0,0",
                                       "block1.dead.2 14400,14400",
                                       "block1.noise.1 0.0001,0.0001",
                                       "block1.noise.1 0.1,0.1",
                                       "block1.drift.1 0.00001,0.00001",
                                       "block1.drift.1 0.1,0.1",
                                       "block1.unseen 0",
                                       "block1.unseen 0.02",
                                       "block2.gain.1 20,-20",
                                       "block2.gain.2 20,-20",
                                       "block2.lag.1 0.001,1e6",
                                       "block2.lambda.1 120,120",
                                       "block2.lambda.1 2000,1300"};
    unsigned ran = 0;
    for (unsigned k = 0; k < sizeof ends / sizeof ends[0]; k++) {
        char line[80];
        if (k)
            plant_power_off();
        column_at_rest(1);
        snprintf(line, sizeof line, "set %s", ends[k]);
        if (strcmp(ask(line), "ok") != 0)
            continue;
        ran++;
        plant_steps(200);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(3.2, 96.25, reads("xD_ahead"), line);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(4, 0.5, reads("xB_ahead"), line);
        in_auto();
        setpoint("top", 96.5);
        plant_steps(100);
        ask_ok("events");
        TEST_ASSERT_FALSE_MESSAGE(said("BLOCK_GAVE_UP not"), line); /* a number */
    }
    TEST_ASSERT_TRUE(ran >= 12);
}

/* ---- a build without these kinds ---- */

/* For test_worked_family_product, which has the product's kinds alone. */
static void a_stored_set_is_left_for_a_build_without_these_kinds(void)
{
    column_at_rest(0);
    ask_ok("save");
    flash_to(WORKED_FAMILY_FLASH);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(switched_off_and_on_nothing_bumps);
    RUN_TEST(without_a_point_it_gives_up_and_the_pids_act);
    RUN_TEST(where_the_measurement_stays_away_its_loop_goes_to_manual_and_the_other_acts);
    RUN_TEST(other_settings_are_taken_without_a_bump);
    RUN_TEST(what_was_saved_is_there_after_a_restart);
    RUN_TEST(the_link_unplugged_and_back_it_begins_anew);
    RUN_TEST(the_log_is_the_same_however_fast_the_board_is);
    RUN_TEST(what_cannot_be_right_is_refused_with_what_would_be);
    RUN_TEST(at_the_ends_of_every_range_they_run_or_refuse);
    RUN_TEST(a_stored_set_is_left_for_a_build_without_these_kinds);
    return UNITY_END();
}
