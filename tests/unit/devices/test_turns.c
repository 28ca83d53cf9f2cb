/* What all devices share: when they have their turn, who has the bus, and how a result reaches the tick. The device here reads two bytes of
 * a chip in each cycle.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>

#include "devices/line.h"
#include "scripted_bus.h"
#include "unity.h"

static struct device a, b;
static unsigned steps;

static enum err two_bytes_open(struct device *d)
{
    d->spi = (struct spi_device){.bus = d->settings.bus, .select = d->settings.select};
    return hal_spi_open(&d->spi);
}

static uint16_t two_bytes_step(struct device *d, uint32_t now_ms)
{
    int32_t code[DEVICE_CODES] = {0};
    steps++;
    if (device_has_begun(d)) {
        uint16_t faults = device_ended(d);
        code[0] = d->bytes[1] << 8 | d->bytes[2];
        d->ready = true;
        return device_finish(d, now_ms, code, faults);
    }
    d->began_ms = now_ms;
    d->bytes[0] = 0x11;
    return device_begin(d, now_ms, 1, 2, 4);
}

static const struct device_kind two_bytes = {.name = "two",
                                             .line = DEVICE_SPI,
                                             .interval_ms = 20,
                                             .open = two_bytes_open,
                                             .step = two_bytes_step};

static void begin(struct device *d, uint16_t interval_ms)
{
    struct device_settings s = {.bus = 1, .select = HAL_PIN('B', 0)};
    TEST_ASSERT_EQUAL(ERR_OK, device_open(d, &two_bytes, &s, interval_ms));
}

void setUp(void)
{
    script_clear();
    steps = 0;
    begin(&a, 100);
    begin(&b, 100);
}
void tearDown(void) {}

static void a_device_has_no_result_at_first(void)
{
    TEST_ASSERT_EQUAL(0, script_result(&a).number);
}

static void results_come_in_the_interval(void)
{
    for (unsigned k = 0; k < 4; k++)
        script("11", "12 34");
    script_run(&a, 320);
    script_is_done();
    for (unsigned k = 1; k < 4; k++)
        TEST_ASSERT_EQUAL(100 * k, script_began_ms(k) - script_began_ms(0));
    struct device_result r = script_result(&a);
    TEST_ASSERT_EQUAL(4, r.number);
    TEST_ASSERT_EQUAL(0x1234, r.code[0]);
    TEST_ASSERT_EQUAL(script_began_ms(3), r.stamp_ms);
}

static void an_interval_is_not_shorter_than_the_kind_can(void)
{
    begin(&a, 3);
    for (unsigned k = 0; k < 3; k++)
        script("11", "12 34");
    script_run(&a, 50);
    script_is_done();
    TEST_ASSERT_EQUAL(20, script_began_ms(1) - script_began_ms(0));
}

static void nothing_is_stepped_between_its_turns(void)
{
    script("11", "12 34");
    script_run(&a, 100);
    TEST_ASSERT_EQUAL(2, steps);
}

/* As when the flash is erased and nothing runs. */
static void a_turn_that_the_clock_missed_is_taken_later(void)
{
    script("11", "12 34");
    script("11", "12 34");
    script_run(&a, 3);
    script_board.now_ms += 1700;
    script_run(&a, 150);
    script_is_done();
    TEST_ASSERT_EQUAL(2, script_result(&a).number);
}

/* The clock wraps after 49.7 days. */
static void the_wrap_of_the_clock_changes_nothing(void)
{
    script_board.now_ms = UINT32_MAX - 150;
    for (unsigned k = 0; k < 4; k++)
        script("11", "12 34");
    script_run(&a, 400); /* the first begins at the next whole multiple of the interval */
    script_is_done();
    for (unsigned k = 1; k < 4; k++)
        TEST_ASSERT_EQUAL(100 * k, script_began_ms(k) - script_began_ms(0));
}

static void a_device_that_is_opened_late_in_the_life_of_the_clock_begins_at_once(void)
{
    script_board.now_ms = 3000000000u;
    script("11", "12 34");
    script_run(&a, 10);
    script_is_done();
}

static void two_devices_take_turns_on_one_bus(void)
{
    struct device *both[] = {&a, &b};
    for (unsigned k = 0; k < 4; k++)
        script("11", "12 34");
    script_run_several(both, 2, 150);
    script_is_done();
    TEST_ASSERT_EQUAL(1, script_began_ms(1) - script_began_ms(0));
    TEST_ASSERT_EQUAL(2, script_result(&a).number);
    TEST_ASSERT_EQUAL(2, script_result(&b).number);
}

static void a_busy_bus_is_asked_again(void)
{
    script_board.busy = 7;
    script("11", "12 34");
    script_run(&a, 50);
    script_is_done();
    TEST_ASSERT_EQUAL(1007, script_began_ms(0));
    TEST_ASSERT_EQUAL_HEX16(0, script_result(&a).faults);
}

