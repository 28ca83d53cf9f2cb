/* What the models of the STM32F100 stand for, asked of them register by register: no code runs. Sections are those of the reference manual. */
#include "board_registers.h"

#define PLLXTPRE BIT(17) /* 6.3.2 */

static void new_board(uint32_t crystal_hz)
{
    const struct surroundings around = usual(&chip_stm32f100, crystal_hz);
    start_board(&chip_stm32f100, &around, empty_image, sizeof empty_image);
}

void setUp(void)
{
    new_board(8000000);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

/* ---- RM0041 6: clocks ---- */

static void test_a_crystal_is_ready_after_its_start_and_without_one_never(void)
{
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_HSEON);
    pass(1000000);
    TEST_ASSERT_EQUAL(0, get(RCC_CR) & RCC_CR_HSERDY);
    pass(1500000);
    TEST_ASSERT_NOT_EQUAL(0, get(RCC_CR) & RCC_CR_HSERDY);
    new_board(0);
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_HSEON);
    pass(100000000);
    TEST_ASSERT_EQUAL(0, get(RCC_CR) & RCC_CR_HSERDY);
}

static void crystal_on(void)
{
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_HSEON);
    pass(3000000);
}

/* Six times a half of the crystal, or of the internal oscillator. */
static void pll_on(uint32_t source)
{
    put_ok(RCC_CFGR,
           source | RCC_CFGR_PLLMUL(source != 0 && b->around.crystal_hz == 8000000 ? 3 : 6));
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_PLLON);
    pass(1000000);
    TEST_ASSERT_NOT_EQUAL(0, get(RCC_CR) & RCC_CR_PLLRDY);
    put_ok(RCC_CFGR, get(RCC_CFGR) | RCC_CFGR_SW_PLL);
}

static void test_the_pll_runs_from_either_oscillator_and_the_core_from_it(void)
{
    TEST_ASSERT_EQUAL(8000000, b->core_hz);
    pll_on(0);
    TEST_ASSERT_EQUAL(RCC_CFGR_SWS_PLL, get(RCC_CFGR) & RCC_CFGR_SWS);
    TEST_ASSERT_EQUAL(24000000, b->core_hz);
    new_board(8000000);
    crystal_on();
    pll_on(RCC_CFGR_PLLSRC);
    TEST_ASSERT_EQUAL(24000000, b->core_hz);
    TEST_ASSERT_EQUAL(24000000, bus_clock_hz(b, "apb1"));
}

/* 6.2.6, 6.3.1 */
static void test_a_switch_waits_for_its_clock_and_what_is_used_stays_on(void)
{
    put_ok(RCC_CFGR, RCC_CFGR_PLLMUL(6) | RCC_CFGR_SW_PLL);
    TEST_ASSERT_EQUAL(RCC_CFGR_SW_PLL, get(RCC_CFGR) & 15u);
    TEST_ASSERT_EQUAL(8000000, b->core_hz);
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_PLLON);
    put_ok(RCC_CR, get(RCC_CR) & ~RCC_CR_PLLON); /* it is asked for */
    pass(1000000);
    TEST_ASSERT_EQUAL(RCC_CFGR_SW_PLL | RCC_CFGR_SWS_PLL, get(RCC_CFGR) & 15u);
    TEST_ASSERT_EQUAL(24000000, b->core_hz);
    put_ok(RCC_CR, get(RCC_CR) & ~1u); /* HSION: the PLL is fed with it */
    TEST_ASSERT_EQUAL(3, get(RCC_CR) & 3u);
    put(RCC_CFGR, get(RCC_CFGR) | 3u);
    expect_verdict("switches to clock 3");
}

/* 6.3.2 and 6.3.11 */
static void test_the_lowest_bit_of_the_divider_is_in_two_registers(void)
{
    put_ok(RCC_CFGR2, 5);
    TEST_ASSERT_EQUAL(PLLXTPRE, get(RCC_CFGR));
    put_ok(RCC_CFGR, 0);
    TEST_ASSERT_EQUAL(4, get(RCC_CFGR2));
    put_ok(RCC_CFGR, PLLXTPRE);
    TEST_ASSERT_EQUAL(5, get(RCC_CFGR2));
}

