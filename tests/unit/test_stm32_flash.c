/* The STM32F405's flash and watchdog drivers on plain memory that lies where their registers are: in an
 * erase the watchdog is fed, the supply watched and the plant link kept alive. What the flash itself does is not modelled. */
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

#include "app/app.h"
#include "board.h"
#include "hal/nvm.h"
#include "hal/tick.h"
#include "hal/watchdog.h"
#include "registers.h"
#include "unity.h"
#include "watchdog_time.h"

#define AREA      ((uint8_t *)0x080C0000u)
#define AREA_SIZE 0x40000u
#define PAGE      0x1000u

#define USUAL_MS 2000u /* WATCHDOG_MS in firmware/app/parts.h */
#define PINS_MS  1000u /* WATCHDOG_PINS_MS there */
/* DS8626: kHz of the watchdog's clock over chips and temperature. */
#define SLOWEST 17u
#define FASTEST 47u
/* Outputs must be off so soon after the last command, which may be a turn of the tick older than the last feeding. */
#define DEAD_MAN_MS 2000u
#define TURN_MS     50u

static unsigned erases, fed, unfed, n_sent, held;
static unsigned busy_ms, dip_at_ms, passed; /* passed: looks at the status of a busy flash */
static uint8_t sent[8 * APP_KEEP_ALIVE_BYTES];
static bool worn;     /* an erase leaves a bit */
static bool protects; /* an erase is refused */
static bool plant;
static uint32_t status;

void hal_tick_lock(void) {}
void hal_tick_unlock(void) {}
void hal_tick_request(void) {}

struct app *app_instance(void)
{
    return NULL;
}

/* Frames that tell one from another; the sixth never comes. */
size_t app_keep_alive(struct app *app, uint8_t *wire)
{
    static uint8_t frame;
    (void)app;
    for (uint8_t i = 0; i < APP_KEEP_ALIVE_BYTES; i++)
        wire[i] = (uint8_t)(frame % 5u * 16u + i);
    frame++;
    return plant ? APP_KEEP_ALIVE_BYTES : 0;
}

void uart_hold_interrupts(bool hold)
{
    held = held + (hold ? 1u : -1u);
}

bool uart_serve_link(const uint8_t *more)
{
    if (more == NULL)
        return false;
    TEST_ASSERT_TRUE(n_sent < sizeof sent);
    sent[n_sent++] = *more;
    return true;
}

/* Writing ones clears them (RM0090 3.9.5). */
volatile uint32_t *flash_status(void)
{
    static uint32_t shown, given;
    if (shown != given)
        status &= ~shown;
    uint32_t sector = ((FLASH_CR >> 3) & 15u) - 10u;
    if (FLASH_CR & FLASH_CR_STRT) {
        TEST_ASSERT_TRUE((FLASH_CR & FLASH_CR_SER) != 0 && sector < 2);
        erases++;
        status |= protects ? BIT(4) : 0;
        passed = 0;
        FLASH_CR &= ~FLASH_CR_STRT;
        memset(AREA + sector * (AREA_SIZE / 2), 0xFF, AREA_SIZE / 2);
        if (worn)
            AREA[sector * (AREA_SIZE / 2) + 77] = 0xFE;
    }
    shown = status;
    if (erases != 0 && passed / 2u < busy_ms) {
        unfed += passed != 0 && IWDG_KR != IWDG_KR_RELOAD;
        fed++;
        IWDG_KR = 0;
        passed++;
        SYST_CSR = passed % 2u ? SYST_CSR_COUNTFLAG : 0;
        PWR_CSR = dip_at_ms != 0 && passed / 2u == dip_at_ms ? PWR_CSR_PVDO : 0;
        shown |= FLASH_SR_BSY;
    }
    given = shown;
    return &shown;
}

volatile uint32_t core_registers[8];

void pins_freeze_watchdog(void) {}

static bool supply_low;

bool supply_is_low(void)
{
    return supply_low;
}

static void map(const volatile void *at, size_t size)
{
    void *page = (void *)((uintptr_t)at & ~(uintptr_t)(PAGE - 1u));
    TEST_ASSERT_EQUAL_PTR(page, mmap(page, size, PROT_READ | PROT_WRITE,
                                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0));
}

