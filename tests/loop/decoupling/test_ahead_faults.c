/* Faults under the kind `ahead` on the pilot column, whose states an estimator gives it (host_sim/scenarios/pilot-ahead.conf): both loops in
 * automatic, one by hand, one out of reach of its MV. To add a fault: a row of faults[]. */
#include <math.h>

#include "plant_board.h"

#define TICK_MS 30000u

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

static bool block_is(const char *what)
{
    char text[40];
    ask_ok("block 3");
    snprintf(text, sizeof text, "block3 ahead %s", what);
    return said(text);
}

/* ---- modes of operation ---- */

static void both(void)
{
    ask_ok("mode top auto");
    ask_ok("mode bottom auto");
    ask_ok("sp top 88.2");
    ask_ok("sp bottom 108");
}

static void one_by_hand(void)
{
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 108");
    ask_ok("out top 2.4");
}

static void clipped(void)
{
    both();
    ask_ok("set mv1.max 2.2");
}

static const struct mode {
    const char *name;
    void (*enter)(void);
    bool top_acts;
} modes[] = {
    {"both in auto", both, true}, {"one by hand", one_by_hand, false}, {"clipped", clipped, true}};
#define MODES (sizeof modes / sizeof modes[0])

/* ---- faults ---- */

static void silent_link(void)
{
    board.mute = true;
    pass(5000);
}

static void estimator_anew(void)
{
    ask_ok("block 2 begin");
}

static void workspace_gone(void)
{
    ask_ok("block 2 free");
}

static void workspace_back(void)
{
    ask_ok("block 2 take");
}

static void other_time_constants(void)
{
    ask_ok("set block3.tau.1 300,300,0,0");
}

static void their_own(void)
{
    ask_ok("set block3.tau.1 33.3,33.3,0,0");
}

enum end { GOES_ON, ONE_LOST, SAFE };

static const struct fault {
    const char *name, *begin, *end; /* of the instruments */
    void (*act)(void), (*undo)(void);
    const char *event;
    enum end state;
} faults[] = {
    {"a thermometer of the estimator lost", "T7.quality=3", "T7.quality=0", NULL, NULL,
     "MEASUREMENT_BAD T7", GOES_ON},
    {"a thermometer of the estimator no number", "T7.nan=1", "T7.nan=0", NULL, NULL,
     "MEASUREMENT_BAD T7", GOES_ON},
    {"a thermometer of the estimator that lies", "T7.bias=2", "T7.bias=0", NULL, NULL, NULL,
     GOES_ON},
    {"a thermometer of the estimator frozen", "T9.frozen=1", "T9.free=1", NULL, NULL, NULL,
     GOES_ON},
    {"the measurement of a loop lost", "T1.quality=3", "T1.quality=0", NULL, NULL,
     "MEASUREMENT_BAD T1", ONE_LOST},
    {"the measurement of a loop that lies", "T10.bias=1", "T10.bias=0", NULL, NULL, NULL, GOES_ON},
    {"spikes", "T10.spike=5", "T10.spike=0", NULL, NULL, NULL, GOES_ON},
    {"samples lost at random", "T2.dropout=0.2", "T2.dropout=0", NULL, NULL, NULL, GOES_ON},
    {"reflux stuck", "Lr.stuck=5", "Lr.free=1", NULL, NULL, "NOT_FOLLOWING Lr", GOES_ON},
    {"heater half as strong", "Qrb.gain=0.5", "Qrb.gain=1", NULL, NULL, NULL, GOES_ON},
    {"reflux slow", "Lr.slew=0.02", "Lr.slew=1", NULL, NULL, NULL, GOES_ON},
    {"a fifth more feed", "F=6", "F=5", NULL, NULL, NULL, GOES_ON},
    {"richer feed", "xF=43", "xF=36", NULL, NULL, NULL, GOES_ON},
    {"pressure up", "P=775", "P=760", NULL, NULL, NULL, GOES_ON},
    {"the estimator begins anew", NULL, NULL, estimator_anew, NULL, NULL, GOES_ON},
    {"the estimator loses its workspace", NULL, NULL, workspace_gone, workspace_back, NULL,
     GOES_ON},
    {"other time constants", NULL, NULL, other_time_constants, their_own, NULL, GOES_ON},
    {"link silent", NULL, NULL, silent_link, plant_connect, "LINK_DOWN", SAFE},
};
#define FAULTS (sizeof faults / sizeof faults[0])

/* ---- the run ---- */

static void begin(const struct mode *mode)
{
    plant_power_on("pilot", TICK_MS, 3, 1);
    ask_file(SCENARIOS "/pilot.conf");
    ask_file(SCENARIOS "/pilot-ahead.conf");
    plant_connect();
    plant_steps(2);
    ask_ok("out top 2.6");
    ask_ok("out bottom 0.65");
    plant_steps(80);
    mode->enter();
    plant_steps(40);
    TEST_ASSERT_TRUE(block_is("on"));
    board_forget();
}

