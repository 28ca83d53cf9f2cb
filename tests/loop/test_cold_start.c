/* The cold pilot column started to two-temperature control, and shut down, by commands at the console alone. */
#include <math.h>

#include "plant_board.h"

void setUp(void) {}
void tearDown(void) {}

static void power_up(uint32_t tick_ms)
{
    plant_power_on("pilot-cold", tick_ms, 3, 1.0);
    ask_file("../host_sim/scenarios/pilot-cold.conf");
    ask_file("../host_sim/scenarios/pilot-cold-sequences.conf");
    plant_connect();
    plant_steps(3);
    board_forget();
}

static bool seq_is(const char *headline)
{
    ask_ok("seq");
    return strcmp(reply[0], headline) == 0;
}

/* Goes on until `seq` says so; the plant time then, min. */
static double until(const char *headline, double limit_min)
{
    double begin = (double)board.time_ms / 60000.0;
    while (!seq_is(headline)) {
        char message[200];
        snprintf(message, sizeof message, "%s: wanted %s", reply[0], headline);
        TEST_ASSERT_TRUE_MESSAGE((double)board.time_ms / 60000.0 - begin < limit_min, message);
        plant_step();
    }
    double now = (double)board.time_ms / 60000.0;
    printf("  %6.1f min  %s\n", now, headline);
    return now;
}

static void start_up(void)
{
    ask_ok("seq start");
    until("start running at step 3", 1);
    until("start running at step 5", 3);
    until("start running at step 8", 20);
    TEST_ASSERT_TRUE(truly("LB_true") > 15);
    until("start running at step 9", 30);
    ask_ok("status");
    TEST_ASSERT_TRUE(said("LB = ") && said("less its offset 8"));
    double total = until("start running at step 10", 15);
    TEST_ASSERT_TRUE(truly("T1") > 80);
    total = until("start confirm at step 11", 20) - total;
    TEST_ASSERT_TRUE(total > 10 && total < 15); /* Folami's total reflux */
    TEST_ASSERT_EQUAL_DOUBLE(0, truly("vD"));
    plant_steps(5);
    ask_ok("seq confirm");
    until("start running at step 12", 1);
    until("start running at step 17", 3);
    until("start done at step 21", 61);
}

static void shut_down(void)
{
    ask_ok("seq stop");
    until("stop running at step 26", 1);
    TEST_ASSERT_EQUAL_DOUBLE(0, commanded("Qrb"));
    until("stop running at step 27", 20);
    double water = until("stop running at step 28", 35);
    TEST_ASSERT_EQUAL_DOUBLE(0, commanded("vCW"));
    double cold = until("stop done at step 28", 300) - water + 30;
    TEST_ASSERT_TRUE(cold > 150 && cold < 240); /* Folami: about 3 h to about 30 degC */
    TEST_ASSERT_TRUE(truly("TB") < 30.5);
}

static void from_cold_to_control_and_back(uint32_t tick_ms)
{
    power_up(tick_ms);
    printf("pilot-cold, a sample every %u s\n", (unsigned)tick_ms / 1000);
    start_up();
    double worst[3] = {0, 0, 0};
    plant_steps(5400000 / tick_ms); /* one hour and a half to settle, one to look at */
    for (unsigned n = 0; n < 3600000 / tick_ms; n++) {
        plant_step();
        worst[0] = fmax(worst[0], fabs(truly("T1") - 87.15));
        worst[1] = fmax(worst[1], fabs(truly("T10") - 106));
        worst[2] = fmax(worst[2], fabs(truly("LB_true") - 15));
    }
    printf("  in control: T1 within %.2f K, T10 within %.2f K, true level within %.2f cm\n",
           worst[0], worst[1], worst[2]);
    TEST_ASSERT_TRUE(worst[0] < 0.15);
    TEST_ASSERT_TRUE(worst[1] < 0.3);
    TEST_ASSERT_TRUE(worst[2] < 1.0);
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("top auto") && said("bottom auto") && said("sump auto"));
    ask_ok("alarm");
    TEST_ASSERT_EQUAL(1, n_reply); /* nothing is wrong */
    shut_down();
    ask_ok("status");
    TEST_ASSERT_FALSE(said("less its offset"));
    ask_ok("loop");
    TEST_ASSERT_FALSE(said(" auto "));
    plant_power_off();
}

static void it_is_started_controlled_and_shut_down(void)
{
    from_cold_to_control_and_back(10000);
}

static void also_with_the_thirty_seconds_of_the_source(void)
{
    from_cold_to_control_and_back(30000);
}

static void every_manipulated_variable_can_be_driven_by_hand(void)
{
    static const struct {
        const char *name;
        double value;
    } outputs[] = {{"vLr", 30}, {"Qrb", 0.5}, {"vD", 20}, {"vB", 15}, {"vF", 60}, {"vCW", 80}};
    power_up(10000);
    for (unsigned j = 0; j < sizeof outputs / sizeof outputs[0]; j++) {
        char line[60];
        snprintf(line, sizeof line, "out %s %g", outputs[j].name, outputs[j].value);
        ask_ok(line);
        plant_steps(3);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, outputs[j].value, commanded(outputs[j].name));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, outputs[j].value, truly(outputs[j].name));
    }
    plant_power_off();
}

static void held_half_way_a_person_drives_and_lets_it_go_on(void)
{
    power_up(10000);
    ask_ok("seq start");
    until("start running at step 10", 60);
    plant_steps(20);
    ask_ok("seq hold");
    ask_ok("out vLr 55");
    plant_steps(60);
    TEST_ASSERT_TRUE(seq_is("start held at step 10: by the operator"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 55, truly("vLr"));
    ask_ok("seq go");
    until("start confirm at step 11", 12);
    plant_power_off();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_is_started_controlled_and_shut_down);
    RUN_TEST(also_with_the_thirty_seconds_of_the_source);
    RUN_TEST(every_manipulated_variable_can_be_driven_by_hand);
    RUN_TEST(held_half_way_a_person_drives_and_lets_it_go_on);
    return UNITY_END();
}