static void test_a_pll_that_is_too_fast_or_changed_while_on_is_refused(void)
{
    put_ok(RCC_CFGR, RCC_CFGR_PLLMUL(12));
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_PLLON);
    pass(1000000);
    expect_verdict("gives 48000000 Hz");
    put(RCC_CFGR, RCC_CFGR_PLLMUL(6));
    expect_verdict("while the PLL is on");
    put(RCC_CFGR2, 1);
    expect_verdict("write of RCC_CFGR2 while the PLL is on");
}

static void test_a_failing_crystal_raises_the_nmi_or_stops_the_core(void)
{
    crystal_on();
    pll_on(RCC_CFGR_PLLSRC);
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_CSSON);
    b->around.crystal_hz = 0;
    crystal_changed(b);
    TEST_ASSERT_EQUAL(8000000, b->core_hz);
    TEST_ASSERT_EQUAL(0, get(RCC_CR) & (RCC_CR_HSEON | RCC_CR_HSERDY | RCC_CR_PLLON));
    TEST_ASSERT_NOT_EQUAL(0, get(RCC_CIR) & RCC_CIR_CSSF);
    TEST_ASSERT_EQUAL(0, b->stalled_until_ns);
    put_ok(RCC_CIR, RCC_CIR_CSSC);
    TEST_ASSERT_EQUAL(0, get(RCC_CIR));

    new_board(8000000);
    crystal_on();
    put_ok(RCC_CFGR, 1);
    put_ok(RCC_CR, (get(RCC_CR) & ~1u) | RCC_CR_CSSON);
    b->around.crystal_hz = 0;
    crystal_changed(b);
    TEST_ASSERT_EQUAL(3, get(RCC_CR) & 3u); /* 6.3.1: the internal oscillator comes on again */
    TEST_ASSERT_EQUAL(8000000, b->core_hz);

    new_board(8000000);
    crystal_on();
    b->around.crystal_hz = 0;
    crystal_changed(b); /* the core runs from its own oscillator */
    TEST_ASSERT_EQUAL(0, b->stalled_until_ns);
    new_board(8000000);
    crystal_on();
    pll_on(RCC_CFGR_PLLSRC);
    b->around.crystal_hz = 0;
    crystal_changed(b);
    TEST_ASSERT_TRUE(b->stalled_until_ns > UINT64_C(1000000000000));
}

/* 6.3.10: flags add up until they are cleared; only a power-on clears the others. */
static void test_reset_flags(void)
{
    const uint32_t all = 0xFC000000u;
    TEST_ASSERT_EQUAL(RCC_CSR_PORRST | RCC_CSR_PINRST, get(RCC_CSR) & all);
    put_ok(RCC_CSR, RCC_CSR_RMVF);
    TEST_ASSERT_EQUAL(0, get(RCC_CSR) & all);
    restart(RESET_SOFTWARE);
    TEST_ASSERT_EQUAL(RCC_CSR_SFTRST | RCC_CSR_PINRST, get(RCC_CSR) & all);
    restart(RESET_WATCHDOG);
    TEST_ASSERT_EQUAL(RCC_CSR_IWDGRST | RCC_CSR_SFTRST | RCC_CSR_PINRST, get(RCC_CSR) & all);
    board_power_on(b);
    TEST_ASSERT_EQUAL(RCC_CSR_PORRST | RCC_CSR_PINRST, get(RCC_CSR) & all);
}

/* ---- bus ---- */

static void test_a_part_without_its_clock_and_a_reserved_bit_are_refused(void)
{
    (void)get(GPIOA_CRL);
    expect_verdict("read of GPIOA_CRL (0x40010800) while its clock is off");
    put(RCC_CFGR2, 0x10);
    expect_verdict("reserved bits 0x00000010");
    (void)get(0x40021030u);
    expect_verdict("RCC has no register there");
    (void)get(0xE000ED88u); /* CPACR */
    expect_verdict("floating-point unit");
    TEST_ASSERT_EQUAL(0, get(0xE000ED90u)); /* MPU_TYPE */
    TEST_ASSERT_EQUAL_HEX32(0x411FC231u, get(0xE000ED00u));
    put(NVIC_ISER(1), BIT(23)); /* RM0041 8.1: 56 interrupts */
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
    put(NVIC_ISER(1), BIT(24));
    expect_verdict("has no interrupt 56");
}