static void a_bus_that_stays_busy_is_a_fault(void)
{
    script_board.busy = 1000000;
    script_run(&a, 300);
    TEST_ASSERT_EQUAL(1, script_result(&a).number);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, script_result(&a).faults);
    TEST_ASSERT_EQUAL(0, script_seen.stops); /* it is not this device's transfer */
    script_board.busy = 0;
    script("11", "12 34");
    script_run(&a, 50);
    TEST_ASSERT_EQUAL_HEX16(0, script_result(&a).faults);
}

static void ends_of_transfers_are_told_apart(void)
{
    script_fails("11", 2, TRANSFER_NO_ANSWER);
    script_fails("11", 2, TRANSFER_FAILED);
    script_fails("11", 2, SCRIPT_NEVER_ENDS);
    script_run(&a, 100);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, script_result(&a).faults);
    TEST_ASSERT_FALSE(a.ready);
    script_run(&a, 100);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, script_result(&a).faults);
    TEST_ASSERT_EQUAL(0, script_seen.stops);
    script_run(&a, 100);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, script_result(&a).faults);
    TEST_ASSERT_EQUAL(1, script_seen.stops);
}

/* Begins a transfer of n bytes, 1 of them out, on this kind of bus. Returns ms until the next turn. */
static uint16_t wait_of(uint8_t line, unsigned n, uint16_t wait_ms)
{
    static struct device_kind kind;
    char in[3 * DEVICE_BUFFER + 1] = "";
    for (size_t k = 1; k < n; k++)
        snprintf(in + 3 * (k - 1), 4, "00 ");
    kind = two_bytes;
    kind.line = line;
    a.kind = &kind;
    a.bytes[0] = 0x11;
    script_clear();
    script("11", in);
    uint16_t ms = device_begin(&a, 1000, 1, (uint8_t)(n - 1), wait_ms);
    script_is_done();
    return ms;
}

/* I2C: bits of 10 us; 1-wire: 1.1 ms for the reset pulse, 87 us for a bit; SPI: 1 us. A tenth of it is for what comes between bytes, and the first
 * millisecond may be a short one. */
static void transfers_have_the_time_that_their_bytes_need(void)
{
    for (unsigned n = 1; n <= DEVICE_BUFFER; n++) {
        double i2c_ms = 1.1 * (n + 2) * 9 * 0.01, onewire_ms = 1.1 * (1.1 + n * 8 * 0.087);
        TEST_ASSERT_GREATER_THAN((int)i2c_ms, wait_of(DEVICE_I2C, n, 0));
        TEST_ASSERT_GREATER_THAN((int)onewire_ms, wait_of(DEVICE_ONEWIRE, n, 0));
        TEST_ASSERT_EQUAL(1, wait_of(DEVICE_SPI, n, 0));
        TEST_ASSERT_EQUAL(wait_of(DEVICE_I2C, n, 0) + 100, wait_of(DEVICE_I2C, n, 100));
    }
}

static void a_cycle_that_is_late_does_not_pile_up(void)
{
    begin(&a, 20);
    script_board.busy = 45;
    for (unsigned k = 0; k < 3; k++)
        script("11", "12 34");
    script_run(&a, 90);
    script_is_done();
    TEST_ASSERT_EQUAL(1045, script_began_ms(0));
    TEST_ASSERT_EQUAL(1060, script_began_ms(1)); /* a whole multiple of the interval again */
    TEST_ASSERT_EQUAL(20, script_began_ms(2) - script_began_ms(1));
}

static void the_number_of_a_result_is_never_0_again(void)
{
    int32_t code[DEVICE_CODES] = {0};
    a.result.number = UINT32_MAX;
    device_publish(&a, code, 0);
    TEST_ASSERT_EQUAL(1, script_result(&a).number);
}

/* The clock interrupts the tick: here a signal does. */
static volatile uint32_t published;

static void publish_next(int signal_number)
{
    (void)signal_number;
    int32_t n = (int32_t)++published;
    const int32_t code[DEVICE_CODES] = {n, n, n};
    a.began_ms = (uint32_t)n;
    device_publish(&a, code, (uint16_t)n);
}

static void a_result_that_is_published_while_it_is_read_is_whole(void)
{
    const struct itimerval often = {{0, 53}, {0, 53}}, never = {{0, 0}, {0, 0}};
    uint32_t last = 0, changes = 0;
    published = 0;
    signal(SIGALRM, publish_next);
    setitimer(ITIMER_REAL, &often, NULL);
    while (published < 3000) {
        struct device_result r = script_result(&a);
        changes += r.number != last;
        bool whole = r.code[0] == (int32_t)r.number && r.code[1] == r.code[0] &&
                     r.code[2] == r.code[0] && r.stamp_ms == r.number &&
                     r.faults == (uint16_t)r.number && r.number >= last;
        last = r.number;
        if (!whole) {
            setitimer(ITIMER_REAL, &never, NULL);
            TEST_FAIL_MESSAGE("parts of two results");
        }
    }
    setitimer(ITIMER_REAL, &never, NULL);
    TEST_ASSERT_GREATER_THAN(1000, changes);
}

