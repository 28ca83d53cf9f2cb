/* The serial port of a 1-wire bus of the STM32F405, asked register by register: UART4 on PA0, fed with 16 MHz. */
#include "board_registers.h"

#define BRR_RESET 1667u /* 9,600 baud */
#define BRR_BIT   139u  /* 115,200 */
#define ON        (USART_CR1_UE | USART_CR1_TE | USART_CR1_RE)
#define US        UINT64_C(1000)

static struct {
    unsigned bus, resets, bits;
    bool out;
    enum wire_answer answer;
} seen;

static enum wire_answer wire_reset(void *context, uint64_t now_ns, unsigned bus)
{
    (void)context;
    (void)now_ns;
    seen.bus = bus;
    seen.resets++;
    return seen.answer;
}

static enum wire_answer wire_bit(void *context, uint64_t now_ns, unsigned bus, bool out)
{
    (void)context;
    (void)now_ns;
    seen.bus = bus;
    seen.out = out;
    seen.bits++;
    return seen.answer;
}

void setUp(void)
{
    const struct surroundings around = usual(&chip_stm32f405, 8000000);
    const struct world world = {.wire_reset = wire_reset, .wire_bit = wire_bit};
    start_board(&chip_stm32f405, &around, empty_image, sizeof empty_image);
    board_set_world(b, &world);
    put_ok(RCC_AHB1ENR, RCC_AHB1ENR_CCM | RCC_AHB1ENR_GPIOA);
    put_ok(RCC_APB1ENR, BIT(19));
    put_ok(GPIOA_AFRL, 8u);
    put_ok(GPIO_OTYPER(0), 1u);
    put_ok(GPIOA_MODER, 0xA8000002u);
    put_ok(USART_CR3(UART4_BASE), USART_CR3_HDSEL);
    put_ok(USART_CR1(UART4_BASE), ON);
    memset(&seen, 0, sizeof seen);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

static uint32_t exchange(uint32_t brr, uint32_t byte)
{
    put_ok(USART_BRR(UART4_BASE), brr);
    put_ok(USART_DR(UART4_BASE), byte);
    pass(brr == BRR_BIT ? 90u * US : 1050u * US);
    TEST_ASSERT_EQUAL_HEX32(USART_SR_RXNE,
                            get(USART_SR(UART4_BASE)) & (USART_SR_RXNE | USART_SR_ORE));
    return get(USART_DR(UART4_BASE));
}

static void test_a_reset_pulse_is_heard_as_it_was_sent_but_where_a_chip_pulls(void)
{
    TEST_ASSERT_EQUAL_HEX8(0xF0, exchange(BRR_RESET, 0xF0));
    TEST_ASSERT_EQUAL(2, seen.bus);
    seen.answer = WIRE_PULLED; /* from 30 us to 150 us after the pulse: one bit of it */
    TEST_ASSERT_EQUAL_HEX8(0xE0, exchange(BRR_RESET, 0xF0));
    TEST_ASSERT_EQUAL(2, seen.resets);
    TEST_ASSERT_EQUAL(0, seen.bits);
}

static void test_bits_are_a_short_pulse_and_a_long_one(void)
{
    TEST_ASSERT_EQUAL_HEX8(0xFF, exchange(BRR_BIT, 0xFF));
    TEST_ASSERT_TRUE(seen.out);
    TEST_ASSERT_EQUAL_HEX8(0, exchange(BRR_BIT, 0));
    TEST_ASSERT_FALSE(seen.out);
    seen.answer = WIRE_PULLED; /* for 30 us: it has let go after two bits */
    TEST_ASSERT_EQUAL_HEX8(0xFC, exchange(BRR_BIT, 0xFF));
    TEST_ASSERT_EQUAL(3, seen.bits);
    TEST_ASSERT_EQUAL(0, get(USART_SR(UART4_BASE)) & USART_SR_FE);
}

static void test_a_shorted_wire_has_no_stop_bit(void)
{
    seen.answer = WIRE_SHORTED;
    put_ok(USART_BRR(UART4_BASE), BRR_BIT);
    put_ok(USART_DR(UART4_BASE), 0xFF);
    pass(90u * US);
    TEST_ASSERT_EQUAL_HEX32(USART_SR_RXNE | USART_SR_FE,
                            get(USART_SR(UART4_BASE)) & (USART_SR_RXNE | USART_SR_FE));
    TEST_ASSERT_EQUAL_HEX8(0, get(USART_DR(UART4_BASE)));
    TEST_ASSERT_EQUAL(0, get(USART_SR(UART4_BASE)) & (USART_SR_RXNE | USART_SR_FE));
}

static void test_a_byte_is_heard_before_it_has_ended(void)
{
    put_ok(USART_BRR(UART4_BASE), BRR_RESET);
    (void)get(USART_SR(UART4_BASE));
    put_ok(USART_DR(UART4_BASE), 0xF0);
    pass(980u * US);
    TEST_ASSERT_EQUAL(0, seen.resets);
    pass(20u * US);
    TEST_ASSERT_EQUAL_HEX32(USART_SR_RXNE,
                            get(USART_SR(UART4_BASE)) & (USART_SR_RXNE | USART_SR_TC));
    pass(50u * US);
    TEST_ASSERT_EQUAL_HEX32(USART_SR_RXNE | USART_SR_TC,
                            get(USART_SR(UART4_BASE)) & (USART_SR_RXNE | USART_SR_TC));
}

static void test_slots_follow_each_other_without_a_gap(void)
{
    put_ok(USART_BRR(UART4_BASE), BRR_BIT);
    put_ok(USART_DR(UART4_BASE), 0xFF);
    put_ok(USART_DR(UART4_BASE), 0xFF);
    put(USART_DR(UART4_BASE), 0xFF);
    expect_verdict("over one that was not sent");
    pass(85u * US);
    (void)get(USART_DR(UART4_BASE));
    TEST_ASSERT_EQUAL(1, seen.bits);
    pass(2u * US); /* the first has ended */
    pass(84u * US);
    TEST_ASSERT_EQUAL(2, seen.bits);
}

static void test_pulses_that_a_wire_does_not_know(void)
{
    put_ok(USART_BRR(UART4_BASE), BRR_RESET);
    put(USART_DR(UART4_BASE), 0xFE); /* 208 us */
    expect_verdict("on a 1-wire bus");
    pass(2000u * US);
    put_ok(USART_BRR(UART4_BASE), BRR_BIT);
    put(USART_DR(UART4_BASE), 0xFB);
    expect_verdict("0xfb makes two pulses in a slot");
}

static void test_the_baud_rate_stays_within_a_byte(void)
{
    put_ok(USART_BRR(UART4_BASE), BRR_RESET);
    put_ok(USART_DR(UART4_BASE), 0xF0);
    put(USART_BRR(UART4_BASE), BRR_BIT);
    expect_verdict("UART4_BRR changes within a byte");
}

static void test_it_sends_only_in_half_duplex_through_an_open_drain(void)
{
    put_ok(USART_BRR(UART4_BASE), BRR_BIT);
    put_ok(GPIO_OTYPER(0), 0);
    put(USART_DR(UART4_BASE), 0xFF);
    expect_verdict("UART4 sends while its pin is no open drain of its own");
    put_ok(USART_CR3(UART4_BASE), 0);
    put(USART_DR(UART4_BASE), 0xFF);
    expect_verdict("UART4, which is not on in half duplex");
    put(UART4_BASE + 0x10u, BIT(12)); /* CR2 */
    expect_verdict("0x1000 in register 0x10 of UART4 is not modelled");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_reset_pulse_is_heard_as_it_was_sent_but_where_a_chip_pulls);
    RUN_TEST(test_bits_are_a_short_pulse_and_a_long_one);
    RUN_TEST(test_a_shorted_wire_has_no_stop_bit);
    RUN_TEST(test_a_byte_is_heard_before_it_has_ended);
    RUN_TEST(test_slots_follow_each_other_without_a_gap);
    RUN_TEST(test_pulses_that_a_wire_does_not_know);
    RUN_TEST(test_the_baud_rate_stays_within_a_byte);
    RUN_TEST(test_it_sends_only_in_half_duplex_through_an_open_drain);
    board_free(b);
    return UNITY_END();
}
