/* The worked family of docs/inside/adding-a-controller.md at work: its points, its loops, and what happens without it. */
#include "worked_family_bench.h"

void setUp(void) {}
void tearDown(void)
{
    plant_power_off();
}

/* ---- the points ---- */

static void a_point_is_what_is_measured_a_dead_time_later(void)
{
    double top[80], bottom[80], top_ahead[80], bottom_ahead[80];
    column_at_rest(0);
    for (unsigned k = 0; k < 80; k++) {
        if (k == 10)
            ask_ok("out top 2.05");
        if (k == 30)
            ask_ok("out bottom 1.75");
        plant_step();
        top[k] = reads("xD");
        bottom[k] = reads("xB");
        top_ahead[k] = reads("xD_ahead");
        bottom_ahead[k] = reads("xB_ahead");
    }
    TEST_ASSERT_TRUE(fabs(top[79] - top[0]) > 0.3);
    for (unsigned k = 0; k + 3 < 80; k++) { /* dead times of 1 and 3 min; readings are rounded */
        TEST_ASSERT_DOUBLE_WITHIN(2 * XD_RESOLUTION, top[k + 1], top_ahead[k]);
        TEST_ASSERT_DOUBLE_WITHIN(2 * XB_RESOLUTION, bottom[k + 3], bottom_ahead[k]);
    }
}

static void the_points_are_in_the_log_and_can_be_alarmed(void)
{
    column_at_rest(0);
    ask_ok("begin");
    ask_ok("set alarm1.on xB_ahead");
    ask_ok("set alarm1.side lo");
    ask_ok("set alarm1.limit 0");
    ask_ok("apply");
    ask_ok("log on");
    TEST_ASSERT_TRUE(said("xD_ahead") && said("xB_ahead"));
    ask_ok("out bottom 1.8");
    board_forget();
    plant_steps(20);
    TEST_ASSERT_EQUAL_UINT(20, times_said("T,"));
    TEST_ASSERT_TRUE(said("ALARM_ON xB_ahead.lo"));
}

/* Effect of the readings on d alone, where nothing comes unseen: a scalar filter for each measurement, whose gain has a formula. */
static double scalar_gain(double noise, double drift)
{
    double q = drift * drift, p = (q + sqrt(q * q + 4 * q * noise * noise)) / 2;
    return p / (p + noise * noise);
}

static void the_gain_is_the_filters_from_its_declared_tick_on(void)
{
    plant_power_on("wood-berry", TICK_MS, 1, 0);
    ask_file(WORKED_FAMILY_CONF);
    sets("block1.unseen", 0);
    plant_connect();
    plant_step(); /* asked for */
    for (unsigned k = 1; k < 20; k++) {
        TEST_ASSERT_EQUAL_DOUBLE(0, inside("observer", "gained"));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, inside("observer", "gain_1"));
        plant_step();
    }
    plant_step();
    TEST_ASSERT_EQUAL_DOUBLE(1, inside("observer", "gained"));
    double gain = scalar_gain(0.001, 0.0003);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * gain, gain, inside("observer", "gain_1"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * gain, gain, inside("observer", "gain_2"));
}

static void a_change_of_its_settings_asks_for_another_gain_and_the_old_one_goes_on(void)
{
    column_at_rest(0);
    double before = inside("observer", "gain_1");
    ask_ok("set block1.drift.1 0.002,0.002");
    plant_steps(20);
    TEST_ASSERT_EQUAL_DOUBLE(before, inside("observer", "gain_1"));
    plant_step();
    TEST_ASSERT_TRUE(inside("observer", "gain_1") > before + 0.1);
    ask_ok("set alarm1.limit 3"); /* nothing of it */
    plant_step();
    TEST_ASSERT_FALSE(said("job running"));
    ask_ok("block");
    TEST_ASSERT_FALSE(said("job running"));
}

/* Beyond what float tells apart, and where nothing stands still for as long as it may look. */
static void a_gain_that_is_not_found_is_not_used(void)
{
    static const char *const settings[2][5] = {
        {"set block1.gain.1 100,100", "set block1.gain.2 100,100", "set block1.unseen 0.02",
         "set block1.noise.1 0.0001,0.0001", "set block1.drift.1 0.00001,0.00001"},
        {"set block1.noise.1 0.1,0.1", "set block1.drift.1 0.00001,0.00001"}};
    for (unsigned k = 0; k < 2; k++) {
        if (k)
            plant_power_off();
        plant_power_on("wood-berry", TICK_MS, 1, 1);
        ask_file(WORKED_FAMILY_CONF);
        for (unsigned i = 0; i < 5 && settings[k][i]; i++)
            ask_ok(settings[k][i]);
        plant_connect();
        plant_steps(60);
        TEST_ASSERT_EQUAL_DOUBLE(0, inside("observer", "gained"));
        TEST_ASSERT_FALSE(said("job running"));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, inside("observer", "gain_1"));
    }
}

static void while_it_is_frozen_readings_are_not_believed(void)
{
    column_at_rest(0);
    ask_ok("block observer freeze 600");
    plant_step();
    plant_event("xD.bias=1"); /* somebody calibrates */
    plant_steps(8);
    TEST_ASSERT_DOUBLE_WITHIN(2 * XD_RESOLUTION, 96.25, reads("xD_ahead"));
    TEST_ASSERT_TRUE(reads_as("xD_ahead", "uncertain"));
    plant_event("xD.bias=0");
    ask_ok("block observer thaw");
    plant_steps(2);
    TEST_ASSERT_TRUE(reads_as("xD_ahead", "good"));
}

