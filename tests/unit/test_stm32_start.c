/* What start-up leaves in the registers of both chips, and in which order: pins, serial ports, time base, timers. Built once for each chip;
 * sections are those of RM0090 and PM0214 for the STM32F405, of RM0041 for the STM32F100. */
#include "app/app.h"
#include "board.h"
#include "hal/flow.h"
#include "hal/self_check.h"
#include "hal/tick.h"
#include "hal/uart.h"
#include "hal/watchdog.h"
#include "stm32_chip_bench.h"

uint32_t stm32_basepri;
static unsigned ticks;

struct app *app_instance(void)
{
    return NULL;
}

void analog_clock(void) {}

void pulse_clock(void) {}

void app_clock(struct app *app, uint32_t now_ms)
{
    (void)app;
    (void)now_ms;
}

void app_tick(struct app *app)
{
    (void)app;
    ticks++;
}

uint32_t hal_ram_failed_at(void)
{
    return 0;
}

void interrupt_systick(void);
void interrupt_pendsv(void);
void interrupt_usart1(void);

void setUp(void)
{
    usual_surroundings();
    start(RCC_CSR_PORRST);
}

void tearDown(void) {}

static void expect_bits(uint32_t address, uint32_t mask, uint32_t bits)
{
    TEST_ASSERT_EQUAL_HEX32(bits, now(address) & mask);
}

/* RM0090 8.3 and 8.4: PA2, PA3, PA9 and PA10 carry the serial ports, function 7, and a receiver's pin is pulled up; the function is chosen before the
 * pin is given to it, so that no other drives the line in between. RM0041 7.2: outputs push-pull of 2 MHz, inputs pulled, up by BSRR first. */
static void test_pins_of_the_serial_ports_and_no_others(void)
{
#if F405
    becomes(GPIOA_MODER, 0xA8000000u); /* the debugger's */
    becomes(GPIOA_PUPDR, 0x64000000u);
    becomes(GPIOA_AFRL, 0x10000001u);
    becomes(GPIOA_AFRH, 0x20000002u);
    pins_start();
    TEST_ASSERT_EQUAL_HEX32(0xA8000000u | 10u << 4 | 10u << 18, now(GPIOA_MODER));
    TEST_ASSERT_EQUAL_HEX32(0x64000000u | 1u << 6 | 1u << 20, now(GPIOA_PUPDR));
    TEST_ASSERT_EQUAL_HEX32(0x10007701u, now(GPIOA_AFRL));
    TEST_ASSERT_EQUAL_HEX32(0x20000772u, now(GPIOA_AFRH));
    unsigned given = first_write(GPIOA_MODER, 0xFFu << 4, 10u << 4);
    TEST_ASSERT_TRUE(first_write(GPIOA_AFRL, 0xFF00u, 0x7700u) < given);
    TEST_ASSERT_TRUE(first_write(GPIOA_AFRH, 0xFF0u, 0x770u) < given);
    TEST_ASSERT_TRUE(first_write(GPIOA_PUPDR, 3u << 6, 1u << 6) < given);
    expect_bits(RCC_AHB1ENR, ~0u, RCC_AHB1ENR_GPIOA);
    expect_bits(RCC_APB2ENR, ~0u, RCC_APB2ENR_USART1);
    expect_bits(RCC_APB1ENR, ~0u, RCC_APB1ENR_USART2 | RCC_APB1ENR_PWR | RCC_APB1ENR_TIM2);
#else
    becomes(GPIOA_CRL, 0x44444444u);
    becomes(GPIOA_CRH, 0x44444444u);
    pins_start();
    TEST_ASSERT_EQUAL_HEX32(0x44448A44u, now(GPIOA_CRL));
    TEST_ASSERT_EQUAL_HEX32(0x444448A4u, now(GPIOA_CRH));
    TEST_ASSERT_EQUAL_HEX32(BIT(3) | BIT(10), now(GPIOA_BSRR));
    unsigned up = first_write(GPIOA_BSRR, BIT(3) | BIT(10), BIT(3) | BIT(10));
    TEST_ASSERT_TRUE(up < first_write(GPIOA_CRL, 0xF000u, 0x8000u));
    TEST_ASSERT_TRUE(up < first_write(GPIOA_CRH, 0xF00u, 0x800u));
    expect_bits(RCC_APB2ENR, ~0u, RCC_APB2ENR_USART1 | RCC_APB2ENR_IOPA);
    expect_bits(RCC_APB1ENR, ~0u, RCC_APB1ENR_USART2 | RCC_APB1ENR_PWR);
#endif
}

