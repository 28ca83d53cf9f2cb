/* What the models of the STM32F405 stand for, asked of them register by register: no code runs. Sections are those of RM0090 Rev 21. */
#include "board_registers.h"

#define PLL_168(mhz)  (RCC_PLLCFGR_KEPT | (mhz) | (336u << 6) | (7u << 24))
#define FLASH_5_WAITS 5u
#define GPIOB_MODER   (GPIOA_MODER + 0x400u)
#define GPIOC_MODER   (GPIOA_MODER + 0x800u)
#define GPIOA_OSPEEDR (GPIOA_MODER + 0x08u)
#define GPIOA_IDR     (GPIOA_MODER + 0x10u)
#define GPIOA_ODR     (GPIOA_MODER + 0x14u)
#define GPIOA_BSRR    (GPIOA_MODER + 0x18u)
#define GPIOA_LCKR    (GPIOA_MODER + 0x1Cu)
#define RCC_BDCR      (RCC_CSR_ADDRESS - 4u)
#define RCC_HSEBYP    BIT(18)
#define RCC_HSI       (RCC_CR_HSION | RCC_CR_HSIRDY)
#define SECOND        UINT64_C(1000000000)
#define TIM2_SR       (TIM2_CR1 + 0x10u)
#define TIM2_DIER     (TIM2_CR1 + 0x0Cu)
#define TIM11_CNT     (TIM11_CR1 + 0x24u)

static void new_board(uint32_t crystal_hz)
{
    const struct surroundings around = usual(&chip_stm32f405, crystal_hz);
    start_board(&chip_stm32f405, &around, empty_image, sizeof empty_image);
}

void setUp(void)
{
    new_board(8000000);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

/* ---- 7: clocks ---- */

static void crystal_on(void)
{
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_HSEON);
    pass(3000000);
    TEST_ASSERT_NOT_EQUAL(0, get(RCC_CR) & RCC_CR_HSERDY);
}

static void pll_on(uint32_t settings)
{
    put_ok(RCC_PLLCFGR, settings);
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_PLLON);
    pass(1000000);
}

static void core_from_pll(void)
{
    put_ok(FLASH_ACR, FLASH_5_WAITS);
    put_ok(RCC_CFGR, RCC_CFGR_PPRE1_4 | RCC_CFGR_PPRE2_2 | RCC_CFGR_SW_PLL);
}

static void from_crystal(void)
{
    crystal_on();
    pll_on(PLL_168(8) | RCC_PLLCFGR_HSE);
    core_from_pll();
    TEST_ASSERT_EQUAL(168000000, b->core_hz);
}

/* 7.3.1 to 7.3.4, 7.3.21 */
static void test_registers_after_a_reset(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x83u, get(RCC_CR) & 0xFFFF00FFu);
    TEST_ASSERT_EQUAL_HEX32(0x24003010u, get(RCC_PLLCFGR));
    TEST_ASSERT_EQUAL_HEX32(0, get(RCC_CFGR));
    TEST_ASSERT_EQUAL_HEX32(0, get(RCC_CIR));
    TEST_ASSERT_EQUAL_HEX32(0x0E000000u, get(RCC_CSR));
    TEST_ASSERT_EQUAL_HEX32(RCC_AHB1ENR_CCM, get(RCC_AHB1ENR));
    TEST_ASSERT_EQUAL(16000000, b->core_hz);
}

static void test_a_crystal_is_ready_after_its_start_and_without_one_never(void)
{
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_HSEON);
    pass(1000000);
    TEST_ASSERT_EQUAL(0, get(RCC_CR) & RCC_CR_HSERDY);
    pass(1500000);
    TEST_ASSERT_NOT_EQUAL(0, get(RCC_CR) & RCC_CR_HSERDY);
    put(RCC_CR, get(RCC_CR) | RCC_HSEBYP);
    expect_verdict("RCC_CR_HSEBYP changed while the crystal is on");
    new_board(0);
    put_ok(RCC_CR, get(RCC_CR) | RCC_CR_HSEON);
    pass(100000000);
    TEST_ASSERT_EQUAL(0, get(RCC_CR) & RCC_CR_HSERDY);
}

