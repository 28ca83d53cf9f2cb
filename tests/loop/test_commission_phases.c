/* Automatic start-up and three faults in every one of its phases: the board is reset, a reading is no number, plant time stands
 * still. No step is left standing, nothing is stored, start-up gives its reason, and it can begin again. Table for people:
 * docs/use/commission.md. */
#include "commission_wood_berry.h"
#include "turn_bench.h"

#define AWHILE_MS 3600000u

void setUp(void)
{
    children_failed = 0;
}
void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, children_failed, "cases of this test, see above");
}

/* ---- outputs ---- */

static const char *tested[2]; /* names of both outputs */

static void outputs_are_held(void)
{
    for (unsigned k = 0; k < 2; k++)
        ASSERT_OUTPUT(nominal(tested[k]), tested[k]);
}

static void outputs_are_safe(void)
{
    TEST_ASSERT_TRUE(board.command.safe);
    for (unsigned k = 0; k < 2; k++)
        ASSERT_OUTPUT(kind->channels[plant_channel_of(tested[k])].safe, tested[k]);
}

/* ---- phases ---- */

/* Goes on until the command for an output is this. */
static void until_output(const char *name, double value)
{
    for (unsigned n = 0; fabs(commanded(name) - value) > 1e-4; n++) {
        TEST_ASSERT_TRUE_MESSAGE(n < 2000, name);
        plant_step();
    }
}

static void until_phase(const char *phase)
{
    for (unsigned n = 0; !phase_is(phase); n++) {
        TEST_ASSERT_TRUE_MESSAGE(n < 2000, phase);
        plant_step();
    }
}

static void to_rest(void)
{
    ask_ok("commission begin");
    plant_steps(10);
    TEST_ASSERT_TRUE(phase_is("testing"));
}

static void to_paused(void)
{
    ask_ok("commission pause");
    plant_step();
    TEST_ASSERT_TRUE(phase_is("paused"));
}

static void to_up(void)
{
    ask_ok("commission resume");
    until("TEST_STEP S", 2000);
    ASSERT_OUTPUT(1.71 + 0.08, "S");
}

static void to_pause(void)
{
    until_output("S", 1.71);
    plant_steps(5);
    TEST_ASSERT_TRUE(phase_is("testing"));
}

static void to_down(void)
{
    until_output("S", 1.71 - 0.08);
    plant_steps(3);
}

static void to_back(void)
{
    until_output("S", 1.71);
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("testing"));
}

static void to_fitting(void)
{
    until_phase("fitting");
}

static void to_trial_there(void)
{
    ask_ok("commission accept");
    until("SETPOINT xD", 500);
    plant_steps(15);
    TEST_ASSERT_TRUE(phase_is("trial"));
}

static void to_trial_back(void)
{
    until("SETPOINT xD", 500);
    plant_steps(5);
    TEST_ASSERT_TRUE(phase_is("trial"));
}

/* ---- reset ---- */

/* The stored configuration is in force again and nothing acts; a new start-up makes its first step. */
static void begins_again_with_the_stored_set(void)
{
    TEST_ASSERT_TRUE(settings_are_as_before());
    ask_ok("loop");
    TEST_ASSERT_FALSE(said(" auto "));
    TEST_ASSERT_TRUE(nothing_was_stored());
    ask_ok("commission begin");
    until("TEST_STEP", 1000);
}

static void resets(void)
{
    board_resets(HAL_RESET_WATCHDOG);
    TEST_ASSERT_TRUE(phase_is("ended"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reply[1], "the board was reset"), reply[1]);
    plant_steps(4);
}

static void reset_it_reports_so_holds_and_begins_again(void)
{
    resets();
    TEST_ASSERT_FALSE(board.command.safe);
    outputs_are_held();
    begins_again_with_the_stored_set();
}

static void outputs_back_by_hand(void)
{
    commission_outputs_nominal();
    plant_steps(400);
}

/* What was on trial is not what is stored, so nothing is held. */
static void reset_on_trial_it_reports_so_and_begins_again(void)
{
    resets();
    outputs_are_safe();
    outputs_back_by_hand();
    begins_again_with_the_stored_set();
}

static void without_power_it_forgets_and_begins_again(void)
{
    nothing_goes_on_after_power_was_lost();
    outputs_are_safe();
    outputs_back_by_hand();
    begins_again_with_the_stored_set();
}

/* ---- a reading ---- */

