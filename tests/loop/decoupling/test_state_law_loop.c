/* The law of state feedback found on the board (host_sim/scenarios/pilot-state-law.conf) on the whole firmware with the pilot column: pasted,
 * designed, accepted, in force, and the column under it; refusals in words; what somebody who has the workspace, another table, an apply, a
 * restart and a plan without the block make of a design. */
#include <math.h>

#include "plant_board.h"

#define TICK_MS 30000u
#define BLOCK   "block 2"

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

static bool shows(const char *block, const char *text)
{
    char command[20];
    snprintf(command, sizeof command, "block %s", block);
    ask_ok(command);
    return said(text);
}

/* Truths of the pilot column with sensors that are exact. */
static void measures(void)
{
    static const char *const names[] = {"xD", "xB", "T3", "T4", "T8"};
    static const struct plant_class *measuring; /* it lives as long as the program */
    kind->destroy(plant);
    if (!measuring)
        measuring = plant_measuring(kind, names, 5, plant_err, sizeof plant_err);
    kind = measuring;
    TEST_ASSERT_NOT_NULL_MESSAGE(kind, plant_err);
    plant = plant_create(kind, plant_err, sizeof plant_err);
    TEST_ASSERT_NOT_NULL_MESSAGE(plant, plant_err);
    TEST_ASSERT_TRUE(instruments_init(&instruments, kind, 3, 0, plant_err, sizeof plant_err));
    board.n_measurements = (uint8_t)instruments.n_sensors;
}

static void pasted(void)
{
    plant_power_on("pilot", TICK_MS, 3, 0);
    measures();
    ask_file(SCENARIOS "/pilot.conf");
    ask_file(SCENARIOS "/pilot-state-law.conf");
    plant_connect();
    plant_steps(2);
    plant_event("T1.resolution=0");
    plant_event("T2.resolution=0");
    plant_event("T10.resolution=0");
    ask_ok("out top 4.5");
    ask_ok("out bottom 0.8");
    plant_steps(60);
    board_forget();
}

/* To the end of the job. */
static void designed(void)
{
    ask_ok(BLOCK " design");
    plant_steps(5);
}

static void accepted(void)
{
    ask_ok("proposal accept");
    for (unsigned k = 0; k < 6; k++) { /* the others follow by themselves */
        plant_steps(1);
        pass(100);
    }
}

static void in_force(void)
{
    pasted();
    designed();
    accepted();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 30, setting_of("block2.made"));
}

/* ---- the law ---- */

/* Gains that tools/state-feedback prints, kept in pilot-state.conf. */
static void kept(const char *row, double *values, unsigned n)
{
    char line[256];
    FILE *file = fopen(SCENARIOS "/pilot-state.conf", "r");
    TEST_ASSERT_NOT_NULL(file);
    while (fgets(line, sizeof line, file))
        if (strncmp(line, row, strlen(row)) == 0) {
            char *at = line + strlen(row);
            for (unsigned k = 0; k < n; k++)
                values[k] = strtod(at + 1, &at);
            fclose(file);
            return;
        }
    TEST_FAIL_MESSAGE(row);
}

static void the_law_is_that_of_the_host(void)
{
    double off = 0;
    in_force();
    for (unsigned i = 1; i <= 2; i++) {
        char name[40];
        double f[8], g[2];
        snprintf(name, sizeof name, "set block1.f.%u", i);
        kept(name, f, 8);
        snprintf(name, sizeof name, "set block1.g.%u", i);
        kept(name, g, 2);
        for (unsigned k = 0; k < 8; k++) {
            snprintf(name, sizeof name, "block2.f%u_%u", i, k + 1);
            off = fmax(off, fabs(f[k] - setting_of(name)));
        }
        for (unsigned k = 0; k < 2; k++) {
            snprintf(name, sizeof name, "block2.g%u_%u", i, k + 1);
            off = fmax(off, fabs(g[k] - setting_of(name)));
        }
    }
    printf("weights within %.2g of 174.6, the largest\n", off);
    TEST_ASSERT_TRUE(off < 2e-3 * 174.6);
    TEST_ASSERT_TRUE(shows("2", "  radius = 0.9448"));
    TEST_ASSERT_TRUE(shows("2", "  zeros = 10\n"));
}

static void it_waits_for_somebody_who_accepts_it(void)
{
    pasted();
    designed();
    TEST_ASSERT_TRUE(events_say("block2.made"));
    TEST_ASSERT_EQUAL_FLOAT(0, setting_of("block2.made"));
    ask_ok("proposal");
    TEST_ASSERT_TRUE_MESSAGE(said("block2.g1_1"), board.said);
    ask_ok("proposal reject");
    plant_steps(5);
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("accept"));
    TEST_ASSERT_EQUAL_FLOAT(0, setting_of("block2.g1_1"));
}

/* ---- the column under it ---- */

