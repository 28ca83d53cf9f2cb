/* Actions of the ports of both chips before the firmware runs and when something fails, as register writes on a model: nothing
 * here has run on a chip. Built once for each; above each test stand the sections of the manuals it is from, RM0090 and PM0214
 * for the STM32F405, RM0041 for the STM32F100.
 */
#include "app/app.h"
#include "hal/nvm.h"
#include "hal/self_check.h"
#include "hal/tick.h"
#include "stm32_chip_bench.h"

/* Thousandths, over temperature (DS8626, DS5944: HSI oscillator characteristics). */
#define HSI_SLOW (F405 ? -80 : -24)
#define HSI_FAST (F405 ? 45 : 25)

/* pins.c of a release build: stm32_release_pins.c */
void release_pins_freeze_watchdog(void);

static uint32_t ram_failed_at, image_bytes;

uint64_t hal_clock_ms(void)
{
    return 1234;
}

/* ---- what the drivers call, and these tests do not look at ---- */

void hal_tick_request(void) {}
void uart_hold_interrupts(bool hold)
{
    (void)hold;
}

bool uart_serve_link(const uint8_t *more)
{
    (void)more;
    return false;
}

struct app *app_instance(void)
{
    return NULL;
}

size_t app_keep_alive(struct app *app, uint8_t *wire)
{
    (void)app;
    (void)wire;
    return 0;
}

uint32_t hal_ram_failed_at(void)
{
    return ram_failed_at;
}

uint32_t hal_image_bytes(void)
{
    return image_bytes;
}

void hal_tick_lock(void) {}
void hal_tick_unlock(void) {}

void setUp(void)
{
    usual_surroundings();
}

void tearDown(void) {}

/* ---- clocks ---- */

static bool from_crystal(void)
{
    return strncmp(hal_clock_source(), "HSE ", 4) == 0;
}

/* RM0090 7.2.2 and 7.3.2, RM0041 6.2.2, 6.3.2 and 6.3.12: each crystal of the list is taken, wherever in its range the internal
 * oscillator is, and the PLL is set so that the core gets its full speed. */
static void test_a_crystal_is_known_over_the_whole_range_of_the_internal_oscillator(void)
{
    static const uint32_t listed[] = {F405 ? 25000 : 4000, 8000, 12000, 16000, F405 ? 8000 : 24000};
    for (unsigned k = 0; k < 5; k++) {
        for (hsi_error = HSI_SLOW; hsi_error <= HSI_FAST; hsi_error++) {
            char expected[24];
            crystal_khz = listed[k];
            snprintf(expected, sizeof expected, "HSE %u MHz, PLL", (unsigned)crystal_khz / 1000u);
            start(RCC_CSR_PORRST);
            TEST_ASSERT_EQUAL_STRING(expected, hal_clock_source());
            TEST_ASSERT_EQUAL(PLL_HZ, hal_core_hz());
#if F405
            uint32_t pll = now(RCC_PLLCFGR);
            TEST_ASSERT_TRUE((pll & RCC_PLLCFGR_HSE) != 0);
            TEST_ASSERT_EQUAL(crystal_khz / 1000u, pll & 63u);
            TEST_ASSERT_EQUAL(336, pll >> 6 & 511u);
            TEST_ASSERT_EQUAL(0, pll >> 16 & 3u); /* halved */
#else
            uint32_t divided = (now(RCC_CFGR2) & 15u) + 1u;
            uint32_t times = (now(RCC_CFGR) >> 18 & 15u) + 2u;
            TEST_ASSERT_TRUE((now(RCC_CFGR) & RCC_CFGR_PLLSRC) != 0);
            TEST_ASSERT_EQUAL(PLL_HZ / 1000u, crystal_khz / divided * times);
            TEST_ASSERT_EQUAL(0, now(RCC_BDCR));
            TEST_ASSERT_EQUAL(0, now(PWR_CR) & PWR_CR_DBP);
#endif
        }
    }
}

static void test_a_crystal_that_fits_none_of_the_list_is_not_used(void)
{
    static const uint32_t others[] = {3000, 5000, 6000, 10000, 14000, 20000, 32000};
    for (unsigned k = 0; k < sizeof others / sizeof others[0]; k++) {
        crystal_khz = others[k];
        start(RCC_CSR_PORRST);
        TEST_ASSERT_FALSE_MESSAGE(from_crystal(), hal_clock_source());
        TEST_ASSERT_EQUAL(PLL_HZ, hal_core_hz());
        TEST_ASSERT_EQUAL(0, now(RCC_CR) & (RCC_CR_HSEON | RCC_CR_CSSON));
    }
}