static void an_open_device_forgets_what_it_was(void)
{
    script("11", "12 34");
    script_run(&a, 50);
    begin(&a, 50);
    TEST_ASSERT_EQUAL(0, script_result(&a).number);
    TEST_ASSERT_FALSE(a.ready);
}

/* Its memory is another device's next, and the bus would write into it. */
static void a_device_that_is_closed_leaves_no_transfer_behind(void)
{
    script_fails("11", 2, SCRIPT_NEVER_ENDS);
    script_run(&a, 1);
    TEST_ASSERT_EQUAL(TRANSFER_RUNS, a.transfer.state);
    device_close(&a);
    TEST_ASSERT_EQUAL(1, script_seen.stops);
}

static void closing_a_device_stops_no_transfer_of_another(void)
{
    script("11", "12 34");
    script_run(&a, 50);
    script_is_done();
    device_close(&a);
    TEST_ASSERT_EQUAL(0, script_seen.stops);
}

/* ---- claims ---- */

static void a_claim_keeps_others_off_until_it_ends(void)
{
    TEST_ASSERT_TRUE(line_claim(1, 1, 5, &a, 100, 10));
    TEST_ASSERT_FALSE(line_claim(1, 1, 5, &b, 109, 10));
    TEST_ASSERT_TRUE(line_claim(1, 1, 6, &b, 109, 10)); /* another chip, bus, kind of bus */
    TEST_ASSERT_TRUE(line_claim(1, 2, 5, &b, 109, 10));
    TEST_ASSERT_TRUE(line_claim(2, 1, 5, &b, 109, 10));
    TEST_ASSERT_TRUE(line_claim(1, 1, 5, &b, 110, 10));
    TEST_ASSERT_FALSE(line_claim(1, 1, 5, &a, 111, 10));
    line_release(&b);
    TEST_ASSERT_TRUE(line_claim(1, 1, 5, &a, 111, 10));
    line_release(&a);
}

static void a_holder_renews_its_claim(void)
{
    TEST_ASSERT_TRUE(line_claim(1, 1, 5, &a, 100, 10));
    TEST_ASSERT_TRUE(line_claim(1, 1, 5, &a, 105, 10));
    TEST_ASSERT_FALSE(line_claim(1, 1, 5, &b, 112, 10));
    line_release(&a);
    TEST_ASSERT_TRUE(line_claim(1, 1, 5, &b, 112, 10));
    line_release(&b);
}

static void a_release_ends_no_claim_of_another_holder(void)
{
    TEST_ASSERT_TRUE(line_claim(1, 1, 5, &a, 100, 10));
    line_release(&b);
    TEST_ASSERT_FALSE(line_claim(1, 1, 5, &b, 105, 10));
    line_release(&a);
}

static void more_claims_than_there_are_places_are_refused(void)
{
    for (uint8_t k = 0; k < LINE_CLAIMS_MAX; k++)
        TEST_ASSERT_TRUE(line_claim(1, k, 5, &a, 100, 10));
    TEST_ASSERT_FALSE(line_claim(1, 99, 5, &a, 100, 10));
    TEST_ASSERT_TRUE(line_claim(1, 99, 5, &a, 110, 10));
    line_release(&a);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_device_has_no_result_at_first);
    RUN_TEST(results_come_in_the_interval);
    RUN_TEST(an_interval_is_not_shorter_than_the_kind_can);
    RUN_TEST(nothing_is_stepped_between_its_turns);
    RUN_TEST(a_turn_that_the_clock_missed_is_taken_later);
    RUN_TEST(the_wrap_of_the_clock_changes_nothing);
    RUN_TEST(a_device_that_is_opened_late_in_the_life_of_the_clock_begins_at_once);
    RUN_TEST(two_devices_take_turns_on_one_bus);
    RUN_TEST(a_busy_bus_is_asked_again);
    RUN_TEST(a_bus_that_stays_busy_is_a_fault);
    RUN_TEST(ends_of_transfers_are_told_apart);
    RUN_TEST(transfers_have_the_time_that_their_bytes_need);
    RUN_TEST(a_cycle_that_is_late_does_not_pile_up);
    RUN_TEST(the_number_of_a_result_is_never_0_again);
    RUN_TEST(a_result_that_is_published_while_it_is_read_is_whole);
    RUN_TEST(an_open_device_forgets_what_it_was);
    RUN_TEST(a_device_that_is_closed_leaves_no_transfer_behind);
    RUN_TEST(closing_a_device_stops_no_transfer_of_another);
    RUN_TEST(a_claim_keeps_others_off_until_it_ends);
    RUN_TEST(a_holder_renews_its_claim);
    RUN_TEST(a_release_ends_no_claim_of_another_holder);
    RUN_TEST(more_claims_than_there_are_places_are_refused);
    return UNITY_END();
}