/* 7.2, 7.3.2, 7.3.3; timers run twice as fast as a bus that is divided */
static void test_the_pll_runs_from_either_oscillator_and_the_buses_from_it(void)
{
    pll_on(PLL_168(16));
    core_from_pll();
    TEST_ASSERT_EQUAL(168000000, b->core_hz);
    TEST_ASSERT_EQUAL(42000000, bus_clock_hz(b, "apb1"));
    TEST_ASSERT_EQUAL(84000000, bus_clock_hz(b, "apb2"));
    TEST_ASSERT_EQUAL(84000000, timer_clock_hz(b, "apb1"));
    TEST_ASSERT_EQUAL(168000000, timer_clock_hz(b, "apb2"));
    new_board(8000000);
    TEST_ASSERT_EQUAL(16000000, timer_clock_hz(b, "apb1"));
    from_crystal();
}

/* 7.2.6, 7.3.1 */
static void test_a_switch_waits_for_its_clock_and_what_is_used_stays_on(void)
{
    put_ok(RCC_CFGR, 1);
    TEST_ASSERT_EQUAL(1, get(RCC_CFGR) & 15u);
    TEST_ASSERT_EQUAL(16000000, b->core_hz);
    crystal_on();
    TEST_ASSERT_EQUAL(1 | 1 << 2, get(RCC_CFGR) & 15u);
    TEST_ASSERT_EQUAL(8000000, b->core_hz);
    put_ok(RCC_CR, get(RCC_CR) & ~RCC_CR_HSEON);
    TEST_ASSERT_NOT_EQUAL(0, get(RCC_CR) & RCC_CR_HSEON);
    put_ok(RCC_CR, get(RCC_CR) & ~RCC_CR_HSION); /* nobody uses it */
    TEST_ASSERT_EQUAL(0, get(RCC_CR) & RCC_HSI);
    put(RCC_CFGR, 3);
    expect_verdict("switches to clock 3");

    new_board(8000000);
    pll_on(PLL_168(16));
    core_from_pll();
    put_ok(RCC_CR, get(RCC_CR) & ~(RCC_CR_HSION | RCC_CR_PLLON));
    TEST_ASSERT_EQUAL(RCC_HSI, get(RCC_CR) & RCC_HSI); /* the PLL is fed with it */
    TEST_ASSERT_NOT_EQUAL(0, get(RCC_CR) & RCC_CR_PLLON);
}

static void test_settings_of_the_pll(void)
{
    pll_on(PLL_168(8)); /* 2 MHz in, 672 MHz out */
    expect_verdict("oscillator at 672000000 Hz");
    put(RCC_PLLCFGR, PLL_168(16));
    expect_verdict("write of RCC_PLLCFGR while the PLL is on");
    new_board(8000000);
    pll_on(RCC_PLLCFGR_KEPT | 32u | (336u << 6)); /* 0.5 MHz in */
    expect_verdict("PLL fed with 500000 Hz");
    new_board(8000000);
    pll_on(RCC_PLLCFGR_KEPT | 8u | (49u << 6)); /* a factor that is too small */
    expect_verdict("50 to 432");
    put(RCC_PLLCFGR, BIT(31) | RCC_PLLCFGR_KEPT);
    expect_verdict("reserved bits 0x80000000");
    put(RCC_PLLCFGR, 16u); /* bit 29 is kept as after a reset */
    expect_verdict("reserved bits 0x20000000");
}

/* 3.5.1 table 10, 5.4.1, 7.2 */
static void test_clocks_that_are_too_fast(void)
{
    pll_on(PLL_168(16));
    put(RCC_CFGR, RCC_CFGR_PPRE1_4 | RCC_CFGR_PPRE2_2 | RCC_CFGR_SW_PLL);
    expect_verdict("168000000 Hz with 0 wait states of the flash");
    put_ok(FLASH_ACR, FLASH_5_WAITS);
    put(RCC_CFGR, RCC_CFGR_PPRE2_2 | RCC_CFGR_SW_PLL);
    expect_verdict("at most 168, 42 and 84 MHz");
    new_board(8000000);
    put_ok(RCC_APB1ENR, RCC_APB1ENR_PWR);
    put_ok(PWR_CR, 0);
    pll_on(PLL_168(16));
    put_ok(FLASH_ACR, FLASH_5_WAITS);
    put(RCC_CFGR, RCC_CFGR_PPRE1_4 | RCC_CFGR_PPRE2_2 | RCC_CFGR_SW_PLL);
    expect_verdict("with the regulator in scale 2");
}

