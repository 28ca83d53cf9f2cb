/* I2C of the STM32F405, asked register by register: I2C1 on PB6 and PB7, fed with 16 MHz, 100 kHz. */
#include "board_registers.h"

#define I2C1   0x40005400u
#define BYTE   UINT64_C(95000) /* ns: nine bits, and some */
#define CLOCK  6u
#define DATA   7u
#define ON     I2C_CR1_PE
#define EVENTS (I2C_SR1_SB | I2C_SR1_ADDR | I2C_SR1_BTF | I2C_SR1_RXNE | BIT(7) | I2C_SR1_AF)
#define TXE    BIT(7)

static struct {
    uint8_t address, written, next;
    bool read, acknowledges, acknowledged;
    unsigned starts, writes, reads, stops, clocks, held;
} seen;

static bool address(void *context, uint64_t now_ns, unsigned bus, uint8_t with, bool read)
{
    (void)context;
    (void)now_ns;
    TEST_ASSERT_EQUAL(1, bus);
    seen.address = with;
    seen.read = read;
    seen.starts++;
    return seen.acknowledges;
}

static bool take(void *context, uint64_t now_ns, unsigned bus, uint8_t byte)
{
    (void)context;
    (void)now_ns;
    (void)bus;
    seen.written = byte;
    seen.writes++;
    return seen.acknowledges;
}

static uint8_t give(void *context, uint64_t now_ns, unsigned bus, bool acknowledged)
{
    (void)context;
    (void)now_ns;
    (void)bus;
    seen.acknowledged = acknowledged;
    seen.reads++;
    return seen.next++;
}

static void stopped(void *context, uint64_t now_ns, unsigned bus)
{
    (void)context;
    (void)now_ns;
    (void)bus;
    seen.stops++;
}

static unsigned held(void *context, uint64_t now_ns, unsigned bus)
{
    (void)context;
    (void)now_ns;
    return bus == 1 ? seen.held : 0;
}

static void clocked(void *context, uint64_t now_ns, unsigned bus)
{
    (void)context;
    (void)now_ns;
    (void)bus;
    seen.clocks++;
}

void setUp(void)
{
    const struct surroundings around = usual(&chip_stm32f405, 8000000);
    const struct world world = {.i2c_address = address,
                                .i2c_write = take,
                                .i2c_read = give,
                                .i2c_stop = stopped,
                                .i2c_held = held,
                                .i2c_clock = clocked};
    memset(&seen, 0, sizeof seen);
    start_board(&chip_stm32f405, &around, empty_image, sizeof empty_image);
    board_set_world(b, &world);
    put_ok(RCC_AHB1ENR, RCC_AHB1ENR_CCM | RCC_AHB1ENR_GPIO(1));
    put_ok(RCC_APB1ENR, BIT(21));
    put_ok(GPIO_OTYPER(1), BIT(CLOCK) | BIT(DATA));
    put_ok(GPIO_AFR(1, 0), 0x44000000u);
    put_ok(GPIO_MODER(1), 0x280u | 2u << 2 * CLOCK | 2u << 2 * DATA);
    put_ok(I2C_CR2(I2C1), 16u);
    put_ok(I2C_CCR(I2C1), 80u);
    put_ok(I2C_TRISE(I2C1), 17u);
    put_ok(I2C_CR1(I2C1), ON);
    seen.acknowledges = true;
    seen.next = 0x40;
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

static void steps(uint64_t ns)
{
    for (uint64_t i = 0; i < ns; i += 1000) /* events come when they are due, not all at the end */
        pass(1000);
}

static uint32_t events(void)
{
    return get(I2C_SR1(I2C1)) & EVENTS;
}

/* Up to where the address has been acknowledged, and not looked at. */
static void addressed(uint8_t with, uint32_t cr1)
{
    put_ok(I2C_CR1(I2C1), cr1 | I2C_CR1_START);
    steps(15000);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_SB, events());
    put_ok(I2C_DR(I2C1), with);
    TEST_ASSERT_EQUAL_HEX32(0, events());
    steps(BYTE);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_ADDR, events());
}

static void look(void)
{
    (void)get(I2C_SR1(I2C1));
    (void)get(I2C_SR2(I2C1));
}

static uint32_t busy(void)
{
    return get(I2C_SR2(I2C1)) & I2C_SR2_BUSY;
}

