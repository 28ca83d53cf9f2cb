/* The STM32F405's flash and watchdog drivers on plain memory that lies where their registers are: an erase, in which
 * nobody can feed the watchdog, has a time-out of its own. What the flash itself does is not modelled. */
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

#include "board.h"
#include "hal/nvm.h"
#include "hal/tick.h"
#include "hal/watchdog.h"
#include "registers.h"
#include "unity.h"

#define AREA      ((uint8_t *)0x080C0000u)
#define AREA_SIZE 0x40000u
#define PAGE      0x1000u

#define USUAL_MS 2000u /* WATCHDOG_MS in firmware/app/app.c */
#define ERASE_X8_MS                                                                                \
    4000u /* longest erase of 128 KiB, one byte at a time (DS8626); by words, as here, 2000 */

/* Registers at the time when the watchdog got another time-out, and when the flash erased. */
static struct seen {
    uint32_t key, prescaler, reload, flash;
} changes[8], erasing;
static unsigned n_changes, locks, erases;
static bool worn; /* an erase leaves a bit */
static uint32_t status;

void hal_tick_lock(void)
{
    locks++;
}

void hal_tick_unlock(void)
{
    TEST_ASSERT_EQUAL(n_changes + 1, locks);
    TEST_ASSERT_TRUE(n_changes < sizeof changes / sizeof changes[0]);
    changes[n_changes++] = (struct seen){IWDG_KR, IWDG_PR, IWDG_RLR, FLASH_CR};
}

/* Writing ones clears them: what is written is lost. Whoever asks after a start finds the erase done. */
volatile uint32_t *flash_status(void)
{
    static uint32_t shown;
    uint32_t sector = ((FLASH_CR >> 3) & 15u) - 10u;
    if (FLASH_CR & FLASH_CR_STRT) {
        TEST_ASSERT_TRUE((FLASH_CR & FLASH_CR_SER) != 0 && sector < 2);
        erasing = (struct seen){IWDG_KR, IWDG_PR, IWDG_RLR, FLASH_CR};
        erases++;
        FLASH_CR &= ~FLASH_CR_STRT;
        memset(AREA + sector * (AREA_SIZE / 2), 0xFF, AREA_SIZE / 2);
        if (worn)
            AREA[sector * (AREA_SIZE / 2) + 77] = 0xFE;
    }
    shown = status;
    return &shown;
}

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
        mapped = true;
    }
    memset(AREA, 0xFF, AREA_SIZE);
    FLASH_CR = FLASH_CR_LOCK;
    status = 0;
    worn = supply_low = false;
    IWDG_SR = 0;
    n_changes = locks = erases = 0;
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

static void test_an_erase_has_a_longer_time_out_and_leaves_the_usual_one(void)
{
    TEST_ASSERT_TRUE(hal_watchdog_start(USUAL_MS));
    AREA[AREA_SIZE / 2 - 1] = AREA[AREA_SIZE / 2] = AREA[AREA_SIZE - 1] = 0;
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL(1, erases);
    TEST_ASSERT_EQUAL_HEX8(0, AREA[AREA_SIZE / 2 - 1]); /* the other sector */
    TEST_ASSERT_EQUAL(3, n_changes);
    for (unsigned i = 0; i < 3; i++)
        TEST_ASSERT_EQUAL_HEX32(IWDG_KR_ACCESS, changes[i].key);
    double usual = milliseconds(changes[0].prescaler, changes[0].reload, 47);
    double erase = milliseconds(erasing.prescaler, erasing.reload, 47);
    printf("watchdog where its clock is fastest: %.0f ms, in an erase %.0f ms\n", usual, erase);
    TEST_ASSERT_EQUAL_HEX32(IWDG_KR_RELOAD, erasing.key); /* fed just before */
    TEST_ASSERT_TRUE(usual > 1000); /* the main loop's and the tick's own limit */
    TEST_ASSERT_TRUE(erase > ERASE_X8_MS);
    TEST_ASSERT_EQUAL_HEX32(FLASH_CR_LOCK, changes[2].flash);
    TEST_ASSERT_EQUAL(changes[0].prescaler, IWDG_PR);
    TEST_ASSERT_EQUAL(changes[0].reload, IWDG_RLR);
    TEST_ASSERT_EQUAL_HEX32(IWDG_KR_RELOAD, IWDG_KR);
}

static void test_an_erase_that_fails_leaves_the_usual_time_out(void)
{
    TEST_ASSERT_TRUE(hal_watchdog_start(USUAL_MS));
    worn = true;
    TEST_ASSERT_EQUAL(ERR_IO, hal_nvm_erase(0));
    worn = false;
    status = BIT(4); /* protected */
    TEST_ASSERT_EQUAL(ERR_IO, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL(5, n_changes);
    TEST_ASSERT_EQUAL(changes[0].prescaler, IWDG_PR);
    TEST_ASSERT_EQUAL(changes[0].reload, IWDG_RLR);
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_erase(2));
    TEST_ASSERT_EQUAL(5, n_changes);
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

/* RM0090 3.6.2 and table 7: words need 2.7 V. */
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
    RUN_TEST(test_an_erase_has_a_longer_time_out_and_leaves_the_usual_one);
    RUN_TEST(test_an_erase_that_fails_leaves_the_usual_time_out);
    RUN_TEST(test_programming_writes_whole_words_to_erased_ones_and_locks);
    RUN_TEST(test_with_a_low_supply_nothing_is_programmed_or_erased);
    return UNITY_END();
}
