/* Warnings that come again and again leave the history of events to what people did. Rebuilt from a public report: with a jitter of
 * 20 % all 100 entries were warnings after 200 samples, and who had changed the mode was gone. */
#include "board_bench.h"

void setUp(void)
{
    running();
    ask_ok("mode bottom auto");
    board_forget();
}
void tearDown(void) {}

static void jitter(unsigned n)
{
    for (unsigned k = 0; k < n; k++) /* in time of the plant's, of which a tick is 1 s */
        sample_after(k % 2 ? 800 : 1200);
}

static void who_changed_the_mode_is_still_there_after_minutes_of_jitter(void)
{
    jitter(200);
    TEST_ASSERT_TRUE(times_said("warning SAMPLE_") > 90); /* each is announced as ever */
    ask_ok("events");
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("action DO_MODE bottom 1"), board.said);
    TEST_ASSERT_EQUAL(2, times_said("warning SAMPLE_EARLY"));
    TEST_ASSERT_EQUAL(2, times_said("warning SAMPLE_MISSING"));
    TEST_ASSERT_TRUE(said("times so far, this is the latest"));
}

static void an_alarm_that_flaps_takes_four_entries(void)
{
    for (unsigned k = 0; k < 120; k++) {
        board.quality[0] = k % 2 ? 2 : 0;
        samples(1);
    }
    ask_ok("events");
    TEST_ASSERT_EQUAL_MESSAGE(2, times_said("alarm MEASUREMENT_BAD T1"), board.said);
    TEST_ASSERT_EQUAL(2, times_said("info MEASUREMENT_GOOD T1"));
    TEST_ASSERT_EQUAL(1, times_said("action DO_MODE bottom 1"));
    TEST_ASSERT_TRUE(said("alarm MEASUREMENT_BAD T1 60 times so far"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(who_changed_the_mode_is_still_there_after_minutes_of_jitter);
    RUN_TEST(an_alarm_that_flaps_takes_four_entries);
    return UNITY_END();
}
