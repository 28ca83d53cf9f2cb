/* Settings of the self-tuner: what is refused, what runs at the ends of all ranges; and that its work between ticks shows nowhere. */
#include "bench.h"
#include "turn_bench.h"

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

/* Tuning, trial and takeover. Samples that have waited. */
static unsigned logs(bool slow)
{
    unsigned waited = 0;
    column_at_rest(SINGLE, 1);
    ask_ok("set block1.excite 0");
    ask_ok("set block1.nb 1"); /* known soon */
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
    is_refused("set block1.tau_p.1 10000,0", "block1.tau_p: 'gmv' must be 200 steps or less");
    ask_ok("set block1.bias error");
    is_refused("set block1.form positional", "block1.bias: 'gmv' must not be error unless");
    is_refused("set block1.way explicit", "block1.bias: 'gmv' must not be error unless");
    ask_ok("set block1.bias one");
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

/* ---- the page ---- */

static void the_example_of_its_page_is_taken_as_it_stands(void)
{
    char line[200];
    unsigned lines = 0;
    bool found = false;
    plant_power_on("pilot", TICK_MS, 1, 1);
    ask_file("../host_sim/scenarios/pilot.conf");
    FILE *page = fopen("../docs/methods/self-tuning.md", "r");
    TEST_ASSERT_NOT_NULL(page);
    while (fgets(line, sizeof line, page)) {
        if (strncmp(line, "## ", 3) == 0)
            found = strstr(line, "Set it up") != NULL;
        line[strcspn(line, "\n")] = '\0';
        if (!found || strncmp(line, "    ", 4) != 0)
            continue;
        ask_ok(line + 4);
        lines++;
    }
    TEST_ASSERT_EQUAL(0, fclose(page));
    TEST_ASSERT_TRUE(lines > 5);
    ask_ok("get block1.tune_gain.1");
    TEST_ASSERT_TRUE(said("-10,3.2"));
}

static void a_block_of_one_loop_needs_one_value_in_a_row(void)
{
    column_at_rest(SINGLE, 1);
    ask_ok("set block1.tune_gain.1 1.7");
    ask_ok("set block1.delay.1 2");
    ask_ok("block 1");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_log_is_the_same_however_fast_the_board_is);
    RUN_TEST(what_cannot_be_right_is_refused_with_what_would_be);
    RUN_TEST(at_the_ends_of_every_range_they_run_or_refuse);
    RUN_TEST(the_example_of_its_page_is_taken_as_it_stands);
    RUN_TEST(a_block_of_one_loop_needs_one_value_in_a_row);
    return UNITY_END();
}