static void test_bytes_go_out_and_the_clock_waits_for_the_program(void)
{
    addressed(0x90, ON);
    TEST_ASSERT_EQUAL_HEX8(0x48, seen.address);
    TEST_ASSERT_FALSE(seen.read);
    steps(500000);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_ADDR, events()); /* nothing goes on before somebody looks */
    look();
    TEST_ASSERT_EQUAL_HEX32(TXE, events());
    put_ok(I2C_DR(I2C1), 0x12);
    put_ok(I2C_DR(I2C1), 0x34);
    TEST_ASSERT_EQUAL_HEX32(0, events());
    steps(BYTE);
    TEST_ASSERT_EQUAL_HEX8(0x12, seen.written);
    TEST_ASSERT_EQUAL_HEX32(TXE, events());
    steps(BYTE);
    TEST_ASSERT_EQUAL_HEX8(0x34, seen.written);
    TEST_ASSERT_EQUAL_HEX32(TXE | I2C_SR1_BTF, events());
    TEST_ASSERT_EQUAL(I2C_SR2_BUSY, busy());
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_STOP);
    steps(10000);
    TEST_ASSERT_EQUAL(1, seen.stops);
    TEST_ASSERT_EQUAL_HEX32(0, events());
    TEST_ASSERT_EQUAL_HEX32(ON, get(I2C_CR1(I2C1)));
    TEST_ASSERT_EQUAL(0, busy());
}

/* RM0008 26.3.3: the byte is refused, and the stop follows it. */
static void test_one_byte_comes_in(void)
{
    addressed(0x91, ON | I2C_CR1_ACK);
    put_ok(I2C_CR1(I2C1), ON);
    look();
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_STOP);
    steps(2 * BYTE);
    TEST_ASSERT_EQUAL(1, seen.reads);
    TEST_ASSERT_FALSE(seen.acknowledged);
    TEST_ASSERT_EQUAL(1, seen.stops);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_RXNE, events());
    TEST_ASSERT_EQUAL_HEX8(0x40, get(I2C_DR(I2C1)));
    TEST_ASSERT_EQUAL_HEX32(0, events());
}

static void test_two_bytes_come_in_with_the_refusal_told_a_byte_ahead(void)
{
    addressed(0x91, ON | I2C_CR1_ACK | I2C_CR1_POS);
    look();
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_POS);
    steps(BYTE);
    TEST_ASSERT_TRUE(seen.acknowledged);
    steps(BYTE);
    TEST_ASSERT_FALSE(seen.acknowledged);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_RXNE | I2C_SR1_BTF, events());
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_STOP);
    TEST_ASSERT_EQUAL_HEX8(0x40, get(I2C_DR(I2C1)));
    TEST_ASSERT_EQUAL_HEX8(0x41, get(I2C_DR(I2C1)));
    steps(10000);
    TEST_ASSERT_EQUAL(2, seen.reads);
    TEST_ASSERT_EQUAL(1, seen.stops);
    TEST_ASSERT_EQUAL_HEX32(0, events());
}

static void test_the_refusal_a_byte_ahead_is_chosen_before_the_first_byte(void)
{
    addressed(0x91, ON | I2C_CR1_ACK);
    look();
    put(I2C_CR1(I2C1), ON | I2C_CR1_POS);
    expect_verdict("POS of I2C1 is set when a byte comes in already");
}

static void test_three_bytes_come_in_and_the_clock_waits_behind_the_second(void)
{
    addressed(0x91, ON | I2C_CR1_ACK);
    look();
    steps(5 * BYTE);
    TEST_ASSERT_EQUAL(2, seen.reads);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_RXNE | I2C_SR1_BTF, events());
    put_ok(I2C_CR1(I2C1), ON);
    TEST_ASSERT_EQUAL_HEX8(0x40, get(I2C_DR(I2C1)));
    steps(5 * BYTE);
    TEST_ASSERT_EQUAL(3, seen.reads);
    TEST_ASSERT_FALSE(seen.acknowledged);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_RXNE | I2C_SR1_BTF, events());
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_STOP);
    TEST_ASSERT_EQUAL_HEX8(0x41, get(I2C_DR(I2C1)));
    steps(10000);
    TEST_ASSERT_EQUAL_HEX8(0x42, get(I2C_DR(I2C1)));
    TEST_ASSERT_EQUAL_HEX32(0, events());
}

/* What the trap of a single byte does: the refusal comes too late, and one byte more is clocked. */
static void test_a_reception_that_is_not_ended_in_time_ends_the_run(void)
{
    addressed(0x91, ON);
    look();
    steps(BYTE);
    expect_verdict("I2C1 receives behind a byte that it has refused");
}