/* RM0090 30.6, RM0041 23.6, PM0214 4.3: 115200 baud, both directions, reception by interrupt. The line is a part's before its transmitter drives it,
 * and an interrupt has its priority before it is enabled. */
static void test_serial_ports(void)
{
    uart_start();
    const uint32_t base[] = {USART1_BASE, USART2_BASE}, hz[] = {clock_apb2_hz(), clock_apb1_hz()};
    for (unsigned i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL((hz[i] + 57600u) / 115200u, now(USART_BRR(base[i])));
        TEST_ASSERT_EQUAL_HEX32(0x202Cu, now(USART_CR1(base[i])));
        TEST_ASSERT_TRUE(first_write(USART_BRR(base[i]), 0, 0) <
                         first_write(USART_CR1(base[i]), USART_CR1_UE, USART_CR1_UE));
    }
    unsigned enabled = first_write(NVIC_ISER(1), 0x60u, 0x60u);
    TEST_ASSERT_EQUAL_HEX32(0x60u, now(NVIC_ISER(1)));
    expect_bits(NVIC_IPR(36), 0x00FFFF00u, PRIORITY_UART << 8 | PRIORITY_UART << 16);
    TEST_ASSERT_TRUE(
        first_write(NVIC_IPR(36), 0x00FFFF00u, PRIORITY_UART << 8 | PRIORITY_UART << 16) < enabled);
}

/* The line takes a byte at a time: what waits goes by interrupt, which is off where nothing waits. */
static void test_what_waits_for_a_line_goes_by_interrupt(void)
{
    uart_start();
    TEST_ASSERT_TRUE(hal_uart_write(HAL_UART_LINK, "ab", 2));
    becomes(USART_SR(USART2_BASE), 0);
    TEST_ASSERT_EQUAL(3, hal_uart_pump(HAL_UART_LINK)); /* one is on the line */
    TEST_ASSERT_EQUAL_HEX32(0x202Cu | USART_CR1_TXEIE, now(USART_CR1(USART2_BASE)));
    becomes(USART_SR(USART2_BASE), USART_SR_TXE);
    TEST_ASSERT_EQUAL(1, hal_uart_pump(HAL_UART_LINK));
    becomes(USART_SR(USART2_BASE), USART_SR_TXE | USART_SR_TC);
    TEST_ASSERT_EQUAL(0, hal_uart_pump(HAL_UART_LINK));
    TEST_ASSERT_EQUAL_HEX32(0x202Cu, now(USART_CR1(USART2_BASE)));
    TEST_ASSERT_EQUAL('b', now(USART_DR(USART2_BASE)));
    /* In an erase only bytes from the plant interrupt. */
    becomes(USART_CR1(USART2_BASE), 0x202Cu | USART_CR1_TXEIE);
    becomes(USART_CR1(USART1_BASE), 0x202Cu | USART_CR1_TXEIE);
    uart_hold_interrupts(true);
    TEST_ASSERT_EQUAL_HEX32(0x202Cu, now(USART_CR1(USART2_BASE)));
    TEST_ASSERT_EQUAL_HEX32(0x200Cu, now(USART_CR1(USART1_BASE)));
    uart_hold_interrupts(false);
    TEST_ASSERT_EQUAL_HEX32(0x202Cu | USART_CR1_TXEIE, now(USART_CR1(USART2_BASE)));
    TEST_ASSERT_EQUAL_HEX32(0x202Cu | USART_CR1_TXEIE, now(USART_CR1(USART1_BASE)));
}