static void test_without_a_crystal_or_a_pll_the_board_runs_from_what_is_left(void)
{
    crystal_khz = 0;
    start(RCC_CSR_PORRST);
    TEST_ASSERT_FALSE(from_crystal());
    TEST_ASSERT_EQUAL(PLL_HZ, hal_core_hz());
    pll_locks = false;
    start(RCC_CSR_PORRST);
    TEST_ASSERT_EQUAL(HSI_HZ, hal_core_hz());
    TEST_ASSERT_EQUAL(HSI_HZ, clock_apb1_hz());
    TEST_ASSERT_EQUAL(HSI_HZ, clock_apb2_hz());
    crystal_khz = 8000;
    start(RCC_CSR_PORRST);
    TEST_ASSERT_EQUAL(HSI_HZ, hal_core_hz());
}

#if F405
/* RM0090 3.5.1, ES0182: five wait states at 168 MHz, in force before the core gets it. */
static void test_wait_states_come_before_the_speed(void)
{
    start(RCC_CSR_PORRST);
    unsigned waits = first_write(FLASH_ACR, 7u, 5u);
    unsigned speed = first_write(RCC_CFGR, 3u, RCC_CFGR_SW_PLL);
    TEST_ASSERT_TRUE(waits < speed && speed < WRITES);
    TEST_ASSERT_TRUE(first_write(PWR_CR, PWR_CR_VOS, PWR_CR_VOS) < speed);
}

/* RM0090 3.9.1 and 38.6.1, ES0182: revision A has no prefetch; its device number reads as that of an STM32F2. */
static void test_prefetch_is_off_on_early_silicon(void)
{
    static const struct {
        uint32_t id;
        bool prefetch;
    } chips[] = {{0x10006413u, false}, {0x20006411u, false}, {0x10016413u, true},
                 {0x10036413u, true},  {0x10076413u, true},  {0x100F6413u, true}};
    for (unsigned k = 0; k < sizeof chips / sizeof chips[0]; k++) {
        start(RCC_CSR_PORRST);
        becomes(DBGMCU_IDCODE, chips[k].id);
        forget_writes();
        start_clock_tree();
        TEST_ASSERT_EQUAL(FLASH_ACR_ICEN | FLASH_ACR_DCEN |
                              (chips[k].prefetch ? FLASH_ACR_PRFTEN : 0),
                          now(FLASH_ACR) & ~7u);
        if (!chips[k].prefetch)
            TEST_ASSERT_EQUAL(WRITES, first_write(FLASH_ACR, FLASH_ACR_PRFTEN, FLASH_ACR_PRFTEN));
    }
}
#else
/* RM0041 6.2.8: with the real-time clock standing still the crystal's speed is not known. */
static void test_a_crystal_that_cannot_be_measured_is_not_used(void)
{
    rtc_runs = false;
    start(RCC_CSR_PORRST);
    TEST_ASSERT_EQUAL_STRING("HSI 8 MHz, PLL", hal_clock_source());
}
#endif

/* The NMI comes; returns once the firmware has asked for a reset. */
static void nmi(bool crystal)
{
    stm32_ipsr = 2;
    becomes(RCC_CIR, crystal ? RCC_CIR_CSSF : 0);
    if (setjmp(board_reset) == 0)
        identity_fault(stack_bottom, 0xFFFFFFF9u);
}

/* RM0090 7.2.7, 7.3.1 and 7.3.4, RM0041 6.2.7, 6.3.1 and 6.3.3: a crystal that fails raises the NMI. The board starts anew, from
 * the internal oscillator and with everything reckoned from it, and says so; until the next power-on, which tries it again. */