void setUp(void)
{
    static bool mapped;
    if (!mapped) {
        map(AREA, AREA_SIZE);
        map(&IWDG_KR, PAGE);
        map(&FLASH_CR, PAGE);
        map(&PWR_CSR, PAGE);
        mapped = true;
    }
    memset(AREA, 0xFF, AREA_SIZE);
    FLASH_CR = FLASH_CR_LOCK;
    status = 0;
    worn = supply_low = protects = false;
    plant = true;
    IWDG_SR = 0;
    busy_ms = dip_at_ms = passed = erases = fed = unfed = n_sent = held = 0;
}

void tearDown(void) {}

/* With a slow clock of so many kilohertz. */
static double milliseconds(uint32_t prescaler, uint32_t reload, uint32_t khz)
{
    return (double)reload * (double)(4u << prescaler) / khz;
}

static void test_every_time_out_is_the_nearest_the_registers_can_hold(void)
{
    for (uint32_t khz = 17; khz <= 60; khz++) {
        for (uint32_t ms = 0; ms < 17000; ms += 7) {
            struct watchdog_time t = watchdog_time(ms, khz);
            double got = milliseconds(t.prescaler, t.reload, khz),
                   step = (4u << t.prescaler) / (double)khz;
            TEST_ASSERT_TRUE(t.prescaler <= 6 && t.reload <= 4095);
            TEST_ASSERT_TRUE(got <= ms && got > ms - step - 1e-9);
        }
    }
    struct watchdog_time longest = watchdog_time(UINT32_MAX, LSI_PER_MS);
    TEST_ASSERT_EQUAL(6, longest.prescaler);
    TEST_ASSERT_UINT_WITHIN(1, 4095, longest.reload);
}

/* The counter stops at 0, a count after the reload has run down. */
static void test_a_clock_that_hangs_ends_in_a_reset_within_the_dead_mans_time(void)
{
    IWDG_KR = IWDG_PR = IWDG_RLR = 0;
    TEST_ASSERT_TRUE(hal_watchdog_start(PINS_MS));
    double slowest = milliseconds(IWDG_PR, IWDG_RLR + 1u, SLOWEST);
    printf("watchdog of a board with outputs where its clock is slowest: %.0f ms\n", slowest);
    TEST_ASSERT_TRUE(slowest + TURN_MS < DEAD_MAN_MS);
}

/* Half a time-out is the main loop's and the tick's own limit. */
static void test_no_time_out_is_shorter_than_what_main_loop_and_tick_may_take(void)
{
    TEST_ASSERT_TRUE(hal_watchdog_start(PINS_MS));
    TEST_ASSERT_TRUE(milliseconds(IWDG_PR, IWDG_RLR, FASTEST) > PINS_MS / 2.0);
    (void)hal_watchdog_change(USUAL_MS);
    TEST_ASSERT_TRUE(hal_watchdog_change(USUAL_MS));
    double usual = milliseconds(IWDG_PR, IWDG_RLR, FASTEST);
    printf("watchdog where its clock is fastest: %.0f ms\n", usual);
    TEST_ASSERT_TRUE(usual > USUAL_MS / 2.0);
}

