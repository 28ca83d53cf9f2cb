/* Faults in every state of the self-tuner, and what each must end in: told, outputs in range, and somebody in charge who can be.
 * To add a fault: a row of faults[]. */
#include "bench.h"

#define SINGLE SELF_TUNING "/single.conf"

/* mv2.max of the pilot's file. */
#define QRB_MOST 1.25

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

/* ---- states of the block ---- */

static void until(unsigned state)
{
    for (unsigned k = 0; k < 60 && !state_is(state); k++)
        steps_with_a_moving_setpoint(10);
    TEST_ASSERT_TRUE(state_is(state));
}

static void tuning(void)
{
    steps_with_a_moving_setpoint(40);
    TEST_ASSERT_TRUE(state_is(TUNING));
}

static void on_trial(void)
{
    for (unsigned k = 0; k < 200 && inside("on_trial") == 0; k++)
        steps_with_a_moving_setpoint(5);
    TEST_ASSERT_EQUAL_DOUBLE(1, inside("on_trial"));
}

static void waiting(void)
{
    ask_ok("set block1.adopt ask");
    until(WAITING);
}

static void self_tuning(void)
{
    until(SELF_TUNING_STATE);
    setpoint("bottom", base);
    plant_steps(40);
}

static void frozen(void)
{
    self_tuning();
    ask_ok("block 1 freeze");
    plant_step();
}

static void at_its_limit(void)
{
    self_tuning();
    ask_ok("set mv2.max 0.8");
    setpoint("bottom", base + 8);
    plant_steps(60);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.8, commanded("Qrb"));
}

static const struct stage {
    const char *name;
    void (*enter)(void);
    unsigned state;
} stages[] = {
    {"tuning", tuning, TUNING},
    {"on trial", on_trial, TUNING},
    {"waiting", waiting, WAITING},
    {"self-tuning", self_tuning, SELF_TUNING_STATE},
    {"frozen", frozen, SELF_TUNING_STATE},
    {"at its limit", at_its_limit, SELF_TUNING_STATE},
};
#define STAGES (sizeof stages / sizeof stages[0])

/* ---- faults ---- */

static void silent_link(void)
{
    board.mute = true;
    pass(5000);
}

static void link_back(void)
{
    plant_connect();
}

static void out_of_reach(void)
{
    ask_ok("set mv2.max 0.8");
    setpoint("bottom", base + 8);
}

static void within_reach(void)
{
    ask_ok("set mv2.max 1.25");
    setpoint("bottom", base);
}

/* Parameters are drawn to where the gain has the wrong sign; as long as nothing is learnt, they are not. */
static void wrong_sign(void)
{
    ask_ok("block 1 thaw");
    setpoint("bottom", base);
    ask_ok("begin");
    ask_ok("set block1.correction spc");
    ask_ok("set block1.lo.2 -0.3,0");
    ask_ok("set block1.hi.2 -0.2,0");
    ask_ok("apply");
}

static void right_sign(void)
{
    ask_ok("begin");
    ask_ok("set block1.correction none");
    ask_ok("set block1.hi.2 -0.3,0");
    ask_ok("apply");
}

enum end {
    GOES_ON, /* in its state, or one before it: the law, or the PI */
    PI_ACTS, /* back in tuning */
    MANUAL,  /* the loop is */
    OWN,     /* the loop's own PID acts */
    SAFE
};

static const struct fault {
    const char *name, *begin, *end; /* of the instruments */
    void (*act)(void), (*undo)(void);
    const char *event; /* an event */
    enum end end_state;
    bool unlearnt;      /* nothing may be learnt from it */
    const char *listed; /* an entry of the list of alarms, while the law had acted */
} faults[] = {
    {"PV flagged bad", "T10.quality=2", "T10.quality=0", NULL, NULL, "MEASUREMENT_BAD T10", MANUAL,
     true, "T10"},
    {"PV missing", "T10.quality=3", "T10.quality=0", NULL, NULL, "MEASUREMENT_BAD T10", MANUAL,
     true, "T10"},
    {"PV not a number", "T10.nan=1", "T10.nan=0", NULL, NULL, "MEASUREMENT_BAD T10", MANUAL, true,
     "T10"},
    {"PV out of range", "T10.bias=100", "T10.bias=0", NULL, NULL, "MEASUREMENT_BAD T10", MANUAL,
     true, "T10"},
    {"PV frozen", "T10.frozen=1", "T10.free=1", NULL, NULL, "MEASUREMENT_BAD T10", MANUAL, false,
     "T10"},
    {"PV uncertain", "T10.quality=1", "T10.quality=0", NULL, NULL, NULL, GOES_ON, true, NULL},
    {"disturbance missing", "T1.quality=3", "T1.quality=0", NULL, NULL, "BLOCK_GAVE_UP no_input",
     OWN, true, "BLOCK_GAVE_UP"},
    {"disturbance not a number", "T1.nan=1", "T1.nan=0", NULL, NULL, "BLOCK_GAVE_UP no_input", OWN,
     true, "BLOCK_GAVE_UP"},
    {"MV stuck", "Qrb.stuck=0.75", "Qrb.free=1", NULL, NULL, NULL, GOES_ON, false, NULL},
    {"MV at its limit", NULL, NULL, out_of_reach, within_reach, "block1.frozen", GOES_ON, false,
     NULL},
    {"interlock", "T10.bias=25", "T10.bias=0", NULL, NULL, "INTERLOCK", GOES_ON, false,
     "INTERLOCK"},
    {"g0 of the wrong sign", NULL, NULL, wrong_sign, right_sign, NULL, PI_ACTS, false,
     "block1.sign"},
    {"link silent", NULL, NULL, silent_link, link_back, "LINK_DOWN", SAFE, false, NULL},
};
#define FAULTS (sizeof faults / sizeof faults[0])