static void bounded_steps(unsigned n, const char *where)
{
    for (unsigned k = 0; k < n; k++) {
        plant_step();
        TEST_ASSERT_TRUE_MESSAGE(commanded("Lr") >= 1 - 1e-5 && commanded("Lr") <= 9 + 1e-5, where);
        TEST_ASSERT_TRUE_MESSAGE(commanded("Qrb") >= 0.4 - 1e-6 && commanded("Qrb") <= 1.25 + 1e-6,
                                 where);
        TEST_ASSERT_TRUE_MESSAGE(truly("T10") > 95 && truly("T10") < 121, where);
    }
}

static void repair(const struct fault *fault, const struct mode *mode, const char *where)
{
    if (fault->end)
        plant_event(fault->end);
    if (fault->undo)
        fault->undo();
    ask_ok("set mv1.max 9");
    plant_steps(60); /* the estimator finds its column again */
    if (fault->state == SAFE || fault->state == ONE_LOST) {
        TEST_ASSERT_TRUE_MESSAGE(loop_is("top", "manual"), where); /* by itself nothing begins */
        if (fault->state == SAFE) {
            ask_ok("out top 2.6");
            ask_ok("out bottom 0.65");
            plant_steps(80);
            ask_ok("mode bottom auto");
        }
        if (mode->top_acts)
            ask_ok("mode top auto");
    }
    TEST_ASSERT_TRUE_MESSAGE(block_is("on"), where);
    if (mode->top_acts)
        ask_ok("sp top 88.2");
    ask_ok("sp bottom 108");
    bounded_steps(120, where);
    TEST_ASSERT_TRUE_MESSAGE(block_is("on"), where);
    if (mode->top_acts)
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.15, 88.2, truly("T1"), where);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.5, 108, truly("T10"), where);
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
            if (fault->state == SAFE)
                pass(5000);
            else
                bounded_steps(40, where);
            if (fault->event)
                TEST_ASSERT_TRUE_MESSAGE(events_say(fault->event), where);
            bool lost = fault->state == ONE_LOST || fault->state == SAFE,
                 safe = fault->state == SAFE;
            bool top_acts = modes[m].top_acts && !lost;
            TEST_ASSERT_TRUE_MESSAGE(loop_is("top", top_acts ? "auto" : "manual"), where);
            TEST_ASSERT_TRUE_MESSAGE(loop_is("bottom", safe ? "manual" : "auto"), where);
            TEST_ASSERT_TRUE_MESSAGE(block_is("on"), where);
            repair(fault, &modes[m], where);
            plant_power_off();
        }
    printf("fault matrix of ahead: %u combinations\n", combinations);
}

/* A thermometer that the block sees itself, beside the estimates. */
static void a_state_that_is_lost_hands_over_to_the_loops_own_controllers(void)
{
    begin(&modes[0]);
    ask_ok("begin");
    ask_ok("set block3.inputs x1,x2,x4,x7,x9,x11,z,F_est,Lr,Qrb,T7");
    ask_ok("set block3.place.11 5,1");
    ask_ok("set block3.si.11 1,273.15");
    ask_ok("apply");
    plant_steps(40);
    TEST_ASSERT_TRUE(block_is("on"));
    board_forget();
    plant_event("T7.quality=3");
    bounded_steps(1, "the first step");
    plant_steps(20);
    TEST_ASSERT_TRUE(events_say("BLOCK_GAVE_UP T7"));
    TEST_ASSERT_TRUE(loop_is("top", "auto") && loop_is("bottom", "auto"));
    bounded_steps(100, "under the loops' own PIs");
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 88.2, truly("T1"));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 108, truly("T10"));
    plant_event("T7.quality=0");
    plant_steps(5);
    double before[2] = {commanded("Lr"), commanded("Qrb")};
    ask_ok("block 3 on");
    plant_step();
    /* It holds what it found in its first step. */
    TEST_ASSERT_DOUBLE_WITHIN(0.01, before[0], commanded("Lr"));
    TEST_ASSERT_DOUBLE_WITHIN(0.001, before[1], commanded("Qrb"));
    bounded_steps(100, "back");
    TEST_ASSERT_DOUBLE_WITHIN(0.15, 88.2, truly("T1"));
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 108, truly("T10"));
}

static void an_input_that_is_another_loops_mv_makes_it_give_up(void)
{
    begin(&modes[0]);
    ask_ok("begin");
    ask_ok("set block3.moves.1 10,9,0,0");
    ask_ok("apply");
    plant_steps(3);
    TEST_ASSERT_TRUE(events_say("BLOCK_GAVE_UP other_mv"));
    TEST_ASSERT_TRUE(block_is("off"));
}

static void a_compensator_of_its_loops_is_refused(void)
{
    begin(&modes[0]);
    ask_ok("begin");
    ask_ok("set block4.kind polynomial");
    ask_ok("set block4.loops bottom,top");
    ask_refused("apply", "CONFLICT");
    TEST_ASSERT_TRUE_MESSAGE(said("it works out the MVs of a column itself"), board.said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_fault_in_every_mode_ends_as_it_must);
    RUN_TEST(a_state_that_is_lost_hands_over_to_the_loops_own_controllers);
    RUN_TEST(an_input_that_is_another_loops_mv_makes_it_give_up);
    RUN_TEST(a_compensator_of_its_loops_is_refused);
    return UNITY_END();
}