/* A console whose ring is nearly full is asked to stop, before anything else goes out (hal/flow.h). */
static void test_the_terminal_is_asked_to_stop(void)
{
    uart_start();
    TEST_ASSERT_TRUE(hal_uart_write(HAL_UART_CONSOLE, "ab", 2));
    becomes(USART_SR(USART1_BASE), 0);
    (void)hal_uart_pump(HAL_UART_CONSOLE);
    becomes(USART_SR(USART1_BASE), USART_SR_TXE);
    interrupt_usart1();
    TEST_ASSERT_EQUAL('b', now(USART_DR(USART1_BASE)));
    for (unsigned i = 0; i < 1024 && now(USART_DR(USART1_BASE)) != FLOW_XOFF; i++) {
        becomes(USART_SR(USART1_BASE), USART_SR_RXNE | USART_SR_TXE);
        becomes(USART_DR(USART1_BASE), 'x');
        interrupt_usart1();
    }
    TEST_ASSERT_EQUAL_HEX32(FLOW_XOFF, now(USART_DR(USART1_BASE)));
    uint8_t all[1024];
    TEST_ASSERT_TRUE(hal_uart_read(HAL_UART_CONSOLE, all, sizeof all) > 10);
    TEST_ASSERT_EQUAL_HEX32(FLOW_XON, now(USART_DR(USART1_BASE)));
}

/* While the flash is erased: a good byte is kept and a damaged one is not; what waits goes out before what is given. */
static void test_the_plant_link_is_served_by_polling(void)
{
    static const struct {
        uint32_t status;
        bool good;
    } cases[] = {{USART_SR_RXNE, true},
                 {USART_SR_RXNE | USART_SR_ORE, true},
                 {USART_SR_RXNE | USART_SR_PE, false},
                 {USART_SR_RXNE | USART_SR_FE, false},
                 {USART_SR_RXNE | USART_SR_NE, false},
                 {USART_SR_ORE, false},
                 {0, false}};
    uint8_t byte = 0;
    uart_start();
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        becomes(USART_DR(USART2_BASE), 'x');
        becomes(USART_SR(USART2_BASE), cases[i].status);
        TEST_ASSERT_FALSE(uart_serve_link((const uint8_t *)"m"));
        TEST_ASSERT_EQUAL(cases[i].good, hal_uart_read(HAL_UART_LINK, &byte, 1));
        TEST_ASSERT_EQUAL('x', now(USART_DR(USART2_BASE)));
    }
    becomes(USART_SR(USART2_BASE), USART_SR_TXE);
    TEST_ASSERT_TRUE(hal_uart_write(HAL_UART_LINK, "q", 1));
    TEST_ASSERT_FALSE(uart_serve_link((const uint8_t *)"m"));
    TEST_ASSERT_EQUAL('q', now(USART_DR(USART2_BASE)));
    TEST_ASSERT_TRUE(uart_serve_link((const uint8_t *)"m"));
    TEST_ASSERT_EQUAL('m', now(USART_DR(USART2_BASE)));
    TEST_ASSERT_FALSE(uart_serve_link(NULL));
}

/* Reading DR is what clears an overrun (RM0090 30.6.1): without it the interrupt would come again for ever. */
static void test_an_overrun_alone_is_read_away(void)
{
    uart_start();
    becomes(USART_SR(USART2_BASE), USART_SR_ORE);
    unsigned from = cycles;
    TEST_ASSERT_FALSE(uart_serve_link(NULL));
    unsigned with = cycles - from;
    becomes(USART_SR(USART2_BASE), 0);
    from = cycles;
    TEST_ASSERT_FALSE(uart_serve_link(NULL));
    TEST_ASSERT_TRUE(with > cycles - from); /* one access more */
}

/* RM0090 21.3, RM0041 18.3: started, opened, set, and fed once both values have arrived. */
static void test_the_watchdog_is_set_and_fed_in_order(void)
{
    forget_writes();
    becomes(IWDG_KR, 0);
    iwdg_early = false;
    iwdg_busy = 3; /* a value of before */
    TEST_ASSERT_TRUE(hal_watchdog_start(1000));
    unsigned begun = first_write(IWDG_KR, ~0u, IWDG_KR_START),
             open = first_write(IWDG_KR, ~0u, IWDG_KR_ACCESS);
    unsigned fed = first_write(IWDG_KR, ~0u, IWDG_KR_RELOAD);
    TEST_ASSERT_TRUE(begun < open && open < fed && fed < WRITES);
    TEST_ASSERT_FALSE(iwdg_early);
    TEST_ASSERT_TRUE(now(IWDG_RLR) * (4u << now(IWDG_PR)) > 990u * LSI_PER_MS);
    becomes(IWDG_KR, 0);
    hal_watchdog_feed();
    TEST_ASSERT_EQUAL_HEX32(IWDG_KR_RELOAD, now(IWDG_KR));
}

