/* Pins of the STM32F100, what is wired to them, and the buses at them, asked register by register. The core runs from 8 MHz here.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "board_registers.h"

#define PIN(port, number)   ((unsigned)((port) - 'A') * 16u + (number))
#define SPI1                0x40013000u
#define MASTER              (SPI_CR1_MSTR | SPI_CR1_SSM | SPI_CR1_SSI)
#define SPI1_CLOCK          BIT(12)
#define USART3_CLOCK        BIT(18)
#define CR_OF(pin, setting) ((uint32_t)(setting) << 4 * ((pin) % 8u))
#define FLOATING_ALL        0x44444444u

enum {
    ANALOG = 0,
    OUTPUT = 2,
    FLOATING = 4,
    OPEN_DRAIN = 6,
    PULLED = 8,
    FAST = 9,
    BUS_SLOW = 0xA,
    BUS_DRAIN = 0xE
};

static struct {
    unsigned pin, times;
    enum pin_drive drive;
    unsigned bytes, resets;
    uint8_t out;
} seen;

static void pin_driven(void *context, uint64_t now_ns, unsigned pin, enum pin_drive drive)
{
    (void)context;
    (void)now_ns;
    seen.pin = pin;
    seen.drive = drive;
    seen.times++;
}

static uint8_t spi_exchange(void *context, uint64_t now_ns, unsigned bus, unsigned mode,
                            uint8_t out)
{
    (void)context;
    (void)now_ns;
    (void)bus;
    (void)mode;
    seen.bytes++;
    seen.out = out;
    return 0x5A;
}

static enum wire_answer wire_reset(void *context, uint64_t now_ns, unsigned bus)
{
    (void)context;
    (void)now_ns;
    seen.resets += bus == 1 ? 1u : 0;
    return WIRE_PULLED;
}

void setUp(void)
{
    const struct surroundings around = usual(&chip_stm32f100, 8000000);
    const struct world world = {
        .pin_driven = pin_driven, .spi_exchange = spi_exchange, .wire_reset = wire_reset};
    start_board(&chip_stm32f100, &around, empty_image, sizeof empty_image);
    board_set_world(b, &world);
    put_ok(RCC_APB2ENR, RCC_APB2ENR_IO(0) | RCC_APB2ENR_IO(1) | SPI1_CLOCK);
    put_ok(RCC_APB1ENR, USART3_CLOCK);
    memset(&seen, 0, sizeof seen);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

/* Sets one pin of GPIOB, and leaves the others floating. */
static void set_pin(unsigned pin, unsigned setting)
{
    put_ok(GPIO_CR(1, pin / 8u), (FLOATING_ALL & ~CR_OF(pin, 15u)) | CR_OF(pin, setting));
}

static void expect_seen(unsigned times, unsigned pin, enum pin_drive drive)
{
    TEST_ASSERT_EQUAL(times, seen.times);
    TEST_ASSERT_EQUAL(pin, seen.pin);
    TEST_ASSERT_EQUAL(drive, seen.drive);
}

static void test_the_world_is_told_each_change_of_what_a_pin_drives(void)
{
    put_ok(GPIO_BSRR(1), BIT(9)); /* an input still */
    TEST_ASSERT_EQUAL(0, seen.times);
    set_pin(9, OUTPUT);
    expect_seen(1, PIN('B', 9), PIN_HIGH);
    put_ok(GPIO_BSRR(1), BIT(9 + 16));
    expect_seen(2, PIN('B', 9), PIN_LOW);
    put_ok(GPIO_BSRR(1), BIT(9 + 16));
    TEST_ASSERT_EQUAL(2, seen.times);
    set_pin(9, PULLED);
    expect_seen(3, PIN('B', 9), PIN_PULLED_DOWN);
    put_ok(GPIO_BSRR(1), BIT(9));
    expect_seen(4, PIN('B', 9), PIN_PULLED_UP);
    set_pin(9, OPEN_DRAIN);
    expect_seen(5, PIN('B', 9), PIN_FLOATS);
    set_pin(9, BUS_DRAIN);
    expect_seen(6, PIN('B', 9), PIN_OF_BUS);
}

static void test_a_reset_lets_go_of_all_pins(void)
{
    set_pin(1, OUTPUT);
    expect_seen(1, PIN('B', 1), PIN_LOW);
    restart(RESET_PIN);
    expect_seen(2, PIN('B', 1), PIN_FLOATS);
}

static void test_an_input_reads_its_wire_and_without_one_its_pull(void)
{
    put_ok(GPIO_BSRR(1), BIT(9));
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIO_IDR(1)));
    set_pin(9, PULLED);
    TEST_ASSERT_EQUAL_HEX32(BIT(9), get(GPIO_IDR(1)));
    board_set_pin(b, PIN('B', 9), PIN_LEVEL_LOW);
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIO_IDR(1)));
    set_pin(9, FLOATING);
    board_set_pin(b, PIN('B', 9), PIN_LEVEL_HIGH);
    TEST_ASSERT_EQUAL_HEX32(BIT(9), get(GPIO_IDR(1)));
    set_pin(9, ANALOG);
    TEST_ASSERT_EQUAL_HEX32(0, get(GPIO_IDR(1)));
}