/* ---- the run ---- */

static void begin(const struct stage *stage)
{
    column_at_rest(SINGLE, 1);
    ask_ok("begin");
    ask_ok("set block1.inputs T10,T1");
    ask_ok("set meas2.frozen 300");
    ask_ok("set block1.excite 1"); /* with this noise */
    ask_ok("apply");
    in_auto();
    stage->enter();
    board_forget();
}

static void bounded_steps(unsigned n, const char *where)
{
    for (unsigned k = 0; k < n; k++) {
        plant_step();
        TEST_ASSERT_TRUE_MESSAGE(commanded("Qrb") >= 0 && commanded("Qrb") <= QRB_MOST + 1e-6,
                                 where);
    }
}

static void check_end(const struct fault *f, const struct stage *stage, const char *where)
{
    bool law = stage->state == SELF_TUNING_STATE;
    if (f->event)
        TEST_ASSERT_TRUE_MESSAGE(events_say(f->event), where);
    if (f->listed && (law || f->end_state != PI_ACTS))
        TEST_ASSERT_TRUE_MESSAGE(alarm_says(f->listed), where);
    TEST_ASSERT_EQUAL_MESSAGE(f->end_state != MANUAL, loop_is("bottom", "auto"), where);
    ask_ok("block");
    TEST_ASSERT_EQUAL_MESSAGE(f->end_state == OWN, said("block1 gmv off: no_input"), where);
    if (f->end_state == PI_ACTS)
        TEST_ASSERT_TRUE_MESSAGE(!state_is(SELF_TUNING_STATE), where);
}

/* Whoever is in charge begins where the MV stands. */
static void repair(const struct fault *f, const char *where)
{
    plant_event(f->end);
    if (f->undo)
        f->undo();
    if (f->end_state == SAFE) {
        plant_steps(3);
        TEST_ASSERT_TRUE_MESSAGE(loop_is("bottom", "manual"), where);
        return;
    }
    bounded_steps(5, where);
    if (f->end_state == MANUAL) { /* the interlock on T10 had cut the heater */
        ask_ok("out bottom 0.7");
        bounded_steps(40, where);
    }
    double before = commanded("Qrb");
    if (f->end_state == MANUAL)
        ask_ok("mode bottom auto");
    if (f->end_state == OWN)
        ask_ok("block 1 on");
    if (f->end_state == MANUAL || f->end_state == OWN) {
        plant_step();
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-5, before, commanded("Qrb"), where);
        TEST_ASSERT_TRUE_MESSAGE(state_is(TUNING), where);
    }
    bounded_steps(40, where);
    ask_ok("block");
    TEST_ASSERT_TRUE_MESSAGE(said("block1 gmv on"), where);
    TEST_ASSERT_TRUE_MESSAGE(loop_is("bottom", "auto"), where);
}

static void one_combination(const struct fault *f, const struct stage *stage)
{
    char where[120];
    snprintf(where, sizeof where, "%s, %s", f->name, stage->name);
    begin(stage);
    plant_event(f->begin);
    if (f->act)
        f->act();
    if (f->end_state == SAFE) {
        plant_steps(20);
        TEST_ASSERT_TRUE_MESSAGE(events_say(f->event), where);
    } else {
        bounded_steps(1, where);
        double learnt = inside("est1_1");
        bounded_steps(f->end_state == PI_ACTS ? 150 : 60, where);
        bool begun_anew =
            stage->state == SELF_TUNING_STATE && f->end_state == GOES_ON &&
            !state_is(
                SELF_TUNING_STATE); /* given up for another reason: back to what was adopted */
        if (f->unlearnt && !begun_anew)
            TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(learnt, inside("est1_1"), where);
        check_end(f, stage, where);
    }
    repair(f, where);
    plant_power_off();
}

static void every_fault_in_every_state_ends_as_it_must(void)
{
    for (unsigned m = 0; m < STAGES; m++)
        for (unsigned f = 0; f < FAULTS; f++)
            one_combination(&faults[f], &stages[m]);
    printf("fault matrix of the self-tuner: %u combinations\n", (unsigned)(STAGES * FAULTS));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_fault_in_every_state_ends_as_it_must);
    return UNITY_END();
}
