/* What the models stand for that both chips share, asked of those of the STM32F405: serial port (RM0041 Rev 6 23), watchdog (RM0090 Rev 21 21). */
#include "board_registers.h"

#define BYTE_NS   86805u /* ten bits of 115,200 baud */
#define BRR_RIGHT 139u   /* 16 MHz / 115,200 */
#define SR        USART_SR(USART1_BASE)
#define DR        USART_DR(USART1_BASE)
#define CR1       USART_CR1(USART1_BASE)
#define SR_TC     BIT(6)
#define CR1_TCIE  BIT(6)
#define CR1_ON    (USART_CR1_UE | USART_CR1_TE | USART_CR1_RE)
#define CR1_PCE   BIT(10)
#define CR1_OVER8 BIT(15)
#define SLOW_HZ   32000u
#define PERIOD_NS UINT64_C(31250)
#define COUNT_NS  (4u * PERIOD_NS) /* divided by 4, as after a reset */

void setUp(void)
{
    const struct surroundings around = usual(&chip_stm32f405, 8000000);
    TEST_ASSERT_EQUAL(SLOW_HZ, around.slow_clock_hz);
    start_board(&chip_stm32f405, &around, empty_image, sizeof empty_image);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

/* ---- serial port ---- */

static void port_on(uint32_t divider)
{
    put_ok(RCC_AHB1ENR, RCC_AHB1ENR_GPIOA | RCC_AHB1ENR_CCM);
    put_ok(RCC_APB2ENR, RCC_APB2ENR_USART1);
    put_ok(GPIOA_AFRH, 0x770u);
    put_ok(GPIOA_MODER, 0xA8000000u | 10u << 18);
    put_ok(USART_BRR(USART1_BASE), divider);
    put_ok(CR1, CR1_ON);
}

static void give(const char *text)
{
    TEST_ASSERT_EQUAL(strlen(text), line_give(b, 0, (const uint8_t *)text, strlen(text)));
}

static bool asks(void)
{
    return interrupts_any(processor_interrupts(b));
}

static void interrupt_on(uint32_t bits)
{
    put_ok(NVIC_ISER(1), BIT(USART1_IRQ - 32u));
    put_ok(CR1, CR1_ON | bits);
}

/* 23.3.2: the data register in front of the shift register */
static void test_bytes_leave_one_after_another_at_the_rate_of_the_divider(void)
{
    uint8_t seen[4];
    port_on(BRR_RIGHT);
    TEST_ASSERT_EQUAL_HEX32(USART_SR_TXE | SR_TC, get(SR));
    put_ok(DR, 'a');
    TEST_ASSERT_EQUAL_HEX32(USART_SR_TXE, get(SR)); /* moved on at once */
    put_ok(DR, 'b');
    TEST_ASSERT_EQUAL_HEX32(0, get(SR));
    pass(BYTE_NS - 200u);
    TEST_ASSERT_EQUAL(0, line_take(b, 0, seen, sizeof seen));
    pass(400);
    TEST_ASSERT_EQUAL(1, line_take(b, 0, seen, sizeof seen));
    TEST_ASSERT_EQUAL('a', seen[0]);
    TEST_ASSERT_EQUAL_HEX32(USART_SR_TXE, get(SR));
    pass(BYTE_NS + 200u);
    TEST_ASSERT_EQUAL(1, line_take(b, 0, seen, sizeof seen));
    TEST_ASSERT_EQUAL('b', seen[0]);
    TEST_ASSERT_EQUAL_HEX32(USART_SR_TXE | SR_TC, get(SR));
    put_ok(DR, 'c');
    put_ok(DR, 'd');
    put(DR, 'e');
    expect_verdict("a byte written to USART1_DR over one that was not sent");
    put_ok(CR1, 0);
    put(DR, 'f');
    expect_verdict("a byte written to USART1 while its transmitter is off");
}

/* 23.6.1: TC is cleared by a read of SR and a write of DR after it, or by a zero. */
static void test_the_end_of_sending_is_cleared_in_its_order(void)
{
    port_on(BRR_RIGHT);
    put_ok(DR, 'a');
    TEST_ASSERT_EQUAL_HEX32(USART_SR_TXE | SR_TC, get(SR)); /* nobody had read SR */
    pass(2u * BYTE_NS);
    put_ok(DR, 'b');
    TEST_ASSERT_EQUAL_HEX32(USART_SR_TXE, get(SR));
    pass(2u * BYTE_NS);
    put_ok(SR, 0);
    TEST_ASSERT_EQUAL_HEX32(USART_SR_TXE, get(SR));
}

/* 23.3.3, 23.4 */
static void test_a_byte_that_nobody_takes_is_kept_and_the_next_is_lost(void)
{
    port_on(BRR_RIGHT);
    interrupt_on(USART_CR1_RXNEIE);
    TEST_ASSERT_FALSE(asks());
    give("xyz");
    pass(BYTE_NS + 100u);
    TEST_ASSERT_TRUE(asks());
    TEST_ASSERT_EQUAL(USART_SR_RXNE, get(SR) & 0x2Fu);
    pass(BYTE_NS + 100u);
    pass(BYTE_NS + 100u);
    TEST_ASSERT_EQUAL('x',
                      get(DR)); /* SR was read before the overrun: this read does not clear it */
    TEST_ASSERT_EQUAL(USART_SR_ORE, get(SR) & 0x2Fu);
    TEST_ASSERT_TRUE(asks());
    TEST_ASSERT_EQUAL('x', get(DR));
    TEST_ASSERT_EQUAL(0, get(SR) & 0x2Fu);
    TEST_ASSERT_FALSE(asks());
}

static void test_each_enable_bit_has_its_flag(void)
{
    port_on(BRR_RIGHT);
    interrupt_on(USART_CR1_TXEIE);
    TEST_ASSERT_TRUE(asks());
    (void)get(SR);
    put_ok(DR, 'a');
    put_ok(DR, 'b');
    TEST_ASSERT_FALSE(asks());
    interrupt_on(CR1_TCIE);
    pass(BYTE_NS + 100u);
    TEST_ASSERT_FALSE(asks());
    pass(BYTE_NS + 100u);
    TEST_ASSERT_TRUE(asks());
    put_ok(CR1, 0);
    TEST_ASSERT_FALSE(asks());
}

/* A far end of another rate; 23.6.1: with an overrun no other error is told. */
static void test_another_rate_gives_framing_errors(void)
{
    uint8_t seen[8];
    port_on(2u * BRR_RIGHT);
    give("UU");
    pass(BYTE_NS + 100u);
    TEST_ASSERT_EQUAL(USART_SR_RXNE | USART_SR_FE, get(SR) & 0x2Fu);
    (void)get(DR);
    TEST_ASSERT_EQUAL(0, get(SR) & 0x2Fu);
    pass(BYTE_NS + 100u);
    (void)get(SR);
    (void)get(DR);
    put_ok(USART_BRR(USART1_BASE), BRR_RIGHT);
    give("a");
    pass(BYTE_NS + 100u);
    put_ok(USART_BRR(USART1_BASE), 2u * BRR_RIGHT);
    give("U");
    pass(BYTE_NS + 100u);
    TEST_ASSERT_EQUAL(USART_SR_RXNE | USART_SR_ORE, get(SR) & 0x2Fu);
    TEST_ASSERT_EQUAL('a', get(DR));
    put_ok(DR, 'a');
    pass(2u * BYTE_NS + 200u); /* twice as long a byte */
    TEST_ASSERT_EQUAL(1, line_take(b, 0, seen, sizeof seen));
}

static void test_without_its_pin_or_its_receiver_nothing_comes(void)
{
    uint8_t seen[4];
    port_on(BRR_RIGHT);
    put_ok(GPIOA_MODER, 0xA8000000u);
    give("a");
    put_ok(DR, 'a');
    pass(BYTE_NS + 100u);
    TEST_ASSERT_EQUAL(0, get(SR) & 0x2Fu);
    TEST_ASSERT_EQUAL(0, line_take(b, 0, seen, sizeof seen));
    put_ok(GPIOA_MODER, 0xA8000000u | 10u << 18);
    put_ok(GPIOA_AFRH, 0x660u); /* given to something else */
    give("a");
    put_ok(DR, 'a');
    pass(BYTE_NS + 100u);
    TEST_ASSERT_EQUAL(0, get(SR) & 0x2Fu);
    TEST_ASSERT_EQUAL(0, line_take(b, 0, seen, sizeof seen));
    put_ok(GPIOA_AFRH, 0x770u);
    put_ok(CR1, CR1_ON & ~USART_CR1_RE);
    give("a");
    pass(BYTE_NS + 100u);
    TEST_ASSERT_EQUAL(0, get(SR) & 0x2Fu);
}

static void test_what_the_port_refuses(void)
{
    port_on(BRR_RIGHT);
    (void)bus_read(b, SR, 1); /* 23.6 */
    expect_verdict("which takes no such width");
    put(CR1, CR1_ON | CR1_PCE);
    expect_verdict("USART1_CR1 of 0x240c is not modelled");
    put(CR1, CR1_ON | CR1_OVER8);
    expect_verdict("USART1_CR1 of 0xa00c is not modelled");
    put(USART1_BASE + 0x10u, 1u << 12);
    expect_verdict("USART1_CR2 of 0x1000 is not modelled");
    put(SR, BIT(12));
    expect_verdict("reserved bits 0x00001000");
}

/* ---- watchdog ---- */

static bool bitten(void)
{
    bool asked = b->reset_asked;
    b->reset_asked = false;
    return asked;
}

/* 21.3: it starts from 0xFFF; a reload takes IWDG_RLR. */
static void test_the_watchdog_bites_at_the_end_of_its_count(void)
{
    put_ok(IWDG_KR, IWDG_KR_RELOAD);
    pass(10u * 4096u * COUNT_NS);
    TEST_ASSERT_FALSE(bitten()); /* it has not been started */
    put_ok(IWDG_KR, IWDG_KR_START);
    pass(4096u * COUNT_NS - COUNT_NS);
    TEST_ASSERT_FALSE(bitten());
    put_ok(IWDG_KR, IWDG_KR_START); /* 21.4.1: once more changes nothing */
    pass(2u * COUNT_NS);
    TEST_ASSERT_TRUE(bitten());
    TEST_ASSERT_EQUAL(RESET_WATCHDOG, b->reset_kind);
}

/* 21.3.2, 21.4.2 to 21.4.4 */
static void test_values_are_taken_with_the_key_and_after_five_periods(void)
{
    put_ok(IWDG_KR, IWDG_KR_START);
    put_ok(IWDG_RLR, 9);
    TEST_ASSERT_EQUAL_HEX32(0xFFFu, get(IWDG_RLR));
    put_ok(IWDG_KR, IWDG_KR_ACCESS);
    put_ok(IWDG_PR, 2);
    put_ok(IWDG_RLR, 9);
    TEST_ASSERT_EQUAL(3, get(IWDG_SR));
    put(IWDG_RLR, 10);
    expect_verdict("write of IWDG_RLR while an earlier value is on its way");
    put(IWDG_PR, 1);
    expect_verdict("write of IWDG_PR while an earlier value is on its way");
    pass(5u * PERIOD_NS);
    TEST_ASSERT_EQUAL(0, get(IWDG_SR));
    put_ok(IWDG_KR, IWDG_KR_RELOAD); /* closes them again */
    put_ok(IWDG_PR, 6);
    TEST_ASSERT_EQUAL(0, get(IWDG_SR));
    put_ok(IWDG_KR, IWDG_KR_ACCESS);
    TEST_ASSERT_EQUAL(0, get(IWDG_KR));
    (void)bus_read(b, IWDG_KR, 1);
    expect_verdict("which takes no such width");
}

/* Table 108 */
static void test_the_time_is_the_divider_and_the_count(void)
{
    static const uint32_t divider[] = {4, 8, 16, 32, 64, 128, 256, 256};
    for (uint32_t pr = 0; pr < 8; pr++) {
        board_power_on(b);
        put_ok(IWDG_KR, IWDG_KR_ACCESS);
        put_ok(IWDG_PR, pr);
        put_ok(IWDG_RLR, 99);
        pass(5u * PERIOD_NS);
        put_ok(IWDG_KR, IWDG_KR_RELOAD);
        put_ok(IWDG_KR, IWDG_KR_START);
        pass(99u * divider[pr] * PERIOD_NS);
        TEST_ASSERT_FALSE(bitten());
        pass(divider[pr] * PERIOD_NS);
        TEST_ASSERT_TRUE(bitten());
    }
}

/* 21.3.1 */
static void test_the_option_byte_starts_it_at_a_reset(void)
{
    restart(RESET_SOFTWARE);
    pass(2u * 4096u * COUNT_NS);
    TEST_ASSERT_FALSE(bitten());
    b->around.hardware_watchdog = true;
    restart(RESET_SOFTWARE);
    pass(4095u * COUNT_NS);
    TEST_ASSERT_FALSE(bitten());
    pass(2u * COUNT_NS);
    TEST_ASSERT_TRUE(bitten());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bytes_leave_one_after_another_at_the_rate_of_the_divider);
    RUN_TEST(test_the_end_of_sending_is_cleared_in_its_order);
    RUN_TEST(test_a_byte_that_nobody_takes_is_kept_and_the_next_is_lost);
    RUN_TEST(test_each_enable_bit_has_its_flag);
    RUN_TEST(test_another_rate_gives_framing_errors);
    RUN_TEST(test_without_its_pin_or_its_receiver_nothing_comes);
    RUN_TEST(test_what_the_port_refuses);
    RUN_TEST(test_the_watchdog_bites_at_the_end_of_its_count);
    RUN_TEST(test_values_are_taken_with_the_key_and_after_five_periods);
    RUN_TEST(test_the_time_is_the_divider_and_the_count);
    RUN_TEST(test_the_option_byte_starts_it_at_a_reset);
    board_free(b);
    return UNITY_END();
}