/* 7.2.7 */
static void test_a_failing_crystal_raises_the_nmi_until_its_flag_is_cleared(void)
{
    from_crystal();
    put_ok(RCC_CR, (get(RCC_CR) & ~RCC_CR_HSION) | RCC_CR_CSSON);
    TEST_ASSERT_EQUAL(0, get(RCC_CR) & RCC_HSI);
    b->around.crystal_hz = 0;
    crystal_changed(b);
    TEST_ASSERT_EQUAL(16000000, b->core_hz);
    TEST_ASSERT_EQUAL(0, get(RCC_CFGR) & 15u);
    TEST_ASSERT_EQUAL(RCC_HSI | RCC_CR_CSSON,
                      get(RCC_CR) & (RCC_HSI | RCC_CR_CSSON | RCC_CR_HSEON | RCC_CR_HSERDY |
                                     RCC_CR_PLLON | RCC_CR_PLLRDY));
    TEST_ASSERT_EQUAL(RCC_CIR_CSSF, get(RCC_CIR));
    TEST_ASSERT_EQUAL(0, b->stalled_until_ns);
    struct interrupts *i = processor_interrupts(b);
    TEST_ASSERT_TRUE(interrupts_any(i));
    put_ok(RCC_CIR, RCC_CIR_CSSC);
    TEST_ASSERT_EQUAL(0, get(RCC_CIR));
    TEST_ASSERT_FALSE(interrupts_any(i));
    put(RCC_CIR, BIT(11)); /* HSERDYIE */
    expect_verdict("interrupts of the RCC are not modelled");
}

static void test_without_the_security_system_a_core_on_the_crystal_stands_still(void)
{
    crystal_on();
    b->around.crystal_hz = 0;
    crystal_changed(b); /* the core runs from its own oscillator */
    TEST_ASSERT_EQUAL(0, b->stalled_until_ns);
    new_board(8000000);
    from_crystal();
    b->around.crystal_hz = 0;
    crystal_changed(b);
    TEST_ASSERT_TRUE(b->stalled_until_ns > 1000u * SECOND);
}

/* 7.1, 7.3.21: flags add up until RMVF; a power-on and a brown-out clear those of before. */
static void test_reset_flags(void)
{
    const uint32_t all = 0xFE000000u, power = RCC_CSR_PORRST | RCC_CSR_BORRST | RCC_CSR_PINRST;
    TEST_ASSERT_EQUAL_HEX32(power, get(RCC_CSR) & all);
    put_ok(RCC_CSR, RCC_CSR_RMVF);
    TEST_ASSERT_EQUAL_HEX32(0, get(RCC_CSR) & all);
    restart(RESET_SOFTWARE);
    TEST_ASSERT_EQUAL_HEX32(RCC_CSR_SFTRST | RCC_CSR_PINRST, get(RCC_CSR) & all);
    restart(RESET_WATCHDOG);
    TEST_ASSERT_EQUAL_HEX32(RCC_CSR_IWDGRST | RCC_CSR_SFTRST | RCC_CSR_PINRST, get(RCC_CSR) & all);
    restart(RESET_BROWN_OUT);
    TEST_ASSERT_EQUAL_HEX32(RCC_CSR_BORRST | RCC_CSR_PINRST, get(RCC_CSR) & all);
    board_power_on(b);
    TEST_ASSERT_EQUAL_HEX32(power, get(RCC_CSR) & all);
}

static void test_a_part_without_its_clock_and_a_reserved_bit_are_refused(void)
{
    (void)get(GPIOA_MODER);
    expect_verdict("read of GPIOA_MODER (0x40020000) while its clock is off");
    put(RCC_APB1ENR, BIT(6) << 4); /* bit 10 */
    expect_verdict("reserved bits 0x00000400");
    (void)get(0x40023898u);
    expect_verdict("RCC has no register there");
}

/* ---- 5.4.1, DS8626 table 19: voltage detector ---- */