static void test_a_start_again_keeps_the_bus(void)
{
    addressed(0x90, ON);
    look();
    put_ok(I2C_DR(I2C1), 1);
    steps(BYTE);
    TEST_ASSERT_EQUAL_HEX32(TXE | I2C_SR1_BTF, events());
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_START | I2C_CR1_ACK);
    (void)get(I2C_DR(I2C1));
    TEST_ASSERT_EQUAL_HEX32(TXE, events()); /* BTF goes with a read */
    steps(15000);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_SB, events());
    put_ok(I2C_DR(I2C1), 0x91);
    steps(BYTE);
    TEST_ASSERT_EQUAL(2, seen.starts);
    TEST_ASSERT_EQUAL(0, seen.stops);
    TEST_ASSERT_TRUE(seen.read);
}

static void test_a_chip_that_refuses_is_told_and_the_bus_stays_taken_until_a_stop(void)
{
    seen.acknowledges = false;
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_START);
    steps(15000);
    (void)get(I2C_SR1(I2C1));
    put_ok(I2C_DR(I2C1), 0x90);
    steps(BYTE);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_AF, events());
    put_ok(I2C_SR1(I2C1), I2C_SR1_ERRORS & ~I2C_SR1_AF);
    TEST_ASSERT_EQUAL_HEX32(0, events());
    TEST_ASSERT_EQUAL(I2C_SR2_BUSY, busy());
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_STOP);
    steps(10000);
    TEST_ASSERT_EQUAL(1, seen.stops);
    TEST_ASSERT_EQUAL(0, busy());
}

static void test_a_clock_that_is_held_stops_everything(void)
{
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_START);
    steps(15000);
    (void)get(I2C_SR1(I2C1));
    put_ok(I2C_DR(I2C1), 0x90);
    seen.held = I2C_CLOCK_HELD;
    steps(10 * BYTE);
    TEST_ASSERT_EQUAL_HEX32(0, events());
    seen.held = 0;
    steps(15000);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_ADDR, events());
}

static void test_a_start_waits_for_a_free_bus(void)
{
    seen.held = I2C_DATA_HELD;
    TEST_ASSERT_EQUAL(I2C_SR2_BUSY, busy());
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_START);
    steps(10 * BYTE);
    TEST_ASSERT_EQUAL_HEX32(0, events());
    seen.held = 0;
    steps(15000);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_SB, events());
}

static void test_a_data_line_that_is_held_in_a_byte_is_a_lost_arbitration(void)
{
    addressed(0x90, ON);
    look();
    seen.held = I2C_DATA_HELD;
    put_ok(I2C_DR(I2C1), 0x01);
    steps(BYTE);
    TEST_ASSERT_EQUAL_HEX32(I2C_SR1_ARLO, get(I2C_SR1(I2C1)));
    TEST_ASSERT_EQUAL(0, seen.writes);
}

static void test_only_a_reset_of_the_part_frees_a_busy_of_a_glitch(void)
{
    i2c_lock_busy(b, 1);
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_START);
    steps(10 * BYTE);
    TEST_ASSERT_EQUAL(I2C_SR2_BUSY, busy());
    TEST_ASSERT_EQUAL_HEX32(0, events());
    put_ok(I2C_CR1(I2C1), I2C_CR1_SWRST);
    TEST_ASSERT_EQUAL(0, busy());
    TEST_ASSERT_EQUAL_HEX32(0, get(I2C_CCR(I2C1)));
}

