/* The kind `ff_tune` while things go wrong. First: whatever the plant and the sensor of the disturbance do, the loop is not worse than under
 * feedback alone for longer than half of `check`. Then faults in each stage of each method: what each ends in. To add a fault:
 * a row of lies[], or of faults[]. By default every row meets one method (lies), or one stage of each method (faults); with the
 * argument `all` every combination is tried. */
#include "sample.h"
#include "tune_bench.h"

#define CHECK 1200u /* of tune.conf */

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

static void begin_method(unsigned method, uint64_t seed)
{
    char line[60];
    tune_begin(FEEDFORWARD, seed, 1);
    snprintf(line, sizeof line, "set block1.method %s", methods[method]);
    ask_ok(line);
    tune_seconds(1200);
}

static void tune_to(unsigned method, int stage)
{
    tune_stages(method != 0, 1u << stage, 10);
}

/* ---- never worse for long ---- */

static const struct lie {
    const char *name, *event, *parameter;
    int value;
} lies[] = {
    {"process gain 1.5 times", NULL, "process", 2},
    {"process dead time 16 s", NULL, "process", 3},
    {"process gain half", NULL, "process", 4},
    {"disturbance path II c", NULL, "regime", 3},
    {"disturbance path III a", NULL, "regime", 7},
    {"sensor reads three times as much", NULL, "sensor", 2},
    {"sensor with the wrong sign", NULL, "sensor", 3},
    {"sensor stuck", "dm.stuck=1", NULL, 0},
    {"sensor dead", "dm.dead=1", NULL, 0},
    {"sensor flagged bad", "dm.quality=2", NULL, 0},
    {"sensor silent", "dm.quality=3", NULL, 0},
    {"sensor noise as large as the disturbance", "dm.noise=1", NULL, 0},
    {"sensor noise a fifth of that", "dm.noise=0.2", NULL, 0},
    {"a sine in the band on the sensor", "dm.hum=1.5", NULL, 0},
    {"sensor drifts", "dm.drift=2", NULL, 0},
    {"noise of y ten times", "y.noise=0.5", NULL, 0},
};
#define LIES (sizeof lies / sizeof lies[0])

#define WINDOW  60u /* s; five of them are a period of the disturbance */
#define WINDOWS 80u

static void tell_lie(const struct lie *l)
{
    if (l->parameter)
        set_parameter(l->parameter, l->value);
    plant_event("dm.hum_period=40");
    plant_event(l->event);
}

/* Mean squares in each window after the lie begins, at the same phase of the disturbance. */
static void look_through(const struct lie *l, double *square, unsigned *worst, bool watched)
{
    unsigned longest = 0, run = 0;
    while (board.time_ms / 1000 % 300 != 0)
        tune_second();
    tell_lie(l);
    for (unsigned w = 0; w < WINDOWS; w++) {
        double now = mean_square(WINDOW);
        if (!watched) {
            square[w] = now;
            continue;
        }
        int stage = tune_value("stage");
        if (stage != RUNS && stage != IDLE)
            break; /* it identifies anew: from here on setpoints move */
        run = now > 1.15 * square[w] + 0.01 ? run + 1 : 0;
        longest = run > longest ? run : longest;
    }
    *worst = longest;
}

static void no_lie_makes_it_worse_than_feedback_alone_for_long(void)
{
    for (unsigned m = 0; m < METHODS; m++)
        for (unsigned k = 0; k < LIES; k++) {
            if (!sample_has(m + k, METHODS))
                continue;
            double alone[WINDOWS];
            unsigned worst = 0;
            begin_method(m, 11);
            tune_seconds(3000);
            look_through(&lies[k], alone, &worst, false);
            plant_power_off();
            begin_method(m, 11);
            ask_ok("set block1.tries 0");
            tune_seconds(1200);
            tune_to(m, RUNS);
            TEST_ASSERT_EQUAL(RUNS, tune_value("stage"));
            tune_seconds(1200);
            look_through(&lies[k], alone, &worst, true);
            ask_ok("get ff1.gain");
            bool off = said("ff1.gain = 0 ");
            printf("%-11s %-42s worse for %4u s in a row; %s\n", methods[m], lies[k].name,
                   worst * WINDOW, off ? "switched off" : "stays on");
            TEST_ASSERT_TRUE_MESSAGE(worst * WINDOW <= CHECK / 2, lies[k].name);
            plant_power_off();
        }
}