/* RM0090 21.3 and 21.4.3, RM0041 18.4.3: a value is written, and read, while none is on its way. */
static void test_the_watchdog_gets_another_time_while_it_runs(void)
{
    TEST_ASSERT_TRUE(hal_watchdog_start(1000));
    uint32_t prescaler = now(IWDG_PR);
    static const uint32_t wanted_ms[] = {2000, 1000};
    for (unsigned k = 0; k < 2; k++) {
        unsigned calls = 1;
        iwdg_early = false;
        iwdg_busy = 3; /* a value of before */
        while (!hal_watchdog_change(wanted_ms[k]) && calls < 100)
            calls++;
        TEST_ASSERT_TRUE(calls > 1 && calls < 100);
        TEST_ASSERT_FALSE(iwdg_early);
        TEST_ASSERT_EQUAL(prescaler, now(IWDG_PR));
        uint32_t counts = now(IWDG_RLR) * (4u << prescaler), right = wanted_ms[k] * LSI_PER_MS;
        TEST_ASSERT_TRUE(counts <= right && counts > right / 100u * 99u);
        unsigned writes_before = n_writes;
        TEST_ASSERT_TRUE(hal_watchdog_change(wanted_ms[k])); /* it has it */
        TEST_ASSERT_EQUAL(writes_before, n_writes);
    }
}

/* RM0090 5.4.1, RM0041 4.4.1: whatever the level was, it is the chosen one; the rest stays. */
static void test_the_level_of_the_detector_is_replaced(void)
{
    becomes(PWR_CR, 7u << 5 | BIT(8));
    supply_start();
    TEST_ASSERT_EQUAL_HEX32(PWR_CR_PLS_CHOSEN | PWR_CR_PVDE | BIT(8), now(PWR_CR));
    crystal_khz = 0; /* nobody else turns the clock on */
    start(RCC_CSR_PORRST);
    expect_bits(RCC_APB1ENR, RCC_APB1ENR_PWR, RCC_APB1ENR_PWR);
}

/* PM0214 4.4.13, 4.4.16 and 4.4.17: an address is good where its bit says so. */
static void test_the_address_of_a_fault(void)
{
    static const struct {
        uint32_t status, address;
    } cases[] = {{SCB_CFSR_BFARVALID, 0xB0u}, {SCB_CFSR_MMARVALID, 0xA0u}, {0x7F7Fu, 0}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct hal_fault fault;
        start(RCC_CSR_PINRST);
        stm32_ipsr = 5;
        becomes(SCB_CFSR, cases[i].status);
        becomes(SCB_BFAR, 0xB0u);
        becomes(SCB_MMFAR, 0xA0u);
        if (setjmp(board_reset) == 0)
            identity_fault(stack_bottom, 0xFFFFFFF9u);
        TEST_ASSERT_TRUE(hal_last_fault(&fault));
        TEST_ASSERT_EQUAL_HEX32(cases[i].address, fault.address);
        TEST_ASSERT_EQUAL_HEX32(cases[i].status, fault.status);
    }
}