/* ---- RM0041 7.2: pins ---- */

static void test_pins_are_inputs_until_they_are_set(void)
{
    put_ok(RCC_APB2ENR, RCC_APB2ENR_IOPA);
    TEST_ASSERT_EQUAL_HEX32(0x44444444u, get(GPIOA_CRL));
    TEST_ASSERT_EQUAL(PIN_INPUT, pin_function(b, 'A', 3));
    put_ok(GPIOA_CRL,
           0x444403A4u); /* 0 and 4 on: floating; 1: alternate output; 2: output; 3: analog */
    TEST_ASSERT_EQUAL(PIN_INPUT, pin_function(b, 'A', 0));
    TEST_ASSERT_EQUAL(0, pin_function(b, 'A', 1));
    TEST_ASSERT_EQUAL(PIN_NO_FUNCTION, pin_function(b, 'A', 2));
    TEST_ASSERT_EQUAL(PIN_NO_FUNCTION, pin_function(b, 'A', 3));
    put_ok(GPIOA_BSRR, BIT(2) | BIT(5) | BIT(2 + 16)); /* to set goes first */
    TEST_ASSERT_EQUAL_HEX32(BIT(2) | BIT(5), get(GPIOA_CRL + 0xCu));
    TEST_ASSERT_EQUAL_HEX32(BIT(2), get(GPIOA_CRL + 0x8u)); /* 5 is a floating input */
    put_ok(GPIOA_CRL + 0x14u, BIT(5));
    TEST_ASSERT_EQUAL_HEX32(BIT(2), get(GPIOA_CRL + 0xCu));
    (void)bus_read(b, GPIOA_CRL, 1);
    expect_verdict("which takes no such width");
}

/* ---- RM0041 4 and 17: backup domain, real-time clock ---- */

static void open_backup(void)
{
    put_ok(RCC_APB1ENR, RCC_APB1ENR_PWR | RCC_APB1ENR_BKP);
    put_ok(PWR_CR, PWR_CR_DBP);
}

static void test_the_backup_domain_is_closed_until_it_is_opened(void)
{
    put(RCC_BDCR, RCC_BDCR_RTCEN);
    expect_verdict("write of RCC_BDCR while PWR_CR_DBP is off");
    new_board(8000000);
    open_backup();
    put_ok(RCC_BDCR, RCC_BDCR_HSE_RTC | RCC_BDCR_RTCEN);
    restart(RESET_SOFTWARE);
    TEST_ASSERT_EQUAL(RCC_BDCR_HSE_RTC | RCC_BDCR_RTCEN, get(RCC_BDCR));
    open_backup();
    put(RCC_BDCR, (2u << 8) | RCC_BDCR_RTCEN);
    expect_verdict("another clock for the RTC");
    put_ok(RCC_BDCR, RCC_BDCR_BDRST | RCC_BDCR_RTCEN);
    TEST_ASSERT_EQUAL(RCC_BDCR_BDRST, get(RCC_BDCR));
    put_ok(RCC_BDCR, 0);
    put_ok(RCC_BDCR, (2u << 8) | RCC_BDCR_RTCEN);
    board_power_on(b);
    TEST_ASSERT_EQUAL(0, get(RCC_BDCR));
}

static void test_the_clock_counts_the_crystals_128th_down(void)
{
    crystal_on();
    open_backup();
    put_ok(RCC_BDCR, RCC_BDCR_HSE_RTC | RCC_BDCR_RTCEN);
    (void)bus_read(b, RTC_DIVL, 2);
    expect_verdict("before RTC_CRL_RSF is set");
    bus_write(b, RTC_CRL, 2, 0);
    TEST_ASSERT_EQUAL(0, bus_read(b, RTC_CRL, 2) & RTC_CRL_RSF);
    pass(16100); /* a period is 16 us */
    TEST_ASSERT_NOT_EQUAL(0, bus_read(b, RTC_CRL, 2) & RTC_CRL_RSF);
    uint32_t from = bus_read(b, RTC_DIVL, 2);
    pass(64 * 16000);
    TEST_ASSERT_EQUAL(64, from - bus_read(b, RTC_DIVL, 2));
    b->around.crystal_hz = 0; /* and stands still with it */
    crystal_changed(b);
    from = bus_read(b, RTC_DIVL, 2);
    pass(1000000);
    TEST_ASSERT_EQUAL(from, bus_read(b, RTC_DIVL, 2));
    put(PWR_CR, 0);
    expect_verdict("PWR_CR_DBP cleared while the crystal's 128th is the clock of the RTC");
    bus_write(b, RTC_CRL, 2, 0);
    expect_verdict("write of the RTC while PWR_CR_DBP is off");
}