static void test_the_voltage_detector_has_two_thresholds(void)
{
    static const uint16_t falling[] = {2040, 2190, 2350, 2510, 2660, 2840, 2930, 3030};
    put_ok(RCC_APB1ENR, RCC_APB1ENR_PWR);
    TEST_ASSERT_EQUAL_HEX32(PWR_CR_VOS, get(PWR_CR));
    for (uint32_t pls = 0; pls < 8; pls++) {
        b->around.supply_mv = 3300;
        put_ok(PWR_CR, PWR_CR_PVDE | pls << 5);
        TEST_ASSERT_EQUAL(0, get(PWR_CSR));
        b->around.supply_mv = falling[pls];
        TEST_ASSERT_EQUAL(0, get(PWR_CSR));
        b->around.supply_mv = falling[pls] - 1u;
        TEST_ASSERT_EQUAL(PWR_CSR_PVDO, get(PWR_CSR));
        b->around.supply_mv = falling[pls] + 80u; /* 90 to 110 mV of hysteresis */
        TEST_ASSERT_EQUAL(PWR_CSR_PVDO, get(PWR_CSR));
        b->around.supply_mv = falling[pls] + 110u;
        TEST_ASSERT_EQUAL(0, get(PWR_CSR));
    }
    b->around.supply_mv = 1800;
    TEST_ASSERT_EQUAL(PWR_CSR_PVDO, get(PWR_CSR));
    put_ok(PWR_CR, 7u << 5);
    TEST_ASSERT_EQUAL(0, get(PWR_CSR));
}

/* ---- 8.4: pins ---- */

static void test_pins(void)
{
    put_ok(RCC_AHB1ENR, RCC_AHB1ENR_CCM | RCC_AHB1ENR_GPIOA | BIT(1) | BIT(2));
    TEST_ASSERT_EQUAL_HEX32(0xA8000000u, get(GPIOA_MODER)); /* the debugger's */
    TEST_ASSERT_EQUAL_HEX32(0x0C000000u, get(GPIOA_OSPEEDR));
    TEST_ASSERT_EQUAL_HEX32(0x64000000u, get(GPIOA_PUPDR));
    TEST_ASSERT_EQUAL_HEX32(0x00000280u, get(GPIOB_MODER));
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIOC_MODER));
    TEST_ASSERT_EQUAL(PIN_NO_FUNCTION, pin_function(b, 'A', 2));
    put_ok(GPIOA_MODER, 0xA8000000u | 2u << 4 | 2u << 18 | 1u << 10);
    put_ok(GPIOA_AFRL, 7u << 8);
    put_ok(GPIOA_AFRH, 8u << 4);
    TEST_ASSERT_EQUAL(7, pin_function(b, 'A', 2));
    TEST_ASSERT_EQUAL(8, pin_function(b, 'A', 9));
    TEST_ASSERT_EQUAL(PIN_NO_FUNCTION, pin_function(b, 'A', 5));
    put_ok(GPIOA_BSRR, BIT(5) | BIT(6) | BIT(5 + 16)); /* to set goes first */
    TEST_ASSERT_EQUAL_HEX32(BIT(5) | BIT(6), get(GPIOA_ODR));
    put_ok(GPIOA_BSRR, BIT(6 + 16));
    TEST_ASSERT_EQUAL_HEX32(BIT(5) | BIT(13) | BIT(15), get(GPIOA_IDR)); /* two are pulled up */
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIOA_BSRR));
    TEST_ASSERT_EQUAL_HEX32(BIT(5), bus_read(b, GPIOA_ODR, 1));
    (void)bus_read(b, GPIOA_IDR, 2);
    expect_verdict("which takes no such width");
    put(GPIOA_LCKR, BIT(16));
    expect_verdict("locking of pins is not modelled");
}

/* ---- timers ---- */

static void test_tim2_counts_its_clock_over_the_prescaler(void)
{
    put_ok(RCC_APB1ENR, RCC_APB1ENR_TIM2);
    put_ok(TIM2_CR1, TIM_CR1_CEN);
    pass(1000000);
    TEST_ASSERT_EQUAL(0, get(TIM2_CNT)); /* it stands while ARR is 0, as after a reset */
    put_ok(TIM2_CR1, 0);
    put_ok(TIM2_ARR, UINT32_MAX);
    put_ok(TIM2_PSC, 3);
    put_ok(TIM2_CR1, TIM_CR1_CEN);
    pass(1000000);
    TEST_ASSERT_EQUAL(16000, get(TIM2_CNT)); /* a divider waits for an update */
    put_ok(TIM2_EGR, TIM_EGR_UG);
    TEST_ASSERT_EQUAL(0, get(TIM2_CNT));
    TEST_ASSERT_EQUAL(1, get(TIM2_SR));
    put_ok(TIM2_SR, 0);
    TEST_ASSERT_EQUAL(0, get(TIM2_SR));
    pass(1000000);
    TEST_ASSERT_EQUAL(4000, get(TIM2_CNT));
    put_ok(TIM2_ARR, 999);
    TEST_ASSERT_EQUAL(0, get(TIM2_CNT));
    put(TIM2_CR1, TIM_CR1_CEN | BIT(4));
    expect_verdict("TIM2_CR1 of 0x11 is not modelled");
    put(TIM2_DIER, 1);
    expect_verdict("interrupts of TIM2 are not modelled");
}

