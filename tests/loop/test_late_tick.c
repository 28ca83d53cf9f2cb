/* Ticks that take too long, on the whole firmware: when that starves the watchdog, and when not. */
#include "board_bench.h"

#define WATCHDOG_MS 2000

/* A base tick of 50 ms, which is the deadline. */
void setUp(void)
{
    power_on();
    board.tick_ms = 50;
    configure();
    connect_plant();
    samples(5);
    (void)memory_port_unfed_ms();
}
void tearDown(void) {}

static void tick_of(uint32_t ms)
{
    memory_port_slow_frame(ms);
    samples(1);
    board.clock_ms += ms;
}

static void one_late_tick_and_an_unplugged_plant_reset_nobody(void)
{
    tick_of(51);
    board.mute = true;
    pass(60000);
    TEST_ASSERT_LESS_THAN_UINT64(WATCHDOG_MS, memory_port_unfed_ms());
}

static void one_late_tick_of_a_slow_plant_resets_nobody(void)
{
    tick_of(1500);
    pass(60000); /* it is there, and sends nothing */
    TEST_ASSERT_LESS_THAN_UINT64(WATCHDOG_MS, memory_port_unfed_ms());
}

static void a_few_late_ticks_reset_nobody(void)
{
    for (unsigned n = 0; n < 10; n++)
        tick_of(60);
    board.mute = true;
    pass(60000);
    TEST_ASSERT_LESS_THAN_UINT64(WATCHDOG_MS, memory_port_unfed_ms());
}

static void ticks_that_never_keep_up_end_in_a_reset(void)
{
    for (unsigned n = 0; n < 40; n++) {
        tick_of(51);
        pass(50);
    }
    TEST_ASSERT_GREATER_THAN_UINT64(WATCHDOG_MS, memory_port_unfed_ms());
}

static void ticks_in_time_feed_it_all_the_while(void)
{
    for (unsigned n = 0; n < 40; n++) {
        tick_of(50);
        pass(50);
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT64(WATCHDOG_MS / 4, memory_port_unfed_ms());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(one_late_tick_and_an_unplugged_plant_reset_nobody);
    RUN_TEST(one_late_tick_of_a_slow_plant_resets_nobody);
    RUN_TEST(a_few_late_ticks_reset_nobody);
    RUN_TEST(ticks_that_never_keep_up_end_in_a_reset);
    RUN_TEST(ticks_in_time_feed_it_all_the_while);
    return UNITY_END();
}