static void test_a_crystal_that_fails_is_not_used_until_the_next_power_on(void)
{
    struct hal_fault fault;
    start(RCC_CSR_PORRST | RCC_CSR_PINRST);
    TEST_ASSERT_TRUE(from_crystal());
    unsigned watched = first_write(RCC_CR, RCC_CR_CSSON, RCC_CR_CSSON);
    TEST_ASSERT_TRUE(watched < WRITES);
    TEST_ASSERT_TRUE(watched > first_write(RCC_CFGR, 3u, RCC_CFGR_SW_PLL));
    nmi(true);
    TEST_ASSERT_TRUE((now(RCC_CIR) & RCC_CIR_CSSC) != 0);
    start(RCC_CSR_SFTRST | RCC_CSR_PINRST);
    TEST_ASSERT_EQUAL(HAL_RESET_CRYSTAL, hal_reset_cause());
    TEST_ASSERT_NOT_NULL(strstr(hal_clock_source(), "PLL: the crystal has failed"));
    TEST_ASSERT_EQUAL(WRITES, first_write(RCC_CR, RCC_CR_HSEON, RCC_CR_HSEON));
    TEST_ASSERT_EQUAL(PLL_HZ, hal_core_hz());
    TEST_ASSERT_FALSE(hal_last_fault(&fault)); /* it is none of the firmware's */
    start(RCC_CSR_IWDGRST | RCC_CSR_PINRST);
    TEST_ASSERT_EQUAL(HAL_RESET_WATCHDOG, hal_reset_cause());
    TEST_ASSERT_FALSE(from_crystal());
    start(RCC_CSR_PORRST | RCC_CSR_PINRST);
    TEST_ASSERT_TRUE(from_crystal());
    start(RCC_CSR_PINRST);
    TEST_ASSERT_TRUE(from_crystal());
}

static void test_an_nmi_for_another_reason_is_a_fault(void)
{
    struct hal_fault fault;
    start(RCC_CSR_PORRST);
    nmi(false);
    start(RCC_CSR_SFTRST | RCC_CSR_PINRST);
    TEST_ASSERT_EQUAL(HAL_RESET_FAULT, hal_reset_cause());
    TEST_ASSERT_TRUE(hal_last_fault(&fault));
    TEST_ASSERT_EQUAL(2, fault.exception);
    TEST_ASSERT_TRUE(from_crystal());
}

/* ---- supply ---- */

/* RM0090 5.2.3, 5.4.1 and 5.4.2, RM0041 4.2.2, 4.4.1 and 4.4.2: the detector runs before the firmware can write the flash, at a
 * level at which writes are good; nothing else of the register changes. */
static void test_the_voltage_detector_is_on_and_forbids_flash_writes(void)
{
    start(RCC_CSR_PORRST);
    TEST_ASSERT_TRUE((now(RCC_APB1ENR) & BIT(28)) != 0);
    TEST_ASSERT_EQUAL_HEX32(PWR_CR_PVDE | (F405 ? 6u << 5 | BIT(14) : 2u << 5), now(PWR_CR));
    TEST_ASSERT_FALSE(supply_is_low());
    supply_low = true;
    forget_writes();
    TEST_ASSERT_TRUE(supply_is_low());
    TEST_ASSERT_NOT_NULL(strstr(hal_supply_text(), "TOO LOW"));
    TEST_ASSERT_EQUAL(ERR_STATE, hal_nvm_erase(0));
    TEST_ASSERT_EQUAL(WRITES, first_write(FLASH_CR, BIT(F405 ? 16 : 6), BIT(F405 ? 16 : 6)));
#if !F405 /* the other's: test_stm32_flash.c */
    static const uint8_t word[4] = {1, 2, 3, 4};
    TEST_ASSERT_EQUAL(ERR_STATE, hal_nvm_program(0, word, sizeof word));
    TEST_ASSERT_EQUAL_HEX16(0xFFFF, now(0x0801E000u) & 0xFFFFu);
    supply_low = false;
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(0, word, sizeof word));
    TEST_ASSERT_EQUAL_HEX16(0x0201, now(0x0801E000u) & 0xFFFFu);
#endif
}

#if F405
/* RM0090 5.2.2 and 3.9.10 */
static void test_the_level_of_the_brown_out_reset_is_told(void)
{
    static const char *const told[] = {"brown-out reset level 3", "only level 2", "only level 1",
                                       "brown-out reset OFF"};
    for (uint32_t level = 0; level < 4; level++) {
        start(RCC_CSR_PORRST);
        becomes(FLASH_OPTCR, 0x0FFFAAE1u | level << 2);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(hal_supply_text(), told[level]), told[level]);
        TEST_ASSERT_EQUAL(level == 3, hal_brown_out_off());
    }
}