static void test_what_a_program_must_not_do(void)
{
    put_ok(I2C_CR1(I2C1), ON | I2C_CR1_START);
    put(I2C_CR1(I2C1), ON);
    expect_verdict("write of I2C1_CR1 while a start or a stop waits");
    steps(15000);
    put(I2C_CR1(I2C1), ON | BIT(1));
    expect_verdict("is not modelled");
    put_ok(I2C_CR1(I2C1), 0);
    put_ok(I2C_CR1(I2C1), ON);
    put(I2C_DR(I2C1), 1);
    expect_verdict("a byte written to I2C1_DR when none is awaited");
    put(I2C_CR1(I2C1), ON | I2C_CR1_STOP);
    expect_verdict("I2C1 is told to stop when nothing runs");
    put_ok(I2C_CR1(I2C1), I2C_CR1_SWRST);
    put_ok(I2C_CR1(I2C1), 0);
    put_ok(I2C_CR2(I2C1), 16u);
    put_ok(I2C_CCR(I2C1), 70u); /* 114 kHz */
    put_ok(I2C_CR1(I2C1), ON);
    put(I2C_CCR(I2C1), 80u);
    expect_verdict("the clock of I2C1 changes while the part is on");
    put_ok(I2C_CR1(I2C1), 0);
    put_ok(I2C_CCR(I2C1), 70u);
    put(I2C_CR1(I2C1), ON | I2C_CR1_START);
    expect_verdict("at most 100 kHz");
    put_ok(I2C_CR1(I2C1), I2C_CR1_SWRST);
    put_ok(I2C_CR1(I2C1), 0);
    put_ok(I2C_CCR(I2C1), 80u);
    put(I2C_CR1(I2C1), ON | I2C_CR1_START); /* CR2 and TRISE are as after a reset */
    expect_verdict("do not fit a bus of 16000000 Hz");
    put_ok(I2C_CR1(I2C1), I2C_CR1_SWRST);
    put_ok(I2C_CR1(I2C1), 0);
    put_ok(I2C_CR2(I2C1), 16u);
    put_ok(I2C_CCR(I2C1), 80u);
    put_ok(I2C_TRISE(I2C1), 17u);
    put_ok(GPIO_OTYPER(1), 0);
    put(I2C_CR1(I2C1), ON | I2C_CR1_START);
    expect_verdict("I2C1 starts while its pins are no open drains of its own");
}

static void test_pins_moved_by_hand_are_clocks_and_stops(void)
{
    put_ok(GPIO_BSRR(1), BIT(CLOCK) | BIT(DATA));
    put_ok(GPIO_PUPDR(1), 0x100u | 1u << 2 * CLOCK | 1u << 2 * DATA);
    put_ok(GPIO_MODER(1), 0x280u | 1u << 2 * CLOCK | 1u << 2 * DATA);
    seen.held = I2C_DATA_HELD;
    TEST_ASSERT_EQUAL_HEX32(BIT(CLOCK), get(GPIO_IDR(1)) & (BIT(CLOCK) | BIT(DATA)));
    put_ok(GPIO_BSRR(1), BIT(CLOCK + 16));
    TEST_ASSERT_EQUAL(0, seen.clocks);
    put_ok(GPIO_BSRR(1), BIT(CLOCK));
    TEST_ASSERT_EQUAL(1, seen.clocks);
    seen.held = 0;
    TEST_ASSERT_EQUAL_HEX32(BIT(CLOCK) | BIT(DATA), get(GPIO_IDR(1)) & (BIT(CLOCK) | BIT(DATA)));
    put_ok(GPIO_BSRR(1), BIT(DATA + 16));
    put_ok(GPIO_BSRR(1), BIT(DATA));
    TEST_ASSERT_EQUAL(1, seen.stops);
    put_ok(GPIO_BSRR(1), BIT(CLOCK + 16));
    put_ok(GPIO_BSRR(1), BIT(DATA + 16));
    put_ok(GPIO_BSRR(1), BIT(DATA)); /* a bit, while the clock is low */
    TEST_ASSERT_EQUAL(1, seen.stops);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bytes_go_out_and_the_clock_waits_for_the_program);
    RUN_TEST(test_one_byte_comes_in);
    RUN_TEST(test_two_bytes_come_in_with_the_refusal_told_a_byte_ahead);
    RUN_TEST(test_the_refusal_a_byte_ahead_is_chosen_before_the_first_byte);
    RUN_TEST(test_three_bytes_come_in_and_the_clock_waits_behind_the_second);
    RUN_TEST(test_a_reception_that_is_not_ended_in_time_ends_the_run);
    RUN_TEST(test_a_start_again_keeps_the_bus);
    RUN_TEST(test_a_chip_that_refuses_is_told_and_the_bus_stays_taken_until_a_stop);
    RUN_TEST(test_a_clock_that_is_held_stops_everything);
    RUN_TEST(test_a_start_waits_for_a_free_bus);
    RUN_TEST(test_a_data_line_that_is_held_in_a_byte_is_a_lost_arbitration);
    RUN_TEST(test_only_a_reset_of_the_part_frees_a_busy_of_a_glitch);
    RUN_TEST(test_what_a_program_must_not_do);
    RUN_TEST(test_pins_moved_by_hand_are_clocks_and_stops);
    board_free(b);
    return UNITY_END();
}