/* Each error flag, and a byte that is damaged or lost (RM0090 30.6.1, RM0041 23.6.1). */
static void test_damaged_bytes_are_counted_and_dropped(void)
{
    static const struct {
        uint32_t status;
        bool error, good;
    } cases[] = {{USART_SR_RXNE, false, true},
                 {USART_SR_RXNE | USART_SR_ORE, true, true},
                 {USART_SR_RXNE | USART_SR_FE, true, false},
                 {USART_SR_RXNE | USART_SR_NE, true, false},
                 {USART_SR_RXNE | USART_SR_PE, true, false},
                 {USART_SR_ORE, true, false}};
    uart_start();
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct hal_uart_stats before, after;
        uint8_t byte = 0;
        hal_uart_get_stats(HAL_UART_CONSOLE, &before);
        becomes(USART_SR(USART1_BASE), cases[i].status);
        becomes(USART_DR(USART1_BASE), 'x');
        interrupt_usart1();
        hal_uart_get_stats(HAL_UART_CONSOLE, &after);
        TEST_ASSERT_EQUAL(cases[i].error, after.line_errors - before.line_errors);
        TEST_ASSERT_EQUAL(cases[i].good, hal_uart_read(HAL_UART_CONSOLE, &byte, 1));
    }
}

/* PM0214 4.5.5 and 2.3.4: reload, clear, start; a millisecond of the core's clock. Serial ports go before the clock, the clock before the tick. */
static void test_time_base(void)
{
    becomes(SYST_CVR, 77);
    tick_start_timebase();
    TEST_ASSERT_EQUAL(PLL_HZ / 1000u - 1u, now(SYST_RVR));
    TEST_ASSERT_EQUAL(0, now(SYST_CVR));
    TEST_ASSERT_EQUAL_HEX32(7u, now(SYST_CSR));
    unsigned started = first_write(SYST_CSR, 1u, 1u);
    TEST_ASSERT_TRUE(first_write(SYST_RVR, 0, 0) < first_write(SYST_CVR, ~0u, 0));
    TEST_ASSERT_TRUE(first_write(SYST_CVR, ~0u, 0) < started);
    expect_bits(SCB_SHPR(12), 0xFFFF0000u, 0xF0u << 16 | 0x80u << 24);
    TEST_ASSERT_TRUE(first_write(SCB_SHPR(12), 0xFFFF0000u, 0x80F00000u) < started);
}

/* PM0214 4.4.3 */
static void test_the_tick_is_requested_every_period_and_only_when_it_may(void)
{
    uint64_t began = hal_clock_ms();
    hal_tick_request();
    TEST_ASSERT_EQUAL_HEX32(0, now(SCB_ICSR));
    tick_start();
    for (unsigned period = 0; period < 3; period++) {
        becomes(SCB_ICSR, 0);
        for (unsigned ms = 1; ms < HAL_TICK_PERIOD_MS; ms++) {
            interrupt_systick();
            TEST_ASSERT_EQUAL_HEX32(0, now(SCB_ICSR));
        }
        interrupt_systick();
        TEST_ASSERT_EQUAL_HEX32(SCB_ICSR_PENDSVSET, now(SCB_ICSR));
    }
    TEST_ASSERT_EQUAL(3u * HAL_TICK_PERIOD_MS, hal_clock_ms() - began);
    interrupt_pendsv();
    TEST_ASSERT_EQUAL(1, ticks);
}

/* What measured the crystal is off again. DDI 0403 C1.8: the cycle counter counts once the trace unit is on. */
static void test_what_the_clock_leaves_behind(void)
{
    expect_bits(SCB_DEMCR, SCB_DEMCR_TRCENA, SCB_DEMCR_TRCENA);
    expect_bits(DWT_CTRL, 1u, 1u);
    TEST_ASSERT_TRUE(first_write(SCB_DEMCR, SCB_DEMCR_TRCENA, SCB_DEMCR_TRCENA) <
                     first_write(DWT_CTRL, 1u, 1u));
#if F405
    /* A watchdog that runs from the reset on is fed in each wait. */
    TEST_ASSERT_TRUE(first_write(IWDG_KR, ~0u, IWDG_KR_RELOAD) < WRITES);
    TEST_ASSERT_EQUAL(0, now(TIM11_CR1));
    TEST_ASSERT_EQUAL(0, now(TIM11_CCER));
    expect_bits(RCC_APB2ENR, RCC_APB2ENR_TIM11, 0);
    /* RM0090 18.4: TIM2 counts for the emulator, over all of its 32 bits. */
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, now(TIM2_ARR));
    TEST_ASSERT_EQUAL(0, now(TIM2_PSC));
    TEST_ASSERT_EQUAL(TIM_EGR_UG, now(TIM2_EGR));
    TEST_ASSERT_EQUAL(TIM_CR1_CEN, now(TIM2_CR1));
    expect_bits(RCC_APB1ENR, RCC_APB1ENR_TIM2, RCC_APB1ENR_TIM2);
