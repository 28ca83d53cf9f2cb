/* The watchdog of the host port really resets: a firmware that hangs is started again. */
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
#include "unity.h"

#define TIMEOUT_MS 200

/* A firmware that does what the test wants in each of its lives. */
struct app {
    int unused;
};
static struct app the_app;
static unsigned starts;
static enum { HANG_IN_MAIN, HANG_IN_TICK, HEALTHY } plan;
static uint64_t started_ms;
static enum hal_reset causes[4];
static uint32_t kept[4];

struct app *app_instance(void)
{
    return &the_app;
}

void app_init(struct app *app)
{
    (void)app;
    uint32_t *memory = hal_retained(HAL_RETAINED_RESTART, sizeof *memory);
    TEST_ASSERT_TRUE(hal_watchdog_start(TIMEOUT_MS));
    TEST_ASSERT_LESS_THAN(4, starts);
    causes[starts] = hal_reset_cause();
    kept[starts] = *memory;
    *memory = 0xBEEF0000u + starts;
    plan = starts == 0 ? HANG_IN_MAIN : starts == 1 ? HANG_IN_TICK : HEALTHY;
    starts++;
    started_ms = hal_clock_ms();
}

void app_background(struct app *app)
{
    (void)app;
    while (plan == HANG_IN_MAIN)
        (void)usleep(1000);
    if (plan == HEALTHY && hal_clock_ms() - started_ms > 4 * TIMEOUT_MS)
        host_port_stop();
}

void app_tick(struct app *app)
{
    (void)app;
    for (volatile unsigned n = 0; plan == HANG_IN_TICK; n = n + 1)
        continue;
    hal_watchdog_feed();
}

void setUp(void) {}
void tearDown(void) {}

static void a_firmware_that_hangs_is_reset_and_a_healthy_one_is_not(void)
{
    char folder[] = "/tmp/reflux-watchdog-XXXXXX", console[64], link[64], err[256];
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    (void)snprintf(console, sizeof console, "socket:%s/console", folder);
    (void)snprintf(link, sizeof link, "socket:%s/link", folder);
    struct host_port_options options = {
        .console = console, .link = link, .boot_id = 7, .watchdog = true};
    TEST_ASSERT_TRUE_MESSAGE(host_port_open(&options, err, sizeof err), err);
    host_port_run();
    TEST_ASSERT_EQUAL(3, starts);
    TEST_ASSERT_EQUAL(HAL_RESET_POWER_ON, causes[0]);
    TEST_ASSERT_EQUAL(HAL_RESET_WATCHDOG, causes[1]);
    TEST_ASSERT_EQUAL(HAL_RESET_WATCHDOG, causes[2]);
    TEST_ASSERT_EQUAL_HEX32(0xBEEF0000u, kept[1]); /* that memory has survived */
    TEST_ASSERT_EQUAL_HEX32(0xBEEF0001u, kept[2]);
    TEST_ASSERT_EQUAL(9, hal_boot_id());
    host_port_close();
    (void)rmdir(folder);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_firmware_that_hangs_is_reset_and_a_healthy_one_is_not);
    return UNITY_END();
}