static void it_says_that_a_reading_was_not_expected(void)
{
    column_at_rest(1);
    in_auto();
    setpoint("top", 97);
    plant_steps(60);
    TEST_ASSERT_FALSE(said("BLOCK_ALARM")); /* what it knows of is none */
    plant_event("xB.bias=1");
    plant_step();
    TEST_ASSERT_TRUE(said("BLOCK_ALARM block1.surprise"));
    ask_ok("events");
    TEST_ASSERT_TRUE(said("BLOCK_EVENT block1.gained"));
}

/* ---- the loops ---- */

static void no_error_is_left(const char *loop, double wanted)
{
    bool top = strcmp(loop, "top") == 0;
    char message[80];
    double is = truly(top ? "xD" : "xB");
    snprintf(message, sizeof message, "%s: %g instead of %g", loop, is, wanted);
    TEST_ASSERT_TRUE_MESSAGE(fabs(is - wanted) <= 2 * (top ? XD_RESOLUTION : XB_RESOLUTION),
                             message);
}

static void setpoints_are_followed_without_offset(void)
{
    column_at_rest(0);
    in_auto();
    setpoint("top", 97);
    setpoint("bottom", 1);
    plant_steps(180);
    no_error_is_left("top", 97);
    no_error_is_left("bottom", 1);
    plant_event(
        "xD.bias=-0.5"); /* as if the feed had changed: the sensor reads low, and is valid */
    plant_event("xB.bias=0.5");
    plant_steps(240);
    no_error_is_left("top", 97.5);
    no_error_is_left("bottom", 0.5);
}

static struct deviation step_of(const char *loop, bool block)
{
    column_at_rest(0);
    in_auto();
    if (!block) {
        ask_ok("block state_feedback off");
        plant_steps(60);
    }
    bool top = strcmp(loop, "top") == 0;
    setpoint(loop, top ? 97.25 : 1.5);
    struct deviation d = deviates(top ? 97.25 : 96.25, top ? 0.5 : 1.5, 200);
    plant_power_off();
    return d;
}

/* The figure on the page. A PID cannot hold the other loop off: that the two together deviate less is what the block is for. */
static void both_loops_together_deviate_less_than_with_pids(void)
{
    static const char *const loops[] = {"top", "bottom"};
    for (unsigned k = 0; k < 2; k++) {
        struct deviation pids = step_of(loops[k], false), block = step_of(loops[k], true);
        printf("IAE, %%w min, setpoint of %-6s up by 1: PIDs top %5.2f bottom %5.2f, block top "
               "%5.2f bottom %5.2f\n",
               loops[k], pids.top, pids.bottom, block.top, block.bottom);
        TEST_ASSERT_TRUE(block.top + block.bottom < pids.top + pids.bottom);
    }
    column_at_rest(0);
}

static void a_third_loop_has_a_point_as_its_pv(void)
{
    static const char *const states[] = {"on", "off"};
    for (unsigned k = 0; k < 2; k++) { /* over the block, and over the PID that takes its place */
        char line[40];
        if (k)
            plant_power_off();
        column_at_rest(0);
        in_auto();
        snprintf(line, sizeof line, "block state_feedback %s", states[k]);
        ask_ok(line);
        ask_ok("mode trim auto");
        plant_step();
        ask_ok("mode bottom cascade");
        plant_steps(2);
        setpoint("trim", 1.2);
        plant_steps(400);
        no_error_is_left("bottom", 1.2);
        no_error_is_left("top", 96.25);
        TEST_ASSERT_DOUBLE_WITHIN(2 * XB_RESOLUTION, 1.2, reads("xB_ahead"));
    }
}

static void with_one_loop_in_manual_the_other_is_followed_all_the_same(void)
{
    column_at_rest(0);
    in_auto();
    ask_ok("mode bottom manual");
    plant_steps(2);
    double steam = commanded("S");
    setpoint("top", 97);
    plant_steps(240);
    no_error_is_left("top", 97);
    TEST_ASSERT_EQUAL_DOUBLE(steam, commanded("S"));
}

static void an_output_at_its_limit_does_not_cost_the_other_loop_its_setpoint(void)
{
    column_at_rest(0);
    ask_ok("set mv1.max 2");
    in_auto();
    setpoint("top", 99); /* out of reach */
    plant_steps(400);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2, commanded("R"));
    no_error_is_left("bottom", 0.5);
    /* For hours: nothing has wound up. One step of its own feedback is enough. */
    setpoint("top", 96.25);
    plant_steps(2);
    TEST_ASSERT_TRUE(commanded("R") < 2 - 0.01);
    plant_steps(240);
    no_error_is_left("top", 96.25);
    no_error_is_left("bottom", 0.5);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_point_is_what_is_measured_a_dead_time_later);
    RUN_TEST(the_points_are_in_the_log_and_can_be_alarmed);
    RUN_TEST(the_gain_is_the_filters_from_its_declared_tick_on);
    RUN_TEST(a_change_of_its_settings_asks_for_another_gain_and_the_old_one_goes_on);
    RUN_TEST(a_gain_that_is_not_found_is_not_used);
    RUN_TEST(while_it_is_frozen_readings_are_not_believed);
    RUN_TEST(it_says_that_a_reading_was_not_expected);
    RUN_TEST(setpoints_are_followed_without_offset);
    RUN_TEST(both_loops_together_deviate_less_than_with_pids);
    RUN_TEST(a_third_loop_has_a_point_as_its_pv);
    RUN_TEST(with_one_loop_in_manual_the_other_is_followed_all_the_same);
    RUN_TEST(an_output_at_its_limit_does_not_cost_the_other_loop_its_setpoint);
    return UNITY_END();
}