static void test_a_wire_at_a_port_that_the_chip_lacks_is_nothing(void)
{
    board_set_pin(b, PIN('D', 2), PIN_LEVEL_HIGH);
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

/* Settings of PA5, PA6 and PA7. */
static void spi_pins(unsigned clock, unsigned in, unsigned out)
{
    put_ok(GPIO_CR(0, 0),
           (FLOATING_ALL & 0x000FFFFFu) | CR_OF(5, clock) | CR_OF(6, in) | CR_OF(7, out));
}

static void spi_on(unsigned divider)
{
    put_ok(SPI_CR1(SPI1), MASTER | SPI_CR1_BR(divider));
    put_ok(SPI_CR1(SPI1), MASTER | SPI_CR1_BR(divider) | SPI_CR1_SPE);
}

static void test_a_byte_goes_each_way_over_spi(void)
{
    spi_pins(FAST, PULLED, FAST);
    spi_on(2); /* 1 MHz */
    put_ok(SPI_DR(SPI1), 0x9C);
    pass(8000);
    TEST_ASSERT_EQUAL(1, seen.bytes);
    TEST_ASSERT_EQUAL_HEX8(0x9C, seen.out);
    TEST_ASSERT_EQUAL_HEX8(0x5A, get(SPI_DR(SPI1)));
}

static void test_what_comes_in_over_spi_must_be_an_input(void)
{
    spi_pins(FAST, FAST, FAST);
    spi_on(2);
    put(SPI_DR(SPI1), 1);
    expect_verdict("SPI1 sends while its pins are given to others");
    spi_pins(FAST, PULLED, OUTPUT);
    put(SPI_DR(SPI1), 1);
    expect_verdict("SPI1 sends while its pins are given to others");
}

static void test_a_clock_is_no_faster_than_its_pin(void)
{
    spi_pins(BUS_SLOW, PULLED, BUS_SLOW);
    spi_on(0); /* 4 MHz, of a pin for 2 MHz */
    put(SPI_DR(SPI1), 1);
    expect_verdict("SPI1 sends faster than the edges of its clock's pin");
}

/* RM0041 6.3.4 */
static void test_a_part_that_was_held_in_reset_comes_back_as_new(void)
{
    put_ok(SPI_CR1(SPI1), MASTER);
    put_ok(RCC_APB2RSTR, SPI1_CLOCK);
    (void)get(SPI_CR1(SPI1));
    expect_verdict("which the RCC holds in reset");
    put_ok(RCC_APB2RSTR, 0);
    TEST_ASSERT_EQUAL_HEX32(0, get(SPI_CR1(SPI1)));
}

static void send_reset_pulse(void)
{
    put_ok(USART_CR3(USART3_BASE), USART_CR3_HDSEL);
    put_ok(USART_BRR(USART3_BASE), 833); /* 9,600 baud of 8 MHz */
    put_ok(USART_CR1(USART3_BASE), USART_CR1_UE | USART_CR1_TE | USART_CR1_RE);
    put(USART_DR(USART3_BASE), 0xF0);
}

static void test_a_chip_answers_the_reset_pulse_of_the_1_wire_bus(void)
{
    set_pin(10, BUS_DRAIN);
    send_reset_pulse();
    pass(1100000);
    TEST_ASSERT_EQUAL(1, seen.resets);
    TEST_ASSERT_NOT_EQUAL(0, get(USART_SR(USART3_BASE)) & USART_SR_RXNE);
    TEST_ASSERT_NOT_EQUAL(0xF0, get(USART_DR(USART3_BASE)));
}

static void test_a_1_wire_bus_must_be_an_open_drain(void)
{
    set_pin(10, BUS_SLOW);
    send_reset_pulse();
    expect_verdict("USART3 sends while its pin is no open drain of its own");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_world_is_told_each_change_of_what_a_pin_drives);
    RUN_TEST(test_a_reset_lets_go_of_all_pins);
    RUN_TEST(test_an_input_reads_its_wire_and_without_one_its_pull);
    RUN_TEST(test_a_wire_at_a_port_that_the_chip_lacks_is_nothing);
    RUN_TEST(test_a_byte_goes_each_way_over_spi);
    RUN_TEST(test_what_comes_in_over_spi_must_be_an_input);
    RUN_TEST(test_a_clock_is_no_faster_than_its_pin);
    RUN_TEST(test_a_part_that_was_held_in_reset_comes_back_as_new);
    RUN_TEST(test_a_chip_answers_the_reset_pulse_of_the_1_wire_bus);
    RUN_TEST(test_a_1_wire_bus_must_be_an_open_drain);
    board_free(b);
    return UNITY_END();
}