static double farthest(const char *name, double from, unsigned n)
{
    double most = 0;
    for (unsigned k = 0; k < n; k++) {
        plant_step();
        most = fmax(most, fabs(truly(name) - from));
    }
    return most;
}

static void the_column_is_held_by_it_through_more_feed(void)
{
    in_force();
    double before[2] = {commanded("Lr"), commanded("Qrb")};
    ask_ok("mode top auto");
    ask_ok("mode bottom auto");
    plant_step();
    TEST_ASSERT_TRUE(shows("3", "block3 state on"));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, before[0], commanded("Lr"));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, before[1], commanded("Qrb"));
    plant_steps(120);
    double t1 = truly("T1"), t10 = truly("T10");
    plant_event("F=5.5");
    double top = farthest("T1", t1, 240);
    double end = farthest("T10", t10, 60);
    printf("a tenth more feed: T1 moves %.3f K at most, T10 is %.3f K away after two hours\n", top,
           end);
    TEST_ASSERT_TRUE(top < 0.05); /* 0.1 under the PIs (test_state_feedback.py) */
    TEST_ASSERT_TRUE(end < 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 1.1 * before[0], commanded("Lr"));
    TEST_ASSERT_TRUE(shows("3", "block3 state on"));
}

static void stop_withdraws_a_law_that_nobody_has_accepted(void)
{
    pasted();
    designed();
    ask_ok(BLOCK " stop");
    plant_steps(2);
    TEST_ASSERT_TRUE(said("PROPOSAL_WITHDRAWN state_law 2"));
    ask_refused("proposal accept", "STATE");
}

static void another_law_comes_into_force_without_a_bump(void)
{
    in_force();
    ask_ok("mode top auto");
    ask_ok("mode bottom auto");
    plant_steps(60);
    ask_ok("set block2.tau.1 60,60");
    plant_steps(5);
    designed();
    double before[2] = {commanded("Lr"), commanded("Qrb")};
    ask_ok("proposal accept");
    for (unsigned k = 0; k < 6; k++) {
        plant_steps(1);
        TEST_ASSERT_DOUBLE_WITHIN(0.02, before[0], commanded("Lr"));
        TEST_ASSERT_DOUBLE_WITHIN(0.005, before[1], commanded("Qrb"));
        TEST_ASSERT_TRUE(shows("3", "block3 state on"));
    }
    TEST_ASSERT_EQUAL_FLOAT(30, setting_of("block2.made"));
    double asked = truly("T1") + 0.03; /* further away it is at its limits: 30 l/h per K */
    char line[40];
    snprintf(line, sizeof line, "sp top %.4f", asked);
    ask_ok(line);
    plant_steps(40);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, asked, truly("T1"));
}

static void without_a_law_the_loops_own_controllers_act(void)
{
    pasted();
    ask_ok("mode top auto");
    plant_steps(2);
    TEST_ASSERT_TRUE(events_say("BLOCK_GAVE_UP no_law"));
    designed();
    accepted();
    ask_ok("block 3 on");
    plant_steps(3);
    TEST_ASSERT_TRUE(shows("3", "block3 state on"));
}

static void for_another_interval_it_is_no_law(void)
{
    pasted();
    ask_ok("set block2.period 60");
    designed();
    accepted();
    ask_ok("mode top auto");
    plant_steps(4);
    TEST_ASSERT_TRUE_MESSAGE(events_say("BLOCK_GAVE_UP interval"), board.said);
}

static void what_was_saved_is_there_after_a_restart(void)
{
    in_force();
    double g = setting_of("block2.g1_1");
    ask_ok("save");
    power_on();
    pass(2500);
    TEST_ASSERT_TRUE(said("STORAGE_LOADED"));
    type("mode machine\n");
    pass(100);
    TEST_ASSERT_EQUAL_DOUBLE(g, setting_of("block2.g1_1"));
    TEST_ASSERT_EQUAL_FLOAT(30, setting_of("block2.made"));
}

/* ---- refused in words ---- */

static void no_law(const char *set, const char *words)
{
    pasted();
    ask_ok(set);
    designed();
    TEST_ASSERT_TRUE_MESSAGE(shows("2", words), board.said);
    TEST_ASSERT_TRUE(events_say("block2.refused"));
    plant_power_off();
}

static void what_has_no_law_says_why(void)
{
    no_law("set block2.left 1", "no law: inputs must be those that F needs: they leave out more");
    no_law("set block2.ti.1 5,5", "no law: ti must be longer: with it the loop is not stable");
    no_law("set block2.place.8 11,0", "no law: inputs must be of stages of their own");
}

