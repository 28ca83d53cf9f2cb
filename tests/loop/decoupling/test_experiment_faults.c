/* Faults under the kind `experiment` in each of its stages on Kotyk and Machacek's column: what each must end in, and that the inputs
 * are back where they rested. To add a fault: a row of faults[]. */
#include "experiment_plant.h"

#define BLOCK   4
#define TICK_MS 120000u
#define GOES_ON 0
/* Values of `reason`, as docs/methods/experiment.md has them. */
enum { STOPPED = 1, BAND, READING, UNSTEADY, WORKSPACE, SETTINGS, AWAY };
enum { LIMIT = 13, INTERLOCK, MODE, HAND, CHANNEL, SAFE, PLAN = 20 };

static void begin(void)
{
    plant_power_on("kotyk-column", TICK_MS, 3, 1);
    ask_file(DECOUPLING "/kotyk.conf");
    ask_file(DECOUPLING "/experiment.conf");
    ask_ok("set meas2.frozen 1200");
    plant_connect();
    plant_steps(2);
    ask_ok("out one 0");
    ask_ok("out two 0");
    plant_steps(50);
    ask_ok("block 4 start");
    plant_steps(3);
}

/* ---- stages ---- */

static const struct stage {
    const char *name;
    unsigned steps;
    int number;
} stages[] = {{"settles", 8, SETTLES}, {"excites", 120, EXCITES}, {"computes", 1039, COMPUTES}};
enum { AT_REST, MOVING, COMPUTING };

/* ---- faults ---- */

static void silent_link(void)
{
    board.mute = true;
    pass(5000);
}
static void u1_by_hand(void)
{
    ask_ok("out one 0.8");
}
static void u1_back(void)
{
    ask_ok("out one 0");
}
static void one_to_auto(void)
{
    ask_ok("mode one auto");
}
static void one_to_manual(void)
{
    ask_ok("mode one manual");
    plant_step();
    ask_ok("out one 0");
}
static void less_of_u2(void)
{
    ask_ok("set mv2.max 0.5");
}
static void all_of_u2(void)
{
    ask_ok("set mv2.max 5");
}
static void stopped(void)
{
    ask_ok("block 4 stop");
}
static void other_period(void)
{
    ask_ok("set block4.periods 3");
}
static void same_period(void)
{
    ask_ok("set block4.periods 2");
}
static void settings_of_its_loop(void)
{
    ask_ok("set loop1.ti 600");
}
static void settings_of_others(void)
{
    ask_ok("set lock1.limit 1.6");
}

static const struct fault {
    const char *name, *begin, *end; /* of the instruments */
    void (*act)(void), (*undo)(void);
    unsigned steps; /* after which it has shown */
    int reason[3];  /* in each stage; GOES_ON */
    bool moves;     /* the inputs, by itself */
} faults[] = {
    {"measurement flagged bad",
     "y2.quality=2",
     "y2.quality=0",
     NULL,
     NULL,
     8,
     {READING, READING, GOES_ON},
     false},
    {"measurement missing",
     "y2.quality=3",
     "y2.quality=0",
     NULL,
     NULL,
     8,
     {READING, READING, GOES_ON},
     false},
    {"measurement not a number",
     "y2.nan=1",
     "y2.nan=0",
     NULL,
     NULL,
     8,
     {READING, READING, GOES_ON},
     false},
    {"measurement frozen",
     "y2.frozen=1",
     "y2.free=1",
     NULL,
     NULL,
     18,
     {READING, READING, GOES_ON},
     false},
    {"two samples lost",
     "y2.quality=3",
     "y2.quality=0",
     NULL,
     NULL,
     2,
     {GOES_ON, GOES_ON, GOES_ON},
     false},
    {"samples lost at random",
     "y2.dropout=0.5",
     "y2.dropout=0",
     NULL,
     NULL,
     400,
     {READING, READING, GOES_ON},
     false},
    {"a measurement leaves its band",
     "y2.bias=1.4",
     "y2.bias=0",
     NULL,
     NULL,
     20,
     {UNSTEADY, BAND, GOES_ON},
     false},
    {"an input has no room", NULL, NULL, less_of_u2, all_of_u2, 40, {LIMIT, PLAN, GOES_ON}, false},
    {"an input moved by hand",
     NULL,
     NULL,
     u1_by_hand,
     u1_back,
     20,
     {UNSTEADY, HAND, GOES_ON},
     true},
    {"a loop taken into automatic",
     NULL,
     NULL,
     one_to_auto,
     one_to_manual,
     4,
     {GOES_ON, MODE, GOES_ON},
     true},
    {"interlock", "y1.bias=1.7", "y1.bias=0", NULL, NULL, 2, {GOES_ON, INTERLOCK, GOES_ON}, true},
    {"stopped", NULL, NULL, stopped, NULL, 3, {STOPPED, STOPPED, STOPPED}, false},
    {"settings of the block",
     NULL,
     NULL,
     other_period,
     same_period,
     3,
     {SETTINGS, SETTINGS, SETTINGS},
     false},
    {"settings of a loop that acts on an input",
     NULL,
     NULL,
     settings_of_its_loop,
     NULL,
     3,
     {GOES_ON, PLAN, GOES_ON},
     false},
    {"settings of others",
     NULL,
     NULL,
     settings_of_others,
     NULL,
     3,
     {GOES_ON, GOES_ON, GOES_ON},
     false},
    {"link silent", NULL, NULL, silent_link, NULL, 4, {AWAY, AWAY, GOES_ON}, true},
};
#define FAULTS (sizeof faults / sizeof faults[0])