/* The flash is busy for so many looks at its status; a millisecond passes at each second one. */
static void test_an_erase_feeds_the_watchdog_and_keeps_the_plant_link_alive(void)
{
    static const unsigned lasts_ms[] = {1, 999, 2000, 4500};
    TEST_ASSERT_TRUE(hal_watchdog_start(PINS_MS));
    uint32_t prescaler = IWDG_PR, reload = IWDG_RLR;
    for (unsigned i = 0; i < sizeof lasts_ms / sizeof lasts_ms[0]; i++) {
        AREA[AREA_SIZE / 2 - 1] = AREA[AREA_SIZE / 2] = AREA[AREA_SIZE - 1] = 0;
        erases = fed = unfed = n_sent = held = 0;
        busy_ms = lasts_ms[i];
        TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
        TEST_ASSERT_EQUAL(1, erases);
        TEST_ASSERT_EQUAL_HEX8(0, AREA[AREA_SIZE / 2 - 1]); /* the other sector */
        TEST_ASSERT_EQUAL(0, unfed);
        TEST_ASSERT_TRUE(fed >= lasts_ms[i]);
        unsigned frames = lasts_ms[i] < 250 ? 0 : 1 + (lasts_ms[i] - 250) / 500;
        TEST_ASSERT_EQUAL(frames > 5 ? 5 : frames, n_sent / APP_KEEP_ALIVE_BYTES);
        for (unsigned k = 0; k < n_sent; k++)
            TEST_ASSERT_EQUAL(k / APP_KEEP_ALIVE_BYTES * 16 + k % APP_KEEP_ALIVE_BYTES, sent[k]);
        TEST_ASSERT_EQUAL(0, held);
        TEST_ASSERT_EQUAL_HEX32(FLASH_CR_LOCK, FLASH_CR);
        TEST_ASSERT_EQUAL(prescaler, IWDG_PR);
        TEST_ASSERT_EQUAL(reload, IWDG_RLR);
    }
}

static void test_a_flash_that_stays_busy_is_given_up(void)
{
    busy_ms = 200000;
    TEST_ASSERT_EQUAL(ERR_TIMEOUT, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL(5 * APP_KEEP_ALIVE_BYTES, n_sent); /* then the plant goes safe */
}

static void test_without_a_plant_nothing_is_sent(void)
{
    plant = false;
    busy_ms = 2000;
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL(0, n_sent);
}

static void test_an_erase_with_a_dip_of_the_supply_counts_as_none(void)
{
    busy_ms = 1000;
    dip_at_ms = 400;
    TEST_ASSERT_EQUAL(ERR_STATE, hal_nvm_erase(1));
    dip_at_ms = 0;
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
}

static void test_an_erase_that_fails_is_told(void)
{
    worn = true;
    TEST_ASSERT_EQUAL(ERR_IO, hal_nvm_erase(0));
    worn = false;
    protects = true;
    TEST_ASSERT_EQUAL(ERR_IO, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL_HEX32(FLASH_CR_LOCK, FLASH_CR);
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_erase(2));
}

/* RM0090 3.9.5: an operation does not begin while an error of an earlier one is told. */
static void test_errors_of_earlier_operations_are_cleared_first(void)
{
    static const uint8_t data[4] = {1, 2, 3, 4};
    static const unsigned bits[] = {1, 4, 5, 6, 7};
    for (unsigned i = 0; i < sizeof bits / sizeof bits[0]; i++) {
        status = BIT(bits[i]);
        TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(4 * i, data, sizeof data));
        TEST_ASSERT_EQUAL_HEX32(0, status);
        status = BIT(bits[i]);
        TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
        TEST_ASSERT_EQUAL_HEX32(0, status);
    }
}

/* PM0214 4.4.3 and 4.3.6: what woke the core is not pending when it sleeps again. */
static void test_the_wait_for_an_erase_sleeps(void)
{
    SCB_ICSR = NVIC_ICPR(1) = 0;
    busy_ms = 3;
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL_HEX32(SCB_ICSR_PENDSTCLR | SCB_ICSR_PENDSVCLR, SCB_ICSR);
    TEST_ASSERT_EQUAL_HEX32(BIT(6), NVIC_ICPR(1));
}

/* RM0090 3.6.2: nothing is written to the interface while it is busy. */
static void test_a_flash_that_is_busy_is_left_alone(void)
{
    static const uint8_t data[4] = {1, 2, 3, 4};
    status = FLASH_SR_BSY;
    TEST_ASSERT_EQUAL(ERR_TIMEOUT, hal_nvm_program(0, data, sizeof data));
    TEST_ASSERT_EQUAL_HEX8(0xFF, AREA[0]);
    TEST_ASSERT_EQUAL(ERR_TIMEOUT, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL(0, erases);
}

/* RM0090 3.9.1: caches, prefetch and wait states are those of before, and no reset of a cache lasts. */
static void test_the_caches_are_left_as_they_were(void)
{
    static const uint8_t data[4] = {1, 2, 3, 4};
    uint8_t back[4];
    for (unsigned on = 0; on < 2; on++) {
        uint32_t acr = 5u | FLASH_ACR_PRFTEN | FLASH_ACR_ICEN | (on ? FLASH_ACR_DCEN : 0);
        FLASH_ACR = acr;
        TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(4 * on, data, sizeof data));
        TEST_ASSERT_EQUAL_HEX32(acr, FLASH_ACR);
        TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(0, back, sizeof back));
        TEST_ASSERT_EQUAL_HEX32(acr, FLASH_ACR);
        TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
        TEST_ASSERT_EQUAL_HEX32(acr, FLASH_ACR);
    }
}

