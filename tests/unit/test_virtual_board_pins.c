/* Pins of the STM32F405 and the world around them, asked register by register. */
#include "board_registers.h"

#define PIN(port, number) ((unsigned)((port) - 'A') * 16u + (number))

static struct {
    unsigned pin, times;
    enum pin_drive drive;
    uint64_t ns;
} seen;

static void pin_driven(void *context, uint64_t now_ns, unsigned pin, enum pin_drive drive)
{
    (void)context;
    seen.pin = pin;
    seen.drive = drive;
    seen.ns = now_ns;
    seen.times++;
}

void setUp(void)
{
    const struct surroundings around = usual(&chip_stm32f405, 8000000);
    const struct world world = {.pin_driven = pin_driven};
    start_board(&chip_stm32f405, &around, empty_image, sizeof empty_image);
    board_set_world(b, &world);
    put_ok(RCC_AHB1ENR, RCC_AHB1ENR_CCM | RCC_AHB1ENR_GPIO(1) | RCC_AHB1ENR_GPIO(3));
    seen.times = 0;
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

static void expect_seen(unsigned times, unsigned pin, enum pin_drive drive)
{
    TEST_ASSERT_EQUAL(times, seen.times);
    TEST_ASSERT_EQUAL(pin, seen.pin);
    TEST_ASSERT_EQUAL(drive, seen.drive);
}

static void test_the_world_is_told_each_change_of_an_output_once_and_when(void)
{
    put_ok(GPIO_BSRR(1), BIT(0)); /* an input still */
    TEST_ASSERT_EQUAL(0, seen.times);
    put_ok(GPIO_MODER(1), 0x280u | 1u);
    expect_seen(1, PIN('B', 0), PIN_HIGH);
    pass(1000);
    put_ok(GPIO_BSRR(1), BIT(16));
    expect_seen(2, PIN('B', 0), PIN_LOW);
    TEST_ASSERT_EQUAL(board_ns(b), seen.ns);
    put_ok(GPIO_BSRR(1), BIT(16));
    TEST_ASSERT_EQUAL(2, seen.times);
    put_ok(GPIO_OTYPER(1), 1u);
    put_ok(GPIO_BSRR(1), BIT(0)); /* an open drain lets go */
    expect_seen(3, PIN('B', 0), PIN_FLOATS);
    put_ok(GPIO_PUPDR(1), 0x100u | 1u);
    expect_seen(4, PIN('B', 0), PIN_PULLED_UP);
    put_ok(GPIO_MODER(1), 0x280u | 2u);
    expect_seen(5, PIN('B', 0), PIN_OF_BUS);
}

static void test_an_input_reads_its_wire_and_without_one_its_pull(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIO_IDR(3)));
    put_ok(GPIO_PUPDR(3), 1u << 4);
    TEST_ASSERT_EQUAL_HEX32(BIT(2), get(GPIO_IDR(3)));
    board_set_pin(b, PIN('D', 2), PIN_LEVEL_LOW);
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIO_IDR(3)));
    put_ok(GPIO_PUPDR(3), 2u << 4);
    board_set_pin(b, PIN('D', 2), PIN_LEVEL_HIGH);
    TEST_ASSERT_EQUAL_HEX32(BIT(2), get(GPIO_IDR(3)));
    board_set_pin(b, PIN('D', 2), PIN_LEVEL_OPEN);
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIO_IDR(3)));
}

static void test_an_analogue_pin_reads_low(void)
{
    board_set_pin(b, PIN('D', 2), PIN_LEVEL_HIGH);
    put_ok(GPIO_MODER(3), 3u << 4);
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIO_IDR(3)));
}

static void test_an_output_reads_itself_whatever_is_wired(void)
{
    board_set_pin(b, PIN('D', 2), PIN_LEVEL_HIGH);
    put_ok(GPIO_MODER(3), 1u << 4);
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIO_IDR(3)));
    put_ok(GPIO_OTYPER(3), BIT(2));
    put_ok(GPIO_BSRR(3), BIT(2)); /* an open drain that lets go reads the wire */
    TEST_ASSERT_EQUAL_HEX32(BIT(2), get(GPIO_IDR(3)));
}

static void test_a_reset_lets_go_of_all_pins(void)
{
    put_ok(GPIO_MODER(3), 1u << 4);
    expect_seen(1, PIN('D', 2), PIN_LOW);
    restart(RESET_PIN);
    expect_seen(2, PIN('D', 2), PIN_FLOATS);
}

/* 7.3.8, 7.3.9 */
static void test_a_part_that_is_held_in_reset_is_not_there_and_comes_back_as_new(void)
{
    const uint32_t spi1 = 0x40013000u;
    put_ok(RCC_APB2ENR, BIT(12));
    put_ok(SPI_CR1(spi1), SPI_CR1_MSTR);
    put_ok(RCC_APB2RSTR, BIT(12));
    (void)get(SPI_CR1(spi1));
    expect_verdict("which the RCC holds in reset");
    put_ok(RCC_APB2RSTR, 0);
    TEST_ASSERT_EQUAL_HEX32(0, get(SPI_CR1(spi1)));
    put(RCC_APB2RSTR, BIT(4));
    expect_verdict("a reset of USART1 alone is not modelled");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_world_is_told_each_change_of_an_output_once_and_when);
    RUN_TEST(test_an_input_reads_its_wire_and_without_one_its_pull);
    RUN_TEST(test_an_analogue_pin_reads_low);
    RUN_TEST(test_an_output_reads_itself_whatever_is_wired);
    RUN_TEST(test_a_reset_lets_go_of_all_pins);
    RUN_TEST(test_a_part_that_is_held_in_reset_is_not_there_and_comes_back_as_new);
    board_free(b);
    return UNITY_END();
}