/* 7.2.11: TIM11 captures the crystal's share for the real-time clock; here 8 MHz / 31, every eighth edge, 31 us apart. */
static void test_tim11_measures_the_crystal(void)
{
    crystal_on();
    put_ok(RCC_CFGR, RCC_CFGR_RTCPRE(31));
    put_ok(RCC_APB2ENR, RCC_APB2ENR_TIM11);
    put_ok(TIM11_ARR, 0xFFFFu);
    put_ok(TIM11_OR, TIM11_OR_HSE_RTC);
    put_ok(TIM11_CCMR1, TIM11_CCMR1_TI1_8);
    put_ok(TIM11_CCER, TIM11_CCER_CC1E);
    put_ok(TIM11_CR1, TIM_CR1_CEN);
    pass(20000);
    TEST_ASSERT_EQUAL(TIM11_SR_CC1IF, get(TIM11_SR));
    uint32_t first = get(TIM11_CCR1);
    TEST_ASSERT_EQUAL(0, get(TIM11_SR)); /* the read has cleared it */
    pass(31000);
    TEST_ASSERT_EQUAL(TIM11_SR_CC1IF, get(TIM11_SR));
    TEST_ASSERT_UINT32_WITHIN(1, 31u * 16u, get(TIM11_CCR1) - first);
    pass(31000);
    pass(31000);
    TEST_ASSERT_EQUAL(TIM11_SR_CC1IF | BIT(9), get(TIM11_SR)); /* one was missed */
    (void)get(TIM11_CCR1);
    put_ok(TIM11_SR, 0);
    b->around.crystal_hz = 0;
    crystal_changed(b);
    pass(1000000);
    TEST_ASSERT_EQUAL(0, get(TIM11_SR));
}

/* ---- 38.16: debug ---- */

static void test_only_a_power_on_clears_the_debug_settings(void)
{
    TEST_ASSERT_EQUAL_HEX32(DEV_F405, get(DBGMCU_IDCODE) & DBGMCU_IDCODE_DEV);
    put_ok(DBGMCU_APB1_FZ, DBGMCU_APB1_FZ_IWDG);
    restart(RESET_PIN);
    restart(RESET_WATCHDOG);
    TEST_ASSERT_EQUAL_HEX32(DBGMCU_APB1_FZ_IWDG, get(DBGMCU_APB1_FZ));
    (void)bus_read(b, DBGMCU_APB1_FZ, 2);
    expect_verdict("which takes no such width");
    board_power_on(b);
    TEST_ASSERT_EQUAL_HEX32(0, get(DBGMCU_APB1_FZ));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_registers_after_a_reset);
    RUN_TEST(test_a_crystal_is_ready_after_its_start_and_without_one_never);
    RUN_TEST(test_the_pll_runs_from_either_oscillator_and_the_buses_from_it);
    RUN_TEST(test_a_switch_waits_for_its_clock_and_what_is_used_stays_on);
    RUN_TEST(test_settings_of_the_pll);
    RUN_TEST(test_clocks_that_are_too_fast);
    RUN_TEST(test_a_failing_crystal_raises_the_nmi_until_its_flag_is_cleared);
    RUN_TEST(test_without_the_security_system_a_core_on_the_crystal_stands_still);
    RUN_TEST(test_reset_flags);
    RUN_TEST(test_a_part_without_its_clock_and_a_reserved_bit_are_refused);
    RUN_TEST(test_the_voltage_detector_has_two_thresholds);
    RUN_TEST(test_pins);
    RUN_TEST(test_tim2_counts_its_clock_over_the_prescaler);
    RUN_TEST(test_tim11_measures_the_crystal);
    RUN_TEST(test_only_a_power_on_clears_the_debug_settings);
    board_free(b);
    return UNITY_END();
}
