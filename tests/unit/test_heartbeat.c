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

static void a_tick_past_its_deadline_starves_it_until_one_is_in_time(void)
{
    heartbeat_tick_begins(&h, now);
    heartbeat_tick_ends(&h, now + 301, 300);
    TEST_ASSERT_EQUAL(0, fed(3000, true));
    heartbeat_tick_begins(&h, now);
    heartbeat_tick_ends(&h, now + 300, 300);
    TEST_ASSERT_TRUE(fed(3000, true) > 10);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_is_fed_at_a_fixed_rate);
    RUN_TEST(a_main_loop_that_hangs_starves_it_within_half_its_time);
    RUN_TEST(a_tick_past_its_deadline_starves_it_until_one_is_in_time);
    return UNITY_END();
}