/* ---- RM0041 4.4.1: supply; 25.15: debug ---- */

static void test_the_voltage_detector(void)
{
    put_ok(RCC_APB1ENR, RCC_APB1ENR_PWR);
    put_ok(PWR_CR, PWR_CR_PVDE | PWR_CR_PLS_CHOSEN);
    TEST_ASSERT_EQUAL(0, get(PWR_CSR));
    b->around.supply_mv = 2300; /* between its two thresholds it stays as it was */
    TEST_ASSERT_EQUAL(0, get(PWR_CSR));
    b->around.supply_mv = 2200;
    TEST_ASSERT_EQUAL(PWR_CSR_PVDO, get(PWR_CSR));
    b->around.supply_mv = 2300;
    TEST_ASSERT_EQUAL(PWR_CSR_PVDO, get(PWR_CSR));
    put_ok(PWR_CR, PWR_CR_PLS_CHOSEN);
    TEST_ASSERT_EQUAL(0, get(PWR_CSR));
}

static void test_a_reset_leaves_the_debug_settings_alone(void)
{
    put_ok(DBGMCU_CR, DBGMCU_CR_IWDG_STOP);
    restart(RESET_PIN);
    TEST_ASSERT_EQUAL(DBGMCU_CR_IWDG_STOP, get(DBGMCU_CR));
    board_power_on(b);
    TEST_ASSERT_EQUAL(0, get(DBGMCU_CR));
}

/* ---- PM0063: flash ---- */

#define PLACE  0x500u /* in the second page of what is stored */
#define STORED 0x0801E000u

static void unlock(void)
{
    put_ok(FLASH_KEYR, FLASH_KEY1);
    put_ok(FLASH_KEYR, FLASH_KEY2);
    TEST_ASSERT_EQUAL(0, get(FLASH_CR) & FLASH_CR_LOCK);
}

static void program(uint32_t at, uint32_t half)
{
    put_ok(FLASH_CR, FLASH_CR_PG);
    b->chip->store(b, at, 2, half);
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
    pass(100000);
}

static void test_a_half_word_takes_its_time_and_the_core_stands_still(void)
{
    unlock();
    put_ok(FLASH_CR, FLASH_CR_PG);
    uint64_t from = board_ns(b);
    b->chip->store(b, PLACE, 2, 0x1234);
    TEST_ASSERT_EQUAL(FLASH_SR_BSY, get(FLASH_SR));
    TEST_ASSERT_EQUAL(from + 52500, b->stalled_until_ns);
    b->chip->store(b, PLACE + 2, 2, 0x1234);
    expect_verdict("while it is busy");
    pass(52500);
    TEST_ASSERT_EQUAL(FLASH_SR_EOP, get(FLASH_SR));
    put_ok(FLASH_SR, FLASH_SR_EOP);
    TEST_ASSERT_EQUAL(0, get(FLASH_SR));
    TEST_ASSERT_EQUAL_HEX32(0x1234, stored_flash_read(b, PLACE, 2));
}

static void test_a_half_word_that_is_not_erased_takes_only_zero(void)
{
    unlock();
    program(PLACE, 0xFFFE);
    program(PLACE, 0x7FFE);                            /* fewer ones, but not zero */
    TEST_ASSERT_EQUAL(BIT(2), get(FLASH_SR) & BIT(2)); /* PGERR */
    TEST_ASSERT_EQUAL_HEX32(0xFFFE, stored_flash_read(b, PLACE, 2));
    put_ok(FLASH_SR, FLASH_SR_ERRORS);
    program(PLACE, 0);
    TEST_ASSERT_EQUAL(0, get(FLASH_SR) & FLASH_SR_ERRORS);
    TEST_ASSERT_EQUAL_HEX32(0, stored_flash_read(b, PLACE, 2));
}

