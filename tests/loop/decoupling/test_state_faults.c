/* Faults under the kind `state`: a plant whose three states are measured, and a disturbance; both loops in automatic, one by hand, one out of reach of
 * its MV. To add a fault: a row of faults[]. */
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

/* ---- modes of operation ---- */

static void both(void)
{
    ask_ok("mode one auto");
    ask_ok("mode two auto");
    ask_ok("sp one 0.2");
    ask_ok("sp two 0.1");
}

static void one_by_hand(void)
{
    ask_ok("mode one auto");
    ask_ok("sp one 0.2");
}

static void clipped(void)
{
    both();
    ask_ok("set mv1.max 0.1");
}

static const struct mode {
    const char *name;
    void (*enter)(void);
    const char *two; /* mode of that loop */
} modes[] = {{"both in auto", both, "auto"},
             {"one by hand", one_by_hand, "manual"},
             {"clipped", clipped, "auto"}};
#define MODES (sizeof modes / sizeof modes[0])

/* ---- faults ---- */

static void silent_link(void)
{
    board.mute = true;
    pass(5000);
}

/* GIVES_UP: the loops' own PIs act. */
enum end { GOES_ON, GIVES_UP, ONE_LOST, SAFE };

static const struct fault {
    const char *name, *begin, *end; /* of the instruments */
    void (*act)(void), (*undo)(void);
    const char *event;
    enum end state;
} faults[] = {
    {"a state flagged bad", "y3.quality=2", "y3.quality=0", NULL, NULL, "BLOCK_GAVE_UP", GIVES_UP},
    {"a state missing", "y3.quality=3", "y3.quality=0", NULL, NULL, "BLOCK_GAVE_UP", GIVES_UP},
    {"a state not a number", "y3.nan=1", "y3.nan=0", NULL, NULL, "BLOCK_GAVE_UP", GIVES_UP},
    {"a state frozen", "y3.frozen=1", "y3.free=1", NULL, NULL, "BLOCK_GAVE_UP", GIVES_UP},
    {"the disturbance lost", "y4.quality=3", "y4.quality=0", NULL, NULL, "BLOCK_GAVE_UP", GIVES_UP},
    {"a measurement of a loop lost", "y1.quality=3", "y1.quality=0", NULL, NULL,
     "MEASUREMENT_BAD y1", ONE_LOST},
    {"samples lost at random", "y3.dropout=0.2", "y3.dropout=0", NULL, NULL, NULL, GOES_ON},
    {"a state that lies", "y3.bias=0.05", "y3.bias=0", NULL, NULL, NULL, GOES_ON},
    {"valve stuck", "u2.stuck=0.5", "u2.free=1", NULL, NULL, NULL, GOES_ON},
    {"valve half as strong", "u1.gain=0.5", "u1.gain=1", NULL, NULL, NULL, GOES_ON},
    {"disturbance", "d=0.5", "d=0", NULL, NULL, NULL, GOES_ON},
    {"link silent", NULL, NULL, silent_link, plant_connect, "LINK_DOWN", SAFE},
};
#define FAULTS (sizeof faults / sizeof faults[0])

/* ---- the run ---- */

static void begin(const struct mode *mode)
{
    plant_power_on(DECOUPLING "/three-states.json", TICK_MS, 3, 1);
    ask_file(DECOUPLING "/three-states.conf");
    plant_connect();
    plant_steps(2);
    ask_ok("out one 0");
    ask_ok("out two 0");
    plant_steps(30);
    mode->enter();
    plant_steps(60);
    board_forget();
}

static void bounded_steps(unsigned n, const char *where)
{
    for (unsigned k = 0; k < n; k++) {
        plant_step();
        TEST_ASSERT_TRUE_MESSAGE(fabs(commanded("u1")) <= 4 && fabs(commanded("u2")) <= 4, where);
        TEST_ASSERT_TRUE_MESSAGE(isfinite(truly("y1")) && fabs(truly("y1")) < 4, where);
    }
}

static void back_to_auto(const char *loop, const char *where)
{
    char line[40];
    double before[2] = {commanded("u1"), commanded("u2")};
    snprintf(line, sizeof line, "mode %s auto", loop);
    ask_ok(line);
    plant_step();
    /* Two hundredths of span, what noise makes of weights of 3. */
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.16, before[0], commanded("u1"), where);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.16, before[1], commanded("u2"), where);
}