/* From the start on, before anything is known: by the time of the stages and the test. */
static void a_wrong_sign_from_the_start_is_over_when_the_first_model_is_there(void)
{
    for (unsigned m = 0; m < METHODS; m++) {
        begin_method(m, 5);
        ask_ok("begin");
        ask_ok("set ff1.gain 0.5");
        ask_ok("set block1.k 0.5");
        ask_ok("apply");
        tune_seconds(1200);
        tune_to(m, TESTS);
        TEST_ASSERT_EQUAL(TESTS, tune_value("stage"));
        unsigned seconds = 0;
        for (; seconds < CHECK; seconds += 20) {
            ask_ok("get ff1.gain");
            if (said("ff1.gain = 0 "))
                break;
            tune_seconds(20);
        }
        printf("%-11s wrong sign: off %u s after the first model\n", methods[m], seconds);
        TEST_ASSERT_TRUE(seconds <= CHECK / 2);
        for (unsigned k = 0; k < 1000 && tune_value("stage") != RUNS; k++)
            tune_seconds(20);
        tune_seconds(1200);
        TEST_ASSERT_EQUAL(ADOPTED, tune_value("verdict"));
        TEST_ASSERT_TRUE(value_of(1, "does") > 85);
        plant_power_off();
    }
}

/* ---- faults in every stage ---- */

static void to_manual(void)
{
    ask_ok("mode one manual");
}
static void to_auto(void)
{
    ask_ok("mode one auto");
    plant_step();
    ask_ok("sp one 0"); /* which has followed the PV meanwhile */
}
static void link_silent(void)
{
    board.mute = true;
    pass(5000);
}
static void link_back(void)
{
    plant_connect();
    plant_steps(2);
    to_auto();
}
static void by_hand(void)
{
    ask_ok("mode one manual");
    plant_step();
    ask_ok("out one 2");
}
static void block_off(void)
{
    ask_ok("block 1 off");
}
static void block_on(void)
{
    ask_ok("block 1 on");
}
static void other_settings(void)
{
    ask_ok("set block1.settled 12");
}
static void limit_of_setpoint(void)
{
    ask_ok("set loop1.sp_hi 0.5");
}
static void all_setpoints(void)
{
    ask_ok("set loop1.sp_hi 20");
}
static void stopped(void)
{
    ask_ok("block 1 stop");
}
static void new_setpoint(void)
{
    ask_ok("sp one 1.5");
}

static const struct fault {
    const char *name, *begin, *end;
    void (*act)(void), (*undo)(void);
    bool goes_on; /* what was begun is not given up, whatever the stage */
} faults[] = {
    {"PV flagged bad", "y.quality=2", "y.quality=0", NULL, NULL, true},
    {"PV missing for two samples", "y.quality=3", "y.quality=0", NULL, NULL, true},
    {"PV not a number", "y.nan=1", "y.nan=0", NULL, NULL, true},
    {"disturbance flagged bad", "dm.quality=2", "dm.quality=0", NULL, NULL, true},
    {"disturbance missing", "dm.quality=3", "dm.quality=0", NULL, NULL, true},
    {"disturbance not a number", "dm.nan=1", "dm.nan=0", NULL, NULL, true},
    {"disturbance with spikes", "dm.spike=3", "dm.spike=0", NULL, NULL, true},
    {"MV jammed", "u.stuck=3", "u.free=1", NULL, NULL, true},
    {"link silent", NULL, NULL, link_silent, link_back, false},
    {"loop to manual", NULL, NULL, to_manual, to_auto, false},
    {"MV by hand", NULL, NULL, by_hand, to_auto, false},
    {"block off", NULL, NULL, block_off, block_on, false},
    {"its settings changed", NULL, NULL, other_settings, NULL, false},
    {"setpoint limited", NULL, NULL, limit_of_setpoint, all_setpoints, false},
    {"stop", NULL, NULL, stopped, NULL, false},
    {"another setpoint", NULL, NULL, new_setpoint, NULL, true},
};
#define FAULTS (sizeof faults / sizeof faults[0])