static void test_an_erase_takes_one_page(void)
{
    unlock();
    program(0x3FE, 0x1111);
    program(0x400, 0x2222);
    program(0x7FE, 0x3333);
    program(0x800, 0x4444);
    put_ok(FLASH_CR, FLASH_CR_PER);
    put_ok(FLASH_AR, STORED + PLACE);
    put_ok(FLASH_CR, FLASH_CR_PER | FLASH_CR_STRT);
    pass(39000000);
    TEST_ASSERT_EQUAL(FLASH_SR_BSY, get(FLASH_SR) & FLASH_SR_BSY);
    TEST_ASSERT_EQUAL_HEX32(0x2222, stored_flash_read(b, 0x400, 2));
    pass(2000000);
    TEST_ASSERT_EQUAL(0, get(FLASH_CR) & FLASH_CR_STRT);
    TEST_ASSERT_EQUAL_HEX32(0x1111, stored_flash_read(b, 0x3FE, 2));
    TEST_ASSERT_EQUAL_HEX32(0xFFFF, stored_flash_read(b, 0x400, 2));
    TEST_ASSERT_EQUAL_HEX32(0xFFFF, stored_flash_read(b, 0x7FE, 2));
    TEST_ASSERT_EQUAL_HEX32(0x4444, stored_flash_read(b, 0x800, 2));
}

/* Readings of a half-word among 64 that differ from the first one. */
static unsigned changes(uint32_t at)
{
    uint32_t first = stored_flash_read(b, at, 2);
    unsigned n = 0;
    for (unsigned i = 0; i < 64; i++)
        n += stored_flash_read(b, at, 2) != first;
    return n;
}

static void test_an_erase_that_a_reset_ends_leaves_a_page_in_between(void)
{
    unlock();
    program(0x3FE, 0);
    program(0x800, 0);
    for (uint32_t at = 0x400; at < 0x800; at += 2)
        program(at, 0);
    put_ok(FLASH_CR, FLASH_CR_PER);
    put_ok(FLASH_AR, STORED + PLACE);
    put_ok(FLASH_CR, FLASH_CR_PER | FLASH_CR_STRT);
    pass(20000000);
    restart(RESET_PIN);
    unsigned ones = 0, unstable = 0;
    for (uint32_t at = 0x400; at < 0x800; at += 2) {
        ones += (unsigned)__builtin_popcount(stored_flash_read(b, at, 2));
        unstable += changes(at) != 0;
    }
    TEST_ASSERT_UINT_WITHIN(0x400, 0x1000, ones); /* half of 8192 bits */
    TEST_ASSERT_GREATER_THAN_UINT(100, unstable);
    TEST_ASSERT_EQUAL_HEX32(0, stored_flash_read(b, 0x3FE, 2));
    TEST_ASSERT_EQUAL_HEX32(0, stored_flash_read(b, 0x800, 2));
    b->verdict[0] = '\0';
}

static void test_an_erase_that_ends_early_leaves_most_bits_as_they_were(void)
{
    unlock();
    for (uint32_t at = 0x400; at < 0x800; at += 2)
        program(at, 0);
    put_ok(FLASH_CR, FLASH_CR_PER);
    put_ok(FLASH_AR, STORED + PLACE);
    put_ok(FLASH_CR, FLASH_CR_PER | FLASH_CR_STRT);
    pass(4000000); /* of 40 ms */
    restart(RESET_PIN);
    unsigned ones = 0;
    for (uint32_t at = 0x400; at < 0x800; at += 2)
        ones += (unsigned)__builtin_popcount(stored_flash_read(b, at, 2));
    TEST_ASSERT_GREATER_THAN_UINT(0, ones);
    TEST_ASSERT_LESS_THAN_UINT(0x800, ones); /* a quarter of 8192 bits */
    b->verdict[0] = '\0';
}

static void test_a_half_word_that_a_reset_ends_reads_differently_each_time(void)
{
    unlock();
    put_ok(FLASH_CR, FLASH_CR_PG);
    b->chip->store(b, PLACE, 2, 0);
    pass(20000);
    restart(RESET_PIN);
    b->verdict[0] = '\0';
    TEST_ASSERT_GREATER_THAN_UINT(32, changes(PLACE));
    unlock();
    program(PLACE, 0); /* all of its charge now */
    TEST_ASSERT_EQUAL(0, changes(PLACE));
    TEST_ASSERT_EQUAL_HEX32(0, stored_flash_read(b, PLACE, 2));
}