static void repair(const struct fault *fault, const struct mode *mode, const char *where)
{
    if (fault->end)
        plant_event(fault->end);
    if (fault->undo)
        fault->undo();
    ask_ok("set mv1.max 4");
    plant_steps(3);
    if (fault->state == GIVES_UP) {
        double before[2] = {commanded("u1"), commanded("u2")};
        ask_ok("block 1 on");
        plant_step();
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.16, before[0], commanded("u1"), where);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.16, before[1], commanded("u2"), where);
    }
    if (fault->state == SAFE) {
        TEST_ASSERT_TRUE_MESSAGE(loop_is("two", "manual"), where);
        ask_ok("out one 0");
        ask_ok("out two 0");
        plant_steps(30);
        back_to_auto("two", where);
    }
    if (fault->state == SAFE || fault->state == ONE_LOST) {
        TEST_ASSERT_TRUE_MESSAGE(loop_is("one", "manual"), where); /* by itself nothing begins */
        back_to_auto("one", where);
    }
    ask_ok("sp one 0.2");
    bool two = loop_is("two", "auto");
    if (two)
        ask_ok("sp two 0.1");
    bounded_steps(150, where);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.02, 0.2, truly("y1"), where);
    if (two)
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.02, 0.1, truly("y2"), where);
    (void)mode;
}

static void every_fault_in_every_mode_ends_as_it_must(void)
{
    unsigned combinations = 0;
    for (unsigned m = 0; m < MODES; m++)
        for (unsigned k = 0; k < FAULTS; k++, combinations++) {
            const struct fault *fault = &faults[k];
            char where[120];
            snprintf(where, sizeof where, "%s, %s", modes[m].name, fault->name);
            begin(&modes[m]);
            if (fault->begin)
                plant_event(fault->begin);
            if (fault->act)
                fault->act();
            bounded_steps(fault->state == SAFE ? 5 : 40, where);
            if (fault->event)
                TEST_ASSERT_TRUE_MESSAGE(events_say(fault->event), where);
            TEST_ASSERT_TRUE_MESSAGE(loop_is("one", fault->state == ONE_LOST || fault->state == SAFE
                                                        ? "manual"
                                                        : "auto"),
                                     where);
            repair(fault, &modes[m], where);
            plant_power_off();
        }
    printf("fault matrix of state feedback: %u combinations\n", combinations);
}

/* ---- what it is for ---- */

static void a_loop_keeps_its_setpoint_while_the_other_steps_and_the_disturbance_does(void)
{
    plant_power_on(DECOUPLING "/three-states.json", TICK_MS, 3, 0);
    ask_file(DECOUPLING "/three-states.conf");
    for (unsigned k = 1; k <= 4; k++) {
        char line[40];
        snprintf(line, sizeof line, "set meas%u.frozen 0", k);
        ask_ok(line);
    }
    plant_connect();
    plant_steps(2);
    ask_ok("out one 0");
    ask_ok("out two 0");
    plant_steps(60);
    both();
    ask_ok("sp two 0");
    plant_steps(60);
    ask_ok("sp one 0.3");
    for (unsigned k = 0; k < 60; k++) {
        plant_step();
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0, truly("y2"));
    }
    plant_steps(240); /* its integral has seen the step as well, and comes back in its own time */
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.3, truly("y1"));
    plant_event("d=0.5"); /* F has what it needs one sample later: it is seen once it acts */
    plant_steps(240);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.3, truly("y1"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, truly("y2"));
}

static void while_an_input_is_at_its_limit_the_other_loop_comes_to_its_setpoint(void)
{
    begin(&modes[2]);
    ask_ok("sp one 0.4");
    ask_ok("sp two 0.15");
    plant_steps(200);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.1, commanded("u1"));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.15, truly("y2"));
    ask_ok("sp one -0.2");
    plant_steps(2);
    TEST_ASSERT_TRUE(commanded("u1") < 0.09);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_fault_in_every_mode_ends_as_it_must);
    RUN_TEST(a_loop_keeps_its_setpoint_while_the_other_steps_and_the_disturbance_does);
    RUN_TEST(while_an_input_is_at_its_limit_the_other_loop_comes_to_its_setpoint);
    return UNITY_END();
}