static const struct {
    const char *name;
    int number;
} stages[] = {{"loop", LOOP}, {"disturbance", DISTURBANCE}, {"tests", TESTS}, {"runs", RUNS}};
#define STAGES (sizeof stages / sizeof stages[0])

/* The test signal needs the loop: without it the stage is over. With the fault gone the loop is controlled, and the block can be told to
 * begin again. plant_step() looks at every command. */
static void one_fault(unsigned m, unsigned s, const struct fault *f)
{
    begin_method(m, 3);
    tune_to(m, stages[s].number);
    TEST_ASSERT_EQUAL(stages[s].number, tune_value("stage"));
    tune_seconds(60);
    int before = tune_value("stage");
    ask_ok("get ff1.gain");
    bool off = said("ff1.gain = 0 ");
    plant_event(f->begin);
    if (f->act)
        f->act();
    tune_seconds(30);
    plant_event(f->end);
    if (f->undo)
        f->undo();
    tune_seconds(60);
    int after = tune_value("stage");
    bool learnt = stages[s].number == LOOP || stages[s].number == DISTURBANCE;
    if (f->goes_on && !(learnt && f->begin && f->begin[0] == 'y'))
        TEST_ASSERT_EQUAL_MESSAGE(before, after, f->name);
    TEST_ASSERT_TRUE_MESSAGE(after == before || after == IDLE || after == RUNS, f->name);
    /* Nothing was adopted because of it. */
    ask_ok("get ff1.gain");
    TEST_ASSERT_EQUAL_MESSAGE(off, said("ff1.gain = 0 "), f->name);
    course.quiet = true;
    tune_seconds(900);
    course.quiet = false;
    TEST_ASSERT_TRUE_MESSAGE(fabs(truly("y")) < 4, f->name);
    after = tune_value("stage");
    if (after == IDLE || after == RUNS)
        ask_ok("block 1 tune");
    plant_power_off();
}

static void every_fault_in_every_stage_of_every_method_leaves_the_loop_controlled(void)
{
    unsigned cells = 0;
    for (unsigned m = 0; m < METHODS; m++)
        for (unsigned s = 0; s < STAGES; s++)
            for (unsigned k = 0; k < FAULTS; k++) {
                if (m == 0 && stages[s].number == LOOP)
                    continue; /* has no such stage */
                if (faults[k].act == stopped && stages[s].number == RUNS)
                    continue; /* refused, there is nothing to stop */
                if (!sample_has(m + s + k, STAGES))
                    continue;
                one_fault(m, s, &faults[k]);
                cells++;
            }
    printf("%u cells\n", cells);
}

/* ---- power ---- */

static void after_a_power_cut_nothing_begins_by_itself(void)
{
    begin_method(0, 3);
    tune_to(0, DISTURBANCE);
    tune_seconds(500);
    ask_ok("save");
    tune_seconds(20);
    plant_power_off();
    plant_power_on("siddha-slow", 1000, 3, 1);
    pass(3000);
    plant_connect();
    plant_steps(50);
    TEST_ASSERT_EQUAL(IDLE, tune_value("stage"));
    ask_ok("mode one auto");
    tune_seconds(50);
    TEST_ASSERT_EQUAL(IDLE, tune_value("stage"));
}

int main(int argc, char **argv)
{
    sample_arguments(argc, argv);
    UNITY_BEGIN();
    RUN_TEST(no_lie_makes_it_worse_than_feedback_alone_for_long);
    RUN_TEST(a_wrong_sign_from_the_start_is_over_when_the_first_model_is_there);
    RUN_TEST(every_fault_in_every_stage_of_every_method_leaves_the_loop_controlled);
    RUN_TEST(after_a_power_cut_nothing_begins_by_itself);
    return UNITY_END();
}