static void test_programming_writes_whole_words_to_erased_ones_and_locks(void)
{
    static const uint8_t data[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(0x20000, data, sizeof data));
    TEST_ASSERT_EQUAL_MEMORY(data, AREA + 0x20000, sizeof data);
    TEST_ASSERT_EQUAL_HEX32(FLASH_CR_LOCK, FLASH_CR);
    TEST_ASSERT_EQUAL(ERR_IO, hal_nvm_program(0x20004, data, 4));
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_program(0x20009, data, 4));
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_program(0x20010, data, 6));
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_program(AREA_SIZE - 4, data, 8));
    /* Zeros go over anything; beside them the target must be erased as ever. */
    static const uint8_t zeros[8], half[8] = {0, 0, 0, 0, 5};
    TEST_ASSERT_EQUAL(ERR_IO, hal_nvm_program(0x20000, half, sizeof half));
    TEST_ASSERT_EQUAL_MEMORY(data, AREA + 0x20000, sizeof data);
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(0x20000, zeros, sizeof zeros));
    TEST_ASSERT_EQUAL_MEMORY(zeros, AREA + 0x20000, sizeof zeros);
    memcpy(AREA + 0x20000, data, sizeof data);
    uint8_t back[8];
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(0x20000, back, sizeof back));
    TEST_ASSERT_EQUAL_MEMORY(data, back, sizeof back);
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_read(AREA_SIZE, back, 1));
}

/* RM0090 Rev 21 3.6.2 and table 13: words need 2.7 V. */
static void test_with_a_low_supply_nothing_is_programmed_or_erased(void)
{
    static const uint8_t data[4] = {1, 2, 3, 4};
    AREA[0x20000] = 0;
    supply_low = true;
    TEST_ASSERT_EQUAL(ERR_STATE, hal_nvm_program(0, data, sizeof data));
    TEST_ASSERT_EQUAL_HEX8(0xFF, AREA[0]);
    TEST_ASSERT_EQUAL_HEX32(FLASH_CR_LOCK, FLASH_CR);
    TEST_ASSERT_EQUAL(ERR_STATE, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL_HEX8(0, AREA[0x20000]);
    TEST_ASSERT_EQUAL(0, erases);
    supply_low = false;
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(0, data, sizeof data));
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_time_out_is_the_nearest_the_registers_can_hold);
    RUN_TEST(test_a_clock_that_hangs_ends_in_a_reset_within_the_dead_mans_time);
    RUN_TEST(test_no_time_out_is_shorter_than_what_main_loop_and_tick_may_take);
    RUN_TEST(test_an_erase_feeds_the_watchdog_and_keeps_the_plant_link_alive);
    RUN_TEST(test_a_flash_that_stays_busy_is_given_up);
    RUN_TEST(test_without_a_plant_nothing_is_sent);
    RUN_TEST(test_an_erase_with_a_dip_of_the_supply_counts_as_none);
    RUN_TEST(test_an_erase_that_fails_is_told);
    RUN_TEST(test_errors_of_earlier_operations_are_cleared_first);
    RUN_TEST(test_the_wait_for_an_erase_sleeps);
    RUN_TEST(test_a_flash_that_is_busy_is_left_alone);
    RUN_TEST(test_the_caches_are_left_as_they_were);
    RUN_TEST(test_programming_writes_whole_words_to_erased_ones_and_locks);
    RUN_TEST(test_with_a_low_supply_nothing_is_programmed_or_erased);
    return UNITY_END();
}