static void rests(const char *where)
{
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-6, 0, commanded("u1"), where);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-6, 0, commanded("u2"), where);
}

static void strike(const struct fault *fault, const char *where)
{
    if (fault->begin)
        plant_event(fault->begin);
    if (fault->act)
        fault->act();
    for (unsigned k = 0; k < fault->steps; k++) {
        plant_step();
        TEST_ASSERT_TRUE_MESSAGE(fabs(commanded("u1")) <= 5 && fabs(commanded("u2")) <= 5, where);
    }
}

/* With the fault over it can begin again. */
static void again(const struct fault *fault, const char *where)
{
    if (fault->end)
        plant_event(fault->end);
    if (fault->undo)
        fault->undo();
    plant_steps(3);
    TEST_ASSERT_TRUE_MESSAGE(stage_of(BLOCK) == ABORTED, where); /* by itself nothing begins */
    ask_ok("out one 0");
    ask_ok("out two 0");
    plant_steps(60);
    ask_ok("block 4 start");
    plant_steps(40);
    TEST_ASSERT_EQUAL_MESSAGE(EXCITES, stage_of(BLOCK), where);
}

static void one_combination(unsigned s, const struct fault *fault)
{
    char where[120];
    snprintf(where, sizeof where, "%s, %s", stages[s].name, fault->name);
    begin();
    plant_steps(stages[s].steps);
    TEST_ASSERT_EQUAL_MESSAGE(stages[s].number, stage_of(BLOCK), where);
    strike(fault, where);
    if (fault->act == silent_link) { /* nobody makes steps meanwhile */
        plant_connect();
        plant_steps(2);
    }
    TEST_ASSERT_EQUAL_MESSAGE(fault->reason[s], (int)value_of(BLOCK, "reason"), where);
    if (!fault->moves && (fault->reason[s] != GOES_ON || s == COMPUTING))
        rests(where);
    if (fault->reason[s] == GOES_ON)
        TEST_ASSERT_TRUE_MESSAGE(stage_of(BLOCK) >= stages[s].number && stage_of(BLOCK) < ABORTED,
                                 where);
    else
        again(fault, where);
    plant_power_off();
}

static void every_fault_in_every_stage_ends_as_it_must(void)
{
    for (unsigned s = 0; s < 3; s++)
        for (unsigned f = 0; f < FAULTS; f++)
            one_combination(s, &faults[f]);
    printf("fault matrix of the experiment: %zu combinations\n", 3 * FAULTS);
}

/* ---- what is no fault of the plant ---- */

static void after_a_power_cut_nothing_moves_and_nothing_begins_by_itself(void)
{
    begin();
    plant_steps(120);
    TEST_ASSERT_EQUAL(EXCITES, stage_of(BLOCK));
    ask_ok("save");
    plant_steps(20);
    plant_power_off();
    plant_power_on("kotyk-column", TICK_MS, 3, 1);
    pass(3000);
    plant_connect();
    plant_steps(3);
    TEST_ASSERT_EQUAL(IDLE, stage_of(BLOCK));
    double u1 = commanded("u1"), u2 = commanded("u2");
    for (unsigned k = 0; k < 50; k++) {
        plant_step();
        TEST_ASSERT_EQUAL_DOUBLE(u1, commanded("u1"));
        TEST_ASSERT_EQUAL_DOUBLE(u2, commanded("u2"));
    }
    TEST_ASSERT_EQUAL(IDLE, stage_of(BLOCK));
}

static void what_runs_is_not_started_again_and_what_rests_not_stopped(void)
{
    begin();
    plant_steps(60);
    ask_ok("block 4 start");
    plant_steps(2);
    ask_ok("events");
    TEST_ASSERT_TRUE(said("BLOCK_REFUSED"));
    TEST_ASSERT_EQUAL(EXCITES, stage_of(BLOCK));
    ask_ok("block 4 stop");
    plant_steps(3);
    rests("stopped");
    TEST_ASSERT_EQUAL(STOPPED, (int)value_of(BLOCK, "reason"));
}

/* Nobody else has the large memory while it runs, and it is free again behind. */
static void while_it_runs_start_up_is_refused_and_told_who_has_the_memory(void)
{
    begin();
    plant_steps(60);
    ask("commission plan");
    ask("commission start");
    TEST_ASSERT_TRUE(said("err "));
    TEST_ASSERT_EQUAL(EXCITES, stage_of(BLOCK));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_fault_in_every_stage_ends_as_it_must);
    RUN_TEST(after_a_power_cut_nothing_moves_and_nothing_begins_by_itself);
    RUN_TEST(what_runs_is_not_started_again_and_what_rests_not_stopped);
    RUN_TEST(while_it_runs_start_up_is_refused_and_told_who_has_the_memory);
    return UNITY_END();
}
