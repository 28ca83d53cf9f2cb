/* SPI of the STM32F405, asked register by register. The bus runs from 16 MHz here: a bit of the fastest clock lasts 125 ns. */
#include "board_registers.h"

#define SPI1     0x40013000u
#define SPI1_IRQ 35u
#define MASTER   (SPI_CR1_MSTR | SPI_CR1_SSM | SPI_CR1_SSI)
#define BIT_NS   125u

static struct {
    unsigned bus, mode, times;
    uint8_t out, answer;
    uint64_t ns;
} seen;

static uint8_t spi_exchange(void *context, uint64_t now_ns, unsigned bus, unsigned mode,
                            uint8_t out)
{
    (void)context;
    seen.bus = bus;
    seen.mode = mode;
    seen.out = out;
    seen.ns = now_ns;
    seen.times++;
    return seen.answer++;
}

void setUp(void)
{
    const struct surroundings around = usual(&chip_stm32f405, 8000000);
    const struct world world = {.spi_exchange = spi_exchange};
    start_board(&chip_stm32f405, &around, empty_image, sizeof empty_image);
    board_set_world(b, &world);
    put_ok(RCC_AHB1ENR, RCC_AHB1ENR_CCM | RCC_AHB1ENR_GPIOA);
    put_ok(RCC_APB2ENR, BIT(12));
    put_ok(GPIOA_AFRL, 0x55500000u);
    put_ok(GPIO_OSPEEDR(0), 0x0C000000u | 1u << 10);
    put_ok(GPIOA_MODER, 0xA800A800u);
    seen.times = 0;
    seen.answer = 0x40;
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

static void on(uint32_t with)
{
    put_ok(SPI_CR1(SPI1), MASTER | with);
    put_ok(SPI_CR1(SPI1), MASTER | with | SPI_CR1_SPE);
}

/* Asleep: what a test asks for by itself does not count as an interrupt taken. */
static bool asks(void)
{
    return (get(NVIC_ISER(1) + 0x100u) >> (SPI1_IRQ - 32u) & 1u) != 0; /* ISPR */
}

static void test_a_byte_goes_each_way_in_eight_bits_of_its_clock(void)
{
    on(SPI_CR1_BR(2)); /* 2 MHz */
    uint64_t from = board_ns(b);
    put_ok(SPI_DR(SPI1), 0x9C);
    TEST_ASSERT_EQUAL_HEX32(2u | SPI_SR_BSY, get(SPI_SR(SPI1))); /* TXE: the buffer is free again */
    pass(4 * BIT_NS * 7);
    TEST_ASSERT_EQUAL(0, seen.times);
    pass(4 * BIT_NS);
    TEST_ASSERT_EQUAL(1, seen.times);
    TEST_ASSERT_EQUAL(1, seen.bus);
    TEST_ASSERT_EQUAL(0, seen.mode);
    TEST_ASSERT_EQUAL_HEX8(0x9C, seen.out);
    TEST_ASSERT_EQUAL_HEX32(SPI_SR_RXNE | 2u, get(SPI_SR(SPI1)));
    TEST_ASSERT_EQUAL_HEX8(0x40, get(SPI_DR(SPI1)));
    TEST_ASSERT_EQUAL_HEX32(2u, get(SPI_SR(SPI1)));
    TEST_ASSERT_UINT64_WITHIN(2, from + 4 * BIT_NS * 8, board_ns(b));
}

/* The last byte has come in before its clock rests. */
static void test_busy_ends_half_a_period_after_the_last_sample(void)
{
    for (unsigned mode = 0; mode < 4; mode++) {
        on(SPI_CR1_BR(2) | mode);
        put_ok(SPI_DR(SPI1), 1);
        pass(4 * BIT_NS * 15 / 2 + (mode & 1u) * 4 * BIT_NS / 2 + 1);
        TEST_ASSERT_EQUAL(mode, seen.mode);
        TEST_ASSERT_EQUAL_HEX32(SPI_SR_RXNE | 2u | SPI_SR_BSY, get(SPI_SR(SPI1)));
        pass(4 * BIT_NS / 2);
        TEST_ASSERT_EQUAL_HEX32(SPI_SR_RXNE | 2u, get(SPI_SR(SPI1)));
        (void)get(SPI_DR(SPI1));
        put_ok(SPI_CR1(SPI1), 0);
    }
}

static void test_two_bytes_follow_each_other_without_a_gap(void)
{
    on(0);
    put_ok(SPI_DR(SPI1), 1);
    put_ok(SPI_DR(SPI1), 2);
    TEST_ASSERT_EQUAL_HEX32(SPI_SR_BSY, get(SPI_SR(SPI1)));
    put(SPI_DR(SPI1), 3);
    expect_verdict("a byte written to SPI1_DR over one that was not sent");
    pass(8 * BIT_NS);
    TEST_ASSERT_EQUAL_HEX8(0x40, get(SPI_DR(SPI1)));
    TEST_ASSERT_EQUAL_HEX32(2u | SPI_SR_BSY, get(SPI_SR(SPI1)));
    pass(8 * BIT_NS);
    TEST_ASSERT_EQUAL_HEX8(2, seen.out);
    TEST_ASSERT_EQUAL_HEX8(0x41, get(SPI_DR(SPI1)));
}

static void test_a_byte_that_nobody_has_read_is_kept_and_the_next_one_lost(void)
{
    on(0);
    for (unsigned i = 0; i < 2; i++) {
        put_ok(SPI_DR(SPI1), i);
        pass(9 * BIT_NS);
    }
    TEST_ASSERT_EQUAL_HEX32(BIT(6) | SPI_SR_RXNE | 2u, get(SPI_SR(SPI1))); /* OVR */
    TEST_ASSERT_EQUAL_HEX8(0x40, get(SPI_DR(SPI1)));
    TEST_ASSERT_EQUAL_HEX32(BIT(6) | 2u, get(SPI_SR(SPI1))); /* after the data register: it goes */
    TEST_ASSERT_EQUAL_HEX32(2u, get(SPI_SR(SPI1)));
}

static void test_it_interrupts_while_a_byte_waits_to_be_read(void)
{
    put_ok(SPI_CR2(SPI1), SPI_CR2_RXNEIE);
    on(0);
    put_ok(SPI_DR(SPI1), 1);
    TEST_ASSERT_FALSE(asks());
    pass(9 * BIT_NS);
    TEST_ASSERT_TRUE(asks());
    (void)get(SPI_DR(SPI1));
    TEST_ASSERT_FALSE(asks());
}

static void test_what_a_program_must_not_do(void)
{
    put(SPI_DR(SPI1), 1);
    expect_verdict("a byte written to SPI1 while it is off");
    put(SPI_CR1(SPI1), SPI_CR1_MSTR | SPI_CR1_SPE);
    expect_verdict("only a master without an NSS pin is modelled");
    put_ok(SPI_CR1(SPI1), 0);
    on(0);
    put(SPI_CR1(SPI1), MASTER | SPI_CR1_SPE | 1u);
    expect_verdict("changes the frame while the part is on");
    put_ok(SPI_CR1(SPI1), 0);
    on(0);
    put_ok(SPI_DR(SPI1), 1);
    put(SPI_CR1(SPI1), MASTER);
    expect_verdict("SPI1 is switched off while it is busy");
    put(SPI_CR1(SPI1), BIT(11));
    expect_verdict("is not modelled");
    put(SPI_CR2(SPI1), BIT(1)); /* DMA */
    expect_verdict("SPI1_CR2 of 0x2 is not modelled");
}

static void test_it_does_not_send_while_a_pin_is_given_to_others(void)
{
    put_ok(GPIOA_MODER, 0xA8008800u);
    on(0);
    put(SPI_DR(SPI1), 1);
    expect_verdict("SPI1 sends while its pins are given to others");
}

static void test_a_fast_clock_wants_fast_edges(void)
{
    put_ok(GPIO_OSPEEDR(0), 0x0C000000u);
    on(SPI_CR1_BR(1)); /* 4 MHz */
    put_ok(SPI_DR(SPI1), 1);
    pass(20 * BIT_NS);
    put_ok(SPI_CR1(SPI1), 0);
    on(0);
    put(SPI_DR(SPI1), 1);
    expect_verdict("SPI1 sends faster than the edges of its clock's pin");
}

static void test_a_reset_of_the_part_ends_a_byte(void)
{
    on(0);
    put_ok(SPI_DR(SPI1), 1);
    put_ok(RCC_APB2RSTR, BIT(12));
    put_ok(RCC_APB2RSTR, 0);
    pass(20 * BIT_NS);
    TEST_ASSERT_EQUAL(0, seen.times);
    TEST_ASSERT_EQUAL_HEX32(2u, get(SPI_SR(SPI1)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_byte_goes_each_way_in_eight_bits_of_its_clock);
    RUN_TEST(test_busy_ends_half_a_period_after_the_last_sample);
    RUN_TEST(test_two_bytes_follow_each_other_without_a_gap);
    RUN_TEST(test_a_byte_that_nobody_has_read_is_kept_and_the_next_one_lost);
    RUN_TEST(test_it_interrupts_while_a_byte_waits_to_be_read);
    RUN_TEST(test_what_a_program_must_not_do);
    RUN_TEST(test_it_does_not_send_while_a_pin_is_given_to_others);
    RUN_TEST(test_a_fast_clock_wants_fast_edges);
    RUN_TEST(test_a_reset_of_the_part_ends_a_byte);
    board_free(b);
    return UNITY_END();
}