static void first_reading_is_no_number(void)
{
    char line[40];
    for (size_t i = 0; i < kind->n_channels; i++)
        if (kind->channels[i].kind == PLANT_MEASUREMENT) {
            snprintf(line, sizeof line, "%s.nan=1", kind->channels[i].name);
            plant_event(line);
            break;
        }
    plant_steps(10);
}

static void a_reading_that_is_no_number_ends_it(void)
{
    first_reading_is_no_number();
    ended("is not valid");
    outputs_are_held();
    plant_steps(50);
    outputs_are_held();
}

static void a_reading_that_is_no_number_takes_the_trial_back(void)
{
    first_reading_is_no_number();
    TEST_ASSERT_TRUE(phase_is("returned"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reply[1], "is not valid"), reply[1]);
    TEST_ASSERT_TRUE(settings_are_as_before());
    outputs_are_held();
    TEST_ASSERT_TRUE(nothing_was_stored());
}

static void with_a_reading_that_is_no_number_it_is_not_accepted(void)
{
    first_reading_is_no_number();
    TEST_ASSERT_TRUE(phase_is("ready"));
    ask_refused("commission accept", "STATE");
    outputs_are_held();
    TEST_ASSERT_TRUE(settings_are_as_before());
}

/* ---- time ---- */

/* For an hour of the board's clock samples come every minute, all of them with the time of the last one. */
static void time_stands_still(void)
{
    struct frame f;
    struct link_sample sample;
    for (uint64_t end = board.clock_ms + AWHILE_MS; board.clock_ms < end;) {
        pass(60000);
        instruments_measure(&instruments, plant, 0.0, &sample);
        sample.number = ++board.number;
        sample.time_ms = board.time_ms - board.tick_ms;
        pack_sample(&sample, &f);
        link_give(&f);
        board_run();
    }
    TEST_ASSERT_TRUE(said("SAMPLE_STALLED"));
    outputs_are_safe();
}

static void no_sample_comes(void)
{
    board.mute = true;
    pass(AWHILE_MS);
    plant_connect();
}

static void ended_in_the_safe_state(void)
{
    plant_steps(2);
    ended("safe state");
    plant_steps(20);
    outputs_are_safe();
}

static void where_time_stands_still_it_ends_in_the_safe_state(void)
{
    time_stands_still();
    ended_in_the_safe_state();
}

static void where_no_sample_comes_it_ends_in_the_safe_state(void)
{
    no_sample_comes();
    ended_in_the_safe_state();
}

static void taken_back_in_the_safe_state(void)
{
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("returned"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reply[1], "safe state"), reply[1]);
    TEST_ASSERT_TRUE(settings_are_as_before());
    outputs_are_safe();
    TEST_ASSERT_TRUE(nothing_was_stored());
}

static void where_time_stands_still_the_trial_is_taken_back(void)
{
    time_stands_still();
    taken_back_in_the_safe_state();
}

static void where_no_sample_comes_the_trial_is_taken_back(void)
{
    no_sample_comes();
    taken_back_in_the_safe_state();
}

static void where_time_stands_still_the_proposal_waits(void)
{
    time_stands_still();
    plant_steps(2);
    TEST_ASSERT_TRUE(phase_is("ready"));
    ask_refused("commission accept", "STATE");
    TEST_ASSERT_TRUE(board.command.safe);
}

/* ---- each in each ---- */

/* What is configured is stored, and from now on the same is asked for again. */
static void is_stored(const char *first, const char *second)
{
    tested[0] = first;
    tested[1] = second;
    ask_ok("save");
    pass(500);
    TEST_ASSERT_FALSE(nothing_was_stored());
    memcpy(flash_before, memory_port_flash(), memory_port_flash_size());
    remember_settings();
}

static void everything_in_a_phase_of_the_tests(const char *phase)
{
    printf("%s\n", phase);
    CASE(reset_it_reports_so_holds_and_begins_again);
    CASE(without_power_it_forgets_and_begins_again);
    CASE(a_reading_that_is_no_number_ends_it);
    CASE(where_time_stands_still_it_ends_in_the_safe_state);
    CASE(where_no_sample_comes_it_ends_in_the_safe_state);
}

static void no_phase_of_a_test_leaves_a_step_standing(void)
{
    static const struct {
        const char *name;
        void (*begin)(void);
    } phases[] = {{"rest", to_rest},      {"paused by hand", to_paused},
                  {"up", to_up},          {"pause", to_pause},
                  {"down", to_down},      {"back", to_back},
                  {"fitting", to_fitting}};
    /* S passes this limit, so its step goes back to 0 before it is mirrored. */
    static const char *const more[] = {"set meas2.test_limit 1.5", "set restart.policy hold",
                                       "set restart.limit 3600", NULL};
    memory_port_erase_all();
    wood_berry(more);
    is_stored("R", "S");
    for (unsigned k = 0; k < sizeof phases / sizeof *phases; k++) {
        phases[k].begin();
        everything_in_a_phase_of_the_tests(phases[k].name);
    }
    memory_port_erase_all();
}