/* RM0090 Rev 21 3.7 and 3.9.9: bit 5 is 0 with the hardware watchdog; bits 16 to 27 are 0 in a sector that is write-protected. */
static void test_the_watchdog_option_and_the_write_protection_of_the_program_are_told(void)
{
    static const struct {
        uint32_t bytes, open;
        const char *told;
    } cases[] = {
        {500000, 0xFFF, "program NOT write-protected"},
        {500000, 0xF80, "program write-protected in part"},
        {500000, 0xF00, "program write-protected"},
        {393216, 0xF80, "program write-protected"},
        {393217, 0xF80, "program write-protected in part"},
        {65536, 0xFF0, "program write-protected"},
        {786432, 0xC00, "program write-protected"},
        {786432, 0xE00, "program write-protected in part"},
    };
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        start(RCC_CSR_PORRST);
        image_bytes = cases[i].bytes;
        becomes(FLASH_OPTCR, 0xAAEDu | cases[i].open << 16);
        TEST_ASSERT_EQUAL_STRING(cases[i].told, hal_protection_text(HAL_PROTECTION_PROGRAM));
        TEST_ASSERT_EQUAL_STRING("watchdog only from start-up on",
                                 hal_protection_text(HAL_PROTECTION_WATCHDOG));
        becomes(FLASH_OPTCR, 0xAACDu | cases[i].open << 16);
        TEST_ASSERT_EQUAL_STRING("watchdog from reset on",
                                 hal_protection_text(HAL_PROTECTION_WATCHDOG));
    }
}

/* RM0090 7.3.21: the flag of the power-on, by which the next start knows that it must test. */
static void test_the_flag_of_the_power_on_stays_while_the_ram_is_bad(void)
{
    ram_failed_at = 0x20001000u;
    start(RCC_CSR_PORRST);
    TEST_ASSERT_EQUAL(WRITES, first_write(RCC_CSR, RCC_CSR_RMVF, RCC_CSR_RMVF));
    ram_failed_at = 0;
    start(RCC_CSR_PORRST);
    TEST_ASSERT_NOT_EQUAL(WRITES, first_write(RCC_CSR, RCC_CSR_RMVF, RCC_CSR_RMVF));
}
#endif

/* ---- core ---- */

/* PM0214 4.2: one region over the alias of the flash at 0, without access; all else as before. The STM32F100 has no such unit:
 * MPU_TYPE reads 0. */
static void test_address_zero_is_guarded_where_there_is_a_protection_unit(void)
{
    start(RCC_CSR_PORRST);
    forget_writes();
    guard_start();
    note_writes();
    TEST_ASSERT_EQUAL(0, n_writes);
    becomes(MPU_TYPE, 8u << 8);
    guard_start();
    TEST_ASSERT_EQUAL_HEX32(0, now(MPU_RNR));
    TEST_ASSERT_EQUAL_HEX32(0, now(MPU_RBAR));
    TEST_ASSERT_EQUAL_HEX32(0x10000027u, now(MPU_RASR)); /* XN, no access, 2^20 bytes, on */
    TEST_ASSERT_EQUAL_HEX32(5u, now(MPU_CTRL));          /* on, the rest by the default map */
    TEST_ASSERT_EQUAL(n_writes - 1u, first_write(MPU_CTRL, 1u, 1u));
}

/* RM0090 38.16.4, RM0041 25.15.3: the bit outlives a reset, so a release build takes it away. */
static void test_the_debugger_stops_the_watchdog_in_debug_builds_only(void)
{
#if F405
    uint32_t at = DBGMCU_APB1_FZ, bit = BIT(12);
#else
    uint32_t at = DBGMCU_CR, bit = BIT(8);
#endif
    start(RCC_CSR_PORRST);
    pins_freeze_watchdog();
    TEST_ASSERT_EQUAL_HEX32(bit, now(at));
    becomes(at, bit | 7u);
    release_pins_freeze_watchdog();
    TEST_ASSERT_EQUAL_HEX32(7u, now(at));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_crystal_is_known_over_the_whole_range_of_the_internal_oscillator);
    RUN_TEST(test_a_crystal_that_fits_none_of_the_list_is_not_used);
    RUN_TEST(test_without_a_crystal_or_a_pll_the_board_runs_from_what_is_left);
#if F405
    RUN_TEST(test_wait_states_come_before_the_speed);
    RUN_TEST(test_prefetch_is_off_on_early_silicon);
    RUN_TEST(test_the_level_of_the_brown_out_reset_is_told);
    RUN_TEST(test_the_watchdog_option_and_the_write_protection_of_the_program_are_told);
    RUN_TEST(test_the_flag_of_the_power_on_stays_while_the_ram_is_bad);
#else
    RUN_TEST(test_a_crystal_that_cannot_be_measured_is_not_used);
#endif
    RUN_TEST(test_a_crystal_that_fails_is_not_used_until_the_next_power_on);
    RUN_TEST(test_an_nmi_for_another_reason_is_a_fault);
    RUN_TEST(test_the_voltage_detector_is_on_and_forbids_flash_writes);
    RUN_TEST(test_address_zero_is_guarded_where_there_is_a_protection_unit);
    RUN_TEST(test_the_debugger_stops_the_watchdog_in_debug_builds_only);
    return UNITY_END();
}
