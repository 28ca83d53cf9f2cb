/* When the watchdog may be fed. */
#include "service/heartbeat.h"

#include "unity.h"

static struct heartbeat h;
static uint64_t now;
static uint32_t turns;

void setUp(void)
{
    now = 100;
    turns = 1;
    heartbeat_init(&h, 2000);
    TEST_ASSERT_TRUE(heartbeat_due(&h, now, turns));
}
void tearDown(void) {}

/* Times it was fed over so many milliseconds, asked every 10. */
static unsigned fed(unsigned ms, bool main_loop_turns)
{
    unsigned n = 0;
    for (uint64_t end = now + ms; now < end;) {
        now += 10;
        turns += main_loop_turns;
        n += heartbeat_due(&h, now, turns);
    }
    return n;
}

static void it_is_fed_at_a_fixed_rate(void)
{
    TEST_ASSERT_EQUAL(40, fed(10000 + 0, true));
}

static void a_main_loop_that_hangs_starves_it_within_half_its_time(void)
{
    (void)fed(1000, true);
    unsigned n = fed(1000, false);
    TEST_ASSERT_TRUE(n >= 3 && n <= 4);
    TEST_ASSERT_EQUAL(0, fed(10000, false));
    TEST_ASSERT_TRUE(fed(1000, true) >= 3); /* it has come back in time */
}

/* A tick of so many ms against a deadline of 300. */
static void tick_of(unsigned ms)
{
    heartbeat_tick_begins(&h, now);
    now += ms;
    heartbeat_tick_ends(&h, now, 300);
}

static void ticks_that_are_late_one_upon_another_starve_it(void)
{
    unsigned n = 0;
    for (unsigned k = 0; k < 20; k++) {
        tick_of(301);
        turns++;
        n += heartbeat_due(&h, now, turns);
        n += fed(100, true); /* the plant's next sample is not there at once */
    }
    TEST_ASSERT_EQUAL(1, n); /* after the first */
    tick_of(300);
    TEST_ASSERT_TRUE(fed(3000, true) > 10);
}

static void one_late_tick_starves_nobody_whatever_comes_after_it(void)
{
    tick_of(301);
    TEST_ASSERT_EQUAL(40, fed(10000, true)); /* silence */
    tick_of(1700);
    TEST_ASSERT_TRUE(heartbeat_due(&h, now, ++turns));
    tick_of(10);
    TEST_ASSERT_EQUAL(4, fed(1000, true));
}

static void late_ticks_followed_by_silence_starve_it_for_a_quarter_of_its_time(void)
{
    tick_of(301);
    tick_of(301);
    TEST_ASSERT_EQUAL(0, fed(490, true));
    TEST_ASSERT_TRUE(fed(1000, true) >= 4);
    tick_of(301); /* it counts from one again */
    TEST_ASSERT_TRUE(heartbeat_due(&h, now, ++turns));
}

static void a_shorter_time_is_fed_at_once_and_at_its_own_rate(void)
{
    (void)fed(100, true);
    heartbeat_change(&h, 1000);
    TEST_ASSERT_TRUE(heartbeat_due(&h, now, ++turns));
    TEST_ASSERT_FALSE(heartbeat_due(&h, now, ++turns));
    TEST_ASSERT_EQUAL(80, fed(10000 + 400, true));
}

static void a_main_loop_that_hangs_starves_a_shorter_time_sooner(void)
{
    heartbeat_change(&h, 1000);
    (void)fed(1000, true);
    unsigned n = fed(500, false);
    TEST_ASSERT_TRUE(n >= 3 && n <= 4);
    TEST_ASSERT_EQUAL(0, fed(10000, false));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_is_fed_at_a_fixed_rate);
    RUN_TEST(a_main_loop_that_hangs_starves_it_within_half_its_time);
    RUN_TEST(ticks_that_are_late_one_upon_another_starve_it);
    RUN_TEST(one_late_tick_starves_nobody_whatever_comes_after_it);
    RUN_TEST(late_ticks_followed_by_silence_starve_it_for_a_quarter_of_its_time);
    RUN_TEST(a_shorter_time_is_fed_at_once_and_at_its_own_rate);
    RUN_TEST(a_main_loop_that_hangs_starves_a_shorter_time_sooner);
    return UNITY_END();
}