/* With a tick of 0.1 s, so that a good many ticks pass before the result is taken. */
static void nothing_is_left_of_an_analysis(void)
{
    static const char *const more[] = {"set restart.policy hold", "set restart.limit 3600", NULL};
    memory_port_erase_all();
    commission_plant("air-compressor", 100, 0.0, more);
    is_stored("u1", "u2");
    ask_ok("commission begin");
    until_phase("analysing");
    plant_steps(5);
    TEST_ASSERT_TRUE(phase_is("analysing"));
    everything_in_a_phase_of_the_tests("analysing");
    memory_port_erase_all();
}

/* A turn of the main loop, and with it a piece of the work, for each sample. */
static void steps_of_a_turn(unsigned n)
{
    while (n--)
        (void)waits_for_its_answer();
}

static void left_alone_it_is_under_way_and_comes_to_its_end(void)
{
    unsigned waited = 0;
    board_forget();
    for (unsigned n = 0; n < 400 && !said("PROPOSAL"); n++)
        waited += waits_for_its_answer();
    TEST_ASSERT_TRUE(said("PROPOSAL"));
    TEST_ASSERT_EQUAL_MESSAGE(1, waited, "the result was there before its time");
}

static void given_up_in_the_middle_it_begins_again(void)
{
    (void)memory_port_give(HAL_UART_CONSOLE, (const uint8_t *)"commission abort\n", 17);
    steps_of_a_turn(3);
    (void)memory_port_give(HAL_UART_CONSOLE, (const uint8_t *)"commission begin\n", 17);
    steps_of_a_turn(3);
    until("TEST_STEP", 1000);
    TEST_ASSERT_FALSE(said("err "));
    TEST_ASSERT_TRUE(nothing_was_stored());
}

static void a_reading_lost_in_the_middle_ends_it(void)
{
    plant_event("y1.nan=1");
    steps_of_a_turn(10);
    ended("is not valid");
    outputs_are_held();
    plant_steps(300);
    ended("is not valid"); /* nobody takes the result of what was given up */
    outputs_are_held();
}

static void nothing_is_left_of_half_an_analysis(void)
{
    static const char *const more[] = {"set restart.policy hold", "set restart.limit 3600", NULL};
    memory_port_erase_all();
    commission_plant("air-compressor", 100, 0.0, more);
    is_stored("u1", "u2");
    ask_ok("commission begin");
    until("TEST_DONE u2", 4000); /* the fit is worked out, and taken 21 samples later */
    steps_of_a_turn(100);
    CASE(left_alone_it_is_under_way_and_comes_to_its_end);
    CASE(given_up_in_the_middle_it_begins_again);
    CASE(a_reading_lost_in_the_middle_ends_it);
    everything_in_a_phase_of_the_tests("half an analysis");
    memory_port_erase_all();
}

static void everything_on_trial(const char *part)
{
    printf("trial %s\n", part);
    CASE(reset_on_trial_it_reports_so_and_begins_again);
    CASE(without_power_it_forgets_and_begins_again);
    CASE(a_reading_that_is_no_number_takes_the_trial_back);
    CASE(where_time_stands_still_the_trial_is_taken_back);
    CASE(where_no_sample_comes_the_trial_is_taken_back);
}

static void a_proposal_waits_or_is_taken_back(void)
{
    static const char *const more[] = {"set restart.policy hold", "set restart.limit 3600", NULL};
    memory_port_erase_all();
    wood_berry(more);
    is_stored("R", "S");
    proposal();
    CASE(reset_it_reports_so_holds_and_begins_again);
    CASE(without_power_it_forgets_and_begins_again);
    CASE(with_a_reading_that_is_no_number_it_is_not_accepted);
    CASE(where_time_stands_still_the_proposal_waits);
    to_trial_there();
    everything_on_trial("there");
    to_trial_back();
    everything_on_trial("back");
    memory_port_erase_all();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(no_phase_of_a_test_leaves_a_step_standing);
    RUN_TEST(nothing_is_left_of_an_analysis);
    RUN_TEST(nothing_is_left_of_half_an_analysis);
    RUN_TEST(a_proposal_waits_or_is_taken_back);
    int failed = UNITY_END();
    plant_power_off();
    plant_library_free();
    return failed;
}
