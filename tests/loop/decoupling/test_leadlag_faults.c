/* The element `leadlag` on the whole firmware: a plant of three states with a measured disturbance, both loops under their own PIs, feedforward
 * to both MVs. */
#include <math.h>

#include "plant_board.h"

#define TICK_MS 60000u

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

/* Moves that the disturbance needs at rest: of u1 -0.4015, of u2 0.3212 for each unit of it. */
static const char *const element[] = {"begin",
                                      "set block1.kind -",
                                      "set block1.kind leadlag",
                                      "set block1.inputs y4",
                                      "set block1.points u1,u2",
                                      "set block1.from.1 1,1,0,0,0,0,0,0",
                                      "set block1.to.1 1,2,0,0,0,0,0,0",
                                      "set block1.gain.1 -0.1004,0.0803,0,0,0,0,0,0",
                                      "set block1.hold 300",
                                      "apply",
                                      NULL};

static void begin(double noise, bool with_element)
{
    plant_power_on(DECOUPLING "/three-states.json", TICK_MS, 3, noise);
    ask_file(DECOUPLING "/three-states.conf");
    for (unsigned i = 0; element[i]; i++)
        ask_ok(element[i]);
    for (unsigned k = 1; k <= 4; k++) {
        char line[40];
        snprintf(line, sizeof line, "set meas%u.frozen 0", k);
        ask_ok(line);
    }
    if (!with_element)
        ask_ok("block 1 off");
    plant_connect();
    plant_steps(2);
    ask_ok("out one 0");
    ask_ok("out two 0");
    plant_steps(30);
    ask_ok("mode one auto");
    ask_ok("mode two auto");
    ask_ok("sp one 0.2");
    ask_ok("sp two 0.1");
    plant_steps(300);
    board_forget();
}

static double absolute_error(unsigned steps)
{
    double sum = 0;
    for (unsigned k = 0; k < steps; k++) {
        plant_step();
        sum += fabs(truly("y1") - 0.2) + fabs(truly("y2") - 0.1);
    }
    return sum;
}

static void it_takes_most_of_a_disturbance_away(void)
{
    double error[2];
    for (unsigned with = 0; with < 2; with++) {
        begin(0, with);
        plant_event("d=0.5");
        error[with] = absolute_error(120);
        plant_power_off();
    }
    printf("absolute errors: %.3f without, %.3f with it\n", error[0], error[1]);
    TEST_ASSERT_TRUE(error[1] < 0.5 * error[0]);
}

static void moves_less_than(double most, const double before[2], const char *what)
{
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(most, before[0], commanded("u1"), what);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(most, before[1], commanded("u2"), what);
}

static void on_off_and_other_gains_move_no_mv(void)
{
    static const char *const asked[] = {"block 1 off", "block 1 on", NULL};
    static const char *const gains[] = {"begin", "set block1.gain.1 -0.05,0.04,0,0,0,0,0,0",
                                        "set block1.lag.1 300,300,0,0,0,0,0,0", "apply", NULL};
    begin(0, true);
    plant_event("d=0.5");
    plant_steps(300);
    double before[2] = {commanded("u1"), commanded("u2")};
    for (unsigned i = 0; asked[i]; i++) {
        ask_ok(asked[i]);
        plant_steps(3);
        moves_less_than(0.01, before, asked[i]);
    }
    for (unsigned i = 0; gains[i]; i++)
        ask_ok(gains[i]);
    plant_steps(2);
    moves_less_than(0.01, before, "other gains");
    plant_steps(200);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, truly("y1"));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1, truly("y2"));
}