#else
    expect_bits(RCC_APB1ENR, RCC_APB1ENR_BKP, 0);
#endif
}

/* A PLL that does not lock or is not taken is switched off, and the buses are undivided (RM0090 7.3.3, RM0041 6.3.2). */
static void test_a_pll_that_fails_is_off(void)
{
    pll_locks = false;
    start(RCC_CSR_PORRST);
    expect_bits(RCC_CR, RCC_CR_PLLON, 0);
    expect_bits(RCC_CFGR, 3u, 0);
#if F405
    TEST_ASSERT_EQUAL_HEX32(FLASH_ACR_ICEN | FLASH_ACR_DCEN | FLASH_ACR_PRFTEN, now(FLASH_ACR));
    expect_bits(PWR_CR, PWR_CR_VOS, PWR_CR_VOS);
#endif
    pll_locks = true;
    switches = false;
    start(RCC_CSR_PORRST);
    expect_bits(RCC_CFGR, 3u, 0);
    TEST_ASSERT_EQUAL(HSI_HZ, hal_core_hz());
#if F405
    expect_bits(RCC_CFGR, 7u << 10 | 7u << 13, 0);
    switches = true;
    waits_taken = false; /* without wait states no speed */
    start(RCC_CSR_PORRST);
    expect_bits(RCC_CFGR, 3u, 0);
    TEST_ASSERT_EQUAL(HSI_HZ, hal_core_hz());
#else
    expect_bits(RCC_CR, RCC_CR_PLLON, 0);
#endif
}

/* RM0090 7.3.21, RM0041 6.3.10: one flag beside that of the pin, which comes with each; a power-on before the first names nothing else. */
static void test_each_flag_of_a_reset_has_its_name(void)
{
    static const struct {
        uint32_t flags;
        enum hal_reset cause;
    } cases[] = {{RCC_CSR_PORRST, HAL_RESET_POWER_ON},  {RCC_CSR_IWDGRST, HAL_RESET_WATCHDOG},
                 {RCC_CSR_WWDGRST, HAL_RESET_WATCHDOG}, {RCC_CSR_BORRST, HAL_RESET_POWER_ON},
                 {RCC_CSR_SFTRST, HAL_RESET_REQUESTED}, {0, HAL_RESET_PIN}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        start(cases[i].flags | RCC_CSR_PINRST);
        TEST_ASSERT_EQUAL(cases[i].cause, hal_reset_cause());
        TEST_ASSERT_EQUAL_HEX32(cases[i].flags | RCC_CSR_PINRST | RCC_CSR_RMVF, now(RCC_CSR));
    }
    start(RCC_CSR_LPWRRST);
    TEST_ASSERT_EQUAL(HAL_RESET_UNKNOWN, hal_reset_cause());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_pins_of_the_serial_ports_and_no_others);
    RUN_TEST(test_serial_ports);
    RUN_TEST(test_what_waits_for_a_line_goes_by_interrupt);
    RUN_TEST(test_the_terminal_is_asked_to_stop);
    RUN_TEST(test_the_plant_link_is_served_by_polling);
    RUN_TEST(test_an_overrun_alone_is_read_away);
    RUN_TEST(test_the_watchdog_is_set_and_fed_in_order);
    RUN_TEST(test_the_watchdog_gets_another_time_while_it_runs);
    RUN_TEST(test_the_level_of_the_detector_is_replaced);
    RUN_TEST(test_the_address_of_a_fault);
    RUN_TEST(test_damaged_bytes_are_counted_and_dropped);
    RUN_TEST(test_time_base);
    RUN_TEST(test_the_tick_is_requested_every_period_and_only_when_it_may);
    RUN_TEST(test_what_the_clock_leaves_behind);
    RUN_TEST(test_a_pll_that_fails_is_off);
    RUN_TEST(test_each_flag_of_a_reset_has_its_name);
    return UNITY_END();
}