static void what_cannot_be_is_refused_with_what_would_be(void)
{
    in_force();
    ask_refused("set block2.place.1 13,0", "RANGE");
    TEST_ASSERT_TRUE_MESSAGE(strstr(reply[0], "block2.place"), reply[0]);
    ask_refused("set block2.is.10 boilup", "RANGE");
    TEST_ASSERT_TRUE_MESSAGE(strstr(reply[0], "heat or boilup"), reply[0]);
    ask_refused("set block3.ti.1 600,600,0,0", "RANGE");
    TEST_ASSERT_TRUE_MESSAGE(strstr(reply[0], "block3.law"), reply[0]);
    ask_refused("set block3.inputs T1,T10", "RANGE");
    TEST_ASSERT_TRUE_MESSAGE(strstr(reply[0], "no more columns than there are inputs"), reply[0]);
}

/* ---- faults while it is being found ---- */

/* Under way: told, and the job has its memory. */
static void under_way(void)
{
    pasted();
    ask_ok(BLOCK " design");
    plant_steps(2);
}

static void comes_out_with(const char *words)
{
    plant_steps(6);
    TEST_ASSERT_TRUE_MESSAGE(shows("2", words), board.said);
    TEST_ASSERT_EQUAL_FLOAT(0, setting_of("block2.made"));
    plant_power_off();
}

static void an_experiment_that_has_the_workspace_keeps_it(void)
{
    static const char *const lines[] = {"begin",
                                        "set block4.kind experiment",
                                        "set block4.inputs T1,T10,Lr,Qrb",
                                        "set block4.bits 5",
                                        "set block4.amplitude.1 0.2",
                                        "set block4.amplitude.2 0.02",
                                        "set block4.band.1 5",
                                        "set block4.band.2 5",
                                        "apply",
                                        "block 4 start"};
    pasted();
    for (unsigned k = 0; k < sizeof lines / sizeof lines[0]; k++)
        ask_ok(lines[k]);
    plant_steps(3);
    ask_ok(BLOCK " design");
    comes_out_with("no law: no workspace; experiment has it; `block N stop` frees it");
}

static void another_table_a_stop_and_other_settings_end_it(void)
{
    under_way();
    ask_ok("begin");
    ask_ok("set block1.kind -");
    ask_ok("set block2.column 0");
    ask_ok("apply");
    comes_out_with("no law: settings or the table have changed while it was being found");
    under_way();
    ask_ok("set block2.tau.1 60,60");
    comes_out_with("no law: settings or the table have changed while it was being found");
    under_way();
    ask_ok(BLOCK " stop");
    comes_out_with("no law: stopped");
}

static void an_apply_of_others_and_a_silent_link_do_not(void)
{
    under_way();
    ask_ok("set loop1.gain 11");
    plant_steps(6);
    TEST_ASSERT_TRUE_MESSAGE(shows("2", "  stage = 3"), board.said);
    plant_power_off();
    under_way();
    board.mute = true;
    pass(5000);
    plant_connect();
    plant_steps(6);
    TEST_ASSERT_TRUE_MESSAGE(shows("2", "  stage = 3"), board.said);
}

static void a_power_cut_while_it_is_found_leaves_nothing_of_it(void)
{
    pasted();
    ask_ok("save");
    ask_ok(BLOCK " design");
    plant_steps(2);
    power_on();
    pass(2500);
    type("mode machine\n");
    pass(100);
    TEST_ASSERT_TRUE(shows("2", "  stage = 0"));
    TEST_ASSERT_EQUAL_FLOAT(0, setting_of("block2.made"));
}

static void accepted_once_it_is_whole(void)
{
    pasted();
    designed();
    ask_ok("proposal accept");
    ask_ok("save");
    plant_power_off();
    plant_power_on("pilot", TICK_MS, 3, 0);
    measures();
    pass(2500);
    type("mode machine\n");
    pass(100);
    TEST_ASSERT_TRUE(setting_of("block2.g1_1") < -170);
    TEST_ASSERT_TRUE(setting_of("block2.f2_8") != 0);
    TEST_ASSERT_EQUAL_FLOAT(30, setting_of("block2.made"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_law_is_that_of_the_host);
    RUN_TEST(it_waits_for_somebody_who_accepts_it);
    RUN_TEST(the_column_is_held_by_it_through_more_feed);
    RUN_TEST(stop_withdraws_a_law_that_nobody_has_accepted);
    RUN_TEST(another_law_comes_into_force_without_a_bump);
    RUN_TEST(without_a_law_the_loops_own_controllers_act);
    RUN_TEST(for_another_interval_it_is_no_law);
    RUN_TEST(what_was_saved_is_there_after_a_restart);
    RUN_TEST(what_has_no_law_says_why);
    RUN_TEST(what_cannot_be_is_refused_with_what_would_be);
    RUN_TEST(an_experiment_that_has_the_workspace_keeps_it);
    RUN_TEST(another_table_a_stop_and_other_settings_end_it);
    RUN_TEST(an_apply_of_others_and_a_silent_link_do_not);
    RUN_TEST(a_power_cut_while_it_is_found_leaves_nothing_of_it);
    RUN_TEST(accepted_once_it_is_whole);
    return UNITY_END();
}