/* Each in force for a while before the next. */
static void no_other_setting_moves_an_mv(void)
{
    static const char *const settings[] = {"washout 3000",
                                           "washout 600",
                                           "washout 0",
                                           "lead.1 120,60,0,0,0,0,0,0",
                                           "dead.1 180,0,0,0,0,0,0,0",
                                           "reference.1 0.3,0.3,0,0,0,0,0,0",
                                           "hi.1 0.001,0.001,1,1",
                                           "hi.1 1,1,1,1",
                                           "rate.1 0.0001,0.0001,0,0",
                                           "rate.1 0,0,0,0",
                                           "from.1 1,0,0,0,0,0,0,0",
                                           "to.1 2,0,0,0,0,0,0,0",
                                           "hold 0"};
    begin(0, true);
    plant_event("d=0.5");
    plant_steps(300);
    for (unsigned k = 0; k < sizeof settings / sizeof settings[0]; k++) {
        char line[80];
        double before[2] = {commanded("u1"), commanded("u2")};
        snprintf(line, sizeof line, "set block1.%s", settings[k]);
        ask_ok("begin");
        ask_ok(line);
        ask_ok("apply");
        for (unsigned n = 0; n < 3; n++) {
            plant_step();
            moves_less_than(0.01, before, settings[k]);
        }
        plant_steps(300);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01, 0.2, truly("y1"), settings[k]);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01, 0.1, truly("y2"), settings[k]);
    }
}

/* Held for five minutes, then the loops go on alone from where their MVs are. */
static void a_disturbance_that_is_lost_moves_no_mv(void)
{
    static const char *const how[][2] = {{"y4.quality=3", "y4.quality=0"},
                                         {"y4.quality=2", "y4.quality=0"},
                                         {"y4.nan=1", "y4.nan=0"}};
    for (unsigned k = 0; k < 3; k++) {
        begin(0, true);
        plant_event("d=0.5");
        plant_steps(300);
        double before[2] = {commanded("u1"), commanded("u2")};
        plant_event(how[k][0]);
        for (unsigned n = 0; n < 30; n++) {
            plant_step();
            moves_less_than(0.02, before, how[k][0]);
        }
        TEST_ASSERT_TRUE_MESSAGE(events_say("BLOCK_GAVE_UP") || events_say("MEASUREMENT_BAD"),
                                 how[k][0]);
        TEST_ASSERT_TRUE(loop_is("one", "auto") && loop_is("two", "auto"));
        plant_event("d=0");
        plant_event(how[k][1]);
        plant_steps(5);
        double again[2] = {commanded("u1"), commanded("u2")};
        ask_ok("block 1 on");
        plant_step();
        moves_less_than(0.3, again, "on again"); /* the loops' own answer to d goes on */
        plant_steps(400);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, truly("y1"));
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1, truly("y2"));
        plant_power_off();
    }
}

/* A reading that lies by half its span: wrong by what the limits allow, until the loops have taken it up. */
static void a_disturbance_that_lies_costs_no_more_than_the_limits_allow(void)
{
    begin(0, true);
    ask_ok("begin");
    ask_ok("set block1.lo.1 -0.02,-0.02,-1,-1");
    ask_ok("set block1.hi.1 0.02,0.02,1,1");
    ask_ok("apply");
    plant_steps(10);
    double before[2] = {commanded("u1"), commanded("u2")};
    plant_event("y4.bias=0.9");
    plant_step();
    moves_less_than(0.02 * 8 + 0.02, before, "the first step");
    plant_steps(400);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, truly("y1"));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1, truly("y2"));
}

static void settings_are_stored_and_read_again(void)
{
    begin(0, true);
    ask_ok("save");
    pass(2000);
    memory_port_reset(HAL_RESET_POWER_ON);
    board_run();
    type("mode machine\n");
    pass(3000);
    ask_ok("load");
    ask_ok("get block1.gain.1");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reply[0], "-0.1004,0.0803,0,0"), reply[0]);
    ask_ok("get block1.hold");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reply[0], "300"), reply[0]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_takes_most_of_a_disturbance_away);
    RUN_TEST(on_off_and_other_gains_move_no_mv);
    RUN_TEST(no_other_setting_moves_an_mv);
    RUN_TEST(a_disturbance_that_is_lost_moves_no_mv);
    RUN_TEST(a_disturbance_that_lies_costs_no_more_than_the_limits_allow);
    RUN_TEST(settings_are_stored_and_read_again);
    return UNITY_END();
}
