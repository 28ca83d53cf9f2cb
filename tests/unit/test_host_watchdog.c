/* The watchdog of the host port really resets: a firmware that hangs is started again; one that had a late tick and
 * then no more to do is not. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/app.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/retained.h"
#include "hal/watchdog.h"
#include "host_port.h"
#include "service/heartbeat.h"
#include "unity.h"

#define TIMEOUT_MS  400
#define DEADLINE_MS 5

/* A firmware that does what the test wants in each of its lives. */
struct app {
    int unused;
};
static struct app the_app;
static unsigned starts;
static enum { HANG_IN_MAIN, HANG_IN_TICK, LATE_ONCE } plan;
static struct heartbeat heartbeat;
static uint32_t turns;
static unsigned ticks;
static uint64_t started_ms, turned_ms, held_up_ms;
/* On a busy machine a process may get no turn for long: then the watchdog is right to bite, and the last life begins
 * again. */
static bool in_time = true;
static enum hal_reset causes[3];
static uint32_t kept[3];

/* Longest time for which the machine kept this life from its tick. */
static void note_turn(void)
{
    uint64_t now = hal_clock_ms();
    held_up_ms = now - turned_ms > held_up_ms ? now - turned_ms : held_up_ms;
    turned_ms = now;
}

struct app *app_instance(void)
{
    return &the_app;
}

void app_init(struct app *app)
{
    (void)app;
    uint32_t *memory = hal_retained(HAL_RETAINED_RESTART, sizeof *memory);
    TEST_ASSERT_TRUE(hal_watchdog_start(TIMEOUT_MS));
    note_turn();
    if (starts < 3) {
        causes[starts] = hal_reset_cause();
        kept[starts] = *memory;
    } else if (held_up_ms < TIMEOUT_MS / 8 || starts > 100) {
        in_time = false;
        host_port_stop();
    }
    *memory = 0xBEEF0000u + starts;
    plan = starts == 0 ? HANG_IN_MAIN : starts == 1 ? HANG_IN_TICK : LATE_ONCE;
    heartbeat_init(&heartbeat, TIMEOUT_MS);
    ticks = 0;
    starts++;
    started_ms = turned_ms;
    held_up_ms = 0;
}

void app_background(struct app *app)
{
    (void)app;
    while (plan == HANG_IN_MAIN)
        (void)usleep(1000);
    turns++;
    (void)usleep(1000);
    if (plan == LATE_ONCE && hal_clock_ms() - started_ms > 4 * TIMEOUT_MS)
        host_port_stop();
}

void app_clock(struct app *app, uint32_t now_ms)
{
    (void)app;
    (void)now_ms;
}

void app_tick(struct app *app)
{
    (void)app;
    note_turn();
    while (plan == HANG_IN_TICK)
        (void)usleep(1000);
    if (plan == LATE_ONCE && ++ticks == 3) { /* the others have no sample */
        heartbeat_tick_begins(&heartbeat, hal_clock_ms());
        (void)usleep(2000 * DEADLINE_MS);
        heartbeat_tick_ends(&heartbeat, hal_clock_ms(), DEADLINE_MS);
    }
    if (heartbeat_due(&heartbeat, hal_clock_ms(), turns))
        hal_watchdog_feed();
}

void setUp(void) {}
void tearDown(void) {}

static void a_firmware_that_hangs_is_reset_and_one_with_a_late_tick_is_not(void)
{
    char folder[] = "/tmp/reflux-watchdog-XXXXXX", console[64], link[64], err[256];
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    (void)snprintf(console, sizeof console, "socket:%s/console", folder);
    (void)snprintf(link, sizeof link, "socket:%s/link", folder);
    struct host_port_options options = {
        .console = console, .link = link, .boot_id = 7, .watchdog = true};
    TEST_ASSERT_TRUE_MESSAGE(host_port_open(&options, err, sizeof err), err);
    host_port_run();
    TEST_ASSERT_TRUE_MESSAGE(in_time, "reset although nothing held it up");
    TEST_ASSERT_GREATER_OR_EQUAL(3, starts);
    TEST_ASSERT_EQUAL(HAL_RESET_POWER_ON, causes[0]);
    TEST_ASSERT_EQUAL(HAL_RESET_WATCHDOG, causes[1]);
    TEST_ASSERT_EQUAL(HAL_RESET_WATCHDOG, causes[2]);
    TEST_ASSERT_EQUAL_HEX32(0xBEEF0000u, kept[1]); /* that memory has survived */
    TEST_ASSERT_EQUAL_HEX32(0xBEEF0001u, kept[2]);
    TEST_ASSERT_EQUAL(7 + starts - 1, hal_boot_id());
    host_port_close();
    (void)rmdir(folder);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_firmware_that_hangs_is_reset_and_one_with_a_late_tick_is_not);
    return UNITY_END();
}
