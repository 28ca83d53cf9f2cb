/* The kind `ff_tune` in each of its stages, when the plant's time stands still or has a gap. Where the loop goes to manual, somebody puts
 * it back to automatic. */
#include "commission_board.h"
#include "unlike_bench.h"

#define SAFE_STATE_TAKEN (SIGNAL + 8) /* why a test signal ended */
#define HOUR_MS          3600000u

void setUp(void)
{
    memory_port_erase_all();
    children_failed = 0;
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, children_failed, "cases of this test, see above");
    plant_power_off();
}

/* ---- faults ---- */

/* The last sample comes 500 times more within one tick of the board, with other readings. */
static void same_sample_again(void)
{
    struct frame f;
    struct link_sample sample;
    instruments_measure(&instruments, plant, 0, &sample);
    sample.number = board.number;
    sample.time_ms = board.time_ms - board.tick_ms;
    for (unsigned n = 0; n < 500; n++) {
        pack_sample(&sample, &f);
        link_give(&f);
        board_run();
    }
}

/* New samples come, but all of them say the same time. */
static void clock_stands_still(void)
{
    uint32_t tick = board.tick_ms;
    board.tick_ms = 0;
    plant_steps(100);
    board.tick_ms = tick;
}

static void samples_are_missing(uint32_t ms)
{
    board.time_ms += ms;
    TEST_ASSERT_TRUE(
        kind->advance(plant, (double)board.time_ms / 1000.0, plant_err, sizeof plant_err));
}

static void an_hour_is_missing(void)
{
    samples_are_missing(HOUR_MS);
}

/* No more than `tick.miss_limit`, every 4 s for four minutes. */
static void many_samples_are_missing(void)
{
    for (unsigned k = 0; k < 60; k++) {
        samples_are_missing(3000);
        tune_second();
    }
}

struct time_fault {
    const char *name;
    void (*happens)(void);
    bool takes_the_loop; /* the board takes the safe state */
};

static const struct time_fault time_faults[] = {
    {"the same sample", same_sample_again, false},
    {"clock stands", clock_stands_still, true},
    {"an hour is missing", an_hour_is_missing, true},
    {"many are missing", many_samples_are_missing, false},
};

#define TIME_FAULTS (sizeof time_faults / sizeof time_faults[0])

/* ---- stages ---- */

static void until_stage(unsigned method, int stage)
{
    static const char *const ask_first[] = {"set block1.adopt ask", NULL};
    begin_unlike(&usual, method);
    if (stage == PROPOSES)
        settle(ask_first);
    course.quiet = method != 0;
    ask_ok("block 1 tune");
    tune_seconds(5);
    for (unsigned k = 0; k < 15000 && tune_value("stage") != stage; k++) {
        course.quiet = tune_value("stage") == LOOP;
        tune_second();
    }
    TEST_ASSERT_EQUAL(stage, tune_value("stage"));
    if (stage == LOOP || stage == DISTURBANCE || stage == TESTS)
        tune_seconds(600);
}

/* Until nothing more comes of it; somebody accepts what the block proposes. */
static void come_to_an_end(void)
{
    for (unsigned k = 0; k < 900; k++) {
        int stage = tune_value("stage");
        if (stage == IDLE || stage == RUNS)
            break;
        if (stage == PROPOSES)
            (void)ask("proposal accept");
        course.quiet = stage == LOOP;
        tune_seconds(20);
    }
    course.quiet = false;
    tune_seconds(1200);
}

static const struct time_fault *fault; /* the one that is played */
static bool has_test_signal;           /* in the stage that it strikes */

static void play_fault(void)
{
    fault->happens();
    tune_seconds(3);
    TEST_ASSERT_EQUAL(fault->takes_the_loop, loop_is("one", "manual"));
    if (fault->takes_the_loop) {
        ask_ok("mode one auto");
        tune_seconds(2);
        ask_ok("sp one 0");
    }
    come_to_an_end();
    bool ends = fault->takes_the_loop && has_test_signal;
    TEST_ASSERT_EQUAL(ends ? SAFE_STATE_TAKEN : ADOPTED, tune_value("verdict"));
    TEST_ASSERT_EQUAL(0, tune_value("tried"));
    TEST_ASSERT_TRUE(mean_square(1200) < (ends ? 1.7 : 0.12)); /* 1.54 by feedback alone */
}

static void each_fault(unsigned method, int stage, bool with_test_signal)
{
    until_stage(method, stage);
    has_test_signal = with_test_signal;
    for (unsigned k = 0; k < TIME_FAULTS; k++) {
        fault = &time_faults[k];
        from_here(fault->name, play_fault);
    }
    plant_power_off();
}

static void faults_of_time_while_the_loop_is_identified_do_no_harm(void)
{
    each_fault(3, LOOP, true);
}

static void faults_of_time_while_the_disturbance_is_identified_do_no_harm(void)
{
    each_fault(0, DISTURBANCE, true);
    each_fault(3, DISTURBANCE, false);
}

static void faults_of_time_while_an_element_is_computed_do_no_harm(void)
{
    each_fault(0, COMPUTES, false);
}

static void faults_of_time_while_the_candidate_is_tested_do_no_harm(void)
{
    each_fault(0, TESTS, false);
}

static void faults_of_time_while_a_proposal_waits_do_no_harm(void)
{
    each_fault(0, PROPOSES, false);
}

static void faults_of_time_while_the_element_acts_do_no_harm(void)
{
    each_fault(0, RUNS, false);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(faults_of_time_while_the_loop_is_identified_do_no_harm);
    RUN_TEST(faults_of_time_while_the_disturbance_is_identified_do_no_harm);
    RUN_TEST(faults_of_time_while_an_element_is_computed_do_no_harm);
    RUN_TEST(faults_of_time_while_the_candidate_is_tested_do_no_harm);
    RUN_TEST(faults_of_time_while_a_proposal_waits_do_no_harm);
    RUN_TEST(faults_of_time_while_the_element_acts_do_no_harm);
    return UNITY_END();
}