/* Over many cuts: half-words that have their bits, that have none, and that are in between. */
static void test_a_cut_comes_anywhere_within_a_half_word(void)
{
    unsigned none = 0, all = 0, between = 0;
    unlock();
    for (uint32_t at = 0; at < 0x400; at += 2) {
        struct stored_flash *f = stored_flash(b);
        f->cut_word = f->words + 1u;
        program(at, 0x00FF);
        TEST_ASSERT_TRUE(f->cut);
        f->cut = false;
        uint32_t read = stored_flash_read(b, at, 2);
        TEST_ASSERT_EQUAL_HEX32(0x00FF, read & 0x00FF); /* bits that stay */
        if (changes(at) != 0)
            between++;
        else if (read == 0xFFFF)
            none++;
        else if (read == 0x00FF)
            all++;
    }
    TEST_ASSERT_GREATER_THAN_UINT(0, none);
    TEST_ASSERT_GREATER_THAN_UINT(0, all);
    TEST_ASSERT_GREATER_THAN_UINT(200, between);
}

static void test_what_the_flash_refuses(void)
{
    b->chip->store(b, PLACE, 2, 0);
    expect_verdict("which is not for programming"); /* locked */
    put_ok(FLASH_CR, FLASH_CR_PG);
    TEST_ASSERT_EQUAL(FLASH_CR_LOCK, get(FLASH_CR));
    unlock();
    put_ok(FLASH_CR, FLASH_CR_PG);
    b->chip->store(b, PLACE, 4, 0);
    expect_verdict("takes half-words");
    b->around.supply_mv = 1900;
    b->chip->store(b, PLACE, 2, 0);
    expect_verdict("at 1900 mV; 2000 are needed");
    pass(100000);
    put_ok(FLASH_CR, FLASH_CR_PER);
    put_ok(FLASH_AR, 0x08000000u);
    put(FLASH_CR, FLASH_CR_PER | FLASH_CR_STRT);
    expect_verdict("which holds the program");
    put_ok(FLASH_CR, FLASH_CR_LOCK);
    put(FLASH_KEYR, FLASH_KEY2);
    expect_verdict("wrong key");
    put(FLASH_KEYR, FLASH_KEY1);
    expect_verdict("wrong key"); /* until a reset */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_crystal_is_ready_after_its_start_and_without_one_never);
    RUN_TEST(test_the_pll_runs_from_either_oscillator_and_the_core_from_it);
    RUN_TEST(test_a_switch_waits_for_its_clock_and_what_is_used_stays_on);
    RUN_TEST(test_the_lowest_bit_of_the_divider_is_in_two_registers);
    RUN_TEST(test_a_pll_that_is_too_fast_or_changed_while_on_is_refused);
    RUN_TEST(test_a_failing_crystal_raises_the_nmi_or_stops_the_core);
    RUN_TEST(test_reset_flags);
    RUN_TEST(test_a_part_without_its_clock_and_a_reserved_bit_are_refused);
    RUN_TEST(test_pins_are_inputs_until_they_are_set);
    RUN_TEST(test_the_backup_domain_is_closed_until_it_is_opened);
    RUN_TEST(test_the_clock_counts_the_crystals_128th_down);
    RUN_TEST(test_the_voltage_detector);
    RUN_TEST(test_a_reset_leaves_the_debug_settings_alone);
    RUN_TEST(test_a_half_word_takes_its_time_and_the_core_stands_still);
    RUN_TEST(test_a_half_word_that_is_not_erased_takes_only_zero);
    RUN_TEST(test_an_erase_takes_one_page);
    RUN_TEST(test_an_erase_that_a_reset_ends_leaves_a_page_in_between);
    RUN_TEST(test_an_erase_that_ends_early_leaves_most_bits_as_they_were);
    RUN_TEST(test_a_half_word_that_a_reset_ends_reads_differently_each_time);
    RUN_TEST(test_a_cut_comes_anywhere_within_a_half_word);
    RUN_TEST(test_what_the_flash_refuses);
    board_free(b);
    return UNITY_END();
}
