/* Edges at pins, pulse widths and the converter of the STM32F405, asked register by register. All run from 16 MHz. */
#include "board_registers.h"

#define PIN(port, number) ((unsigned)((port) - 'A') * 16u + (number))
#define TIM3              0x40000400u
#define EXTI_RTSR         (EXTI_FTSR - 4u)
#define US                UINT64_C(1000)

static struct {
    unsigned pin, times;
    double hz, high, volts;
} seen;

static void pin_pulses(void *context, uint64_t now_ns, unsigned pin, double hz, double high)
{
    (void)context;
    (void)now_ns;
    seen.pin = pin;
    seen.hz = hz;
    seen.high = high;
    seen.times++;
}

static double pin_volts(void *context, uint64_t now_ns, unsigned pin)
{
    (void)context;
    (void)now_ns;
    seen.pin = pin;
    return seen.volts;
}

void setUp(void)
{
    const struct surroundings around = usual(&chip_stm32f405, 8000000);
    const struct world world = {.pin_pulses = pin_pulses, .pin_volts = pin_volts};
    memset(&seen, 0, sizeof seen);
    start_board(&chip_stm32f405, &around, empty_image, sizeof empty_image);
    board_set_world(b, &world);
    put_ok(RCC_AHB1ENR, RCC_AHB1ENR_CCM | RCC_AHB1ENR_GPIO(0) | RCC_AHB1ENR_GPIO(1));
    put_ok(RCC_APB1ENR, BIT(1));
    put_ok(RCC_APB2ENR, RCC_APB2ENR_ADC1 | RCC_APB2ENR_SYSCFG);
    seen.times = 0;
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

static bool asks(unsigned irq)
{
    return (get(NVIC_ISER(irq / 32u) + 0x100u) >> irq % 32u & 1u) != 0; /* ISPR */
}

/* ---- edges ---- */

/* The world pulls PB6 down in each second half of a millisecond. */
static enum pin_level half(void *context, uint64_t now_ns, unsigned pin)
{
    (void)context;
    return pin == PIN('B', 6) && now_ns / (500 * US) % 2 != 0 ? PIN_LEVEL_LOW : PIN_LEVEL_HIGH;
}

static uint64_t next_half(void *context, uint64_t now_ns)
{
    (void)context;
    return now_ns - now_ns % (500 * US) + 500 * US;
}

static void test_edges_that_the_world_makes_by_itself_are_pending_at_their_time(void)
{
    const struct world moving = {.pin_input = half, .next_edge = next_half};
    put_ok(SYSCFG_EXTICR(1), 1u << 8);
    put_ok(EXTI_FTSR, BIT(6));
    board_set_world(b, &moving);
    put_ok(EXTI_PR, BIT(6));
    uint64_t begin_ns = board_ns(b);
    for (unsigned n = 0; n < 5; n++) {
        uint64_t edge_ns = begin_ns - begin_ns % (1000 * US) + 1500 * US + n * 1000 * US;
        pass(edge_ns - 20 * US - board_ns(b));
        TEST_ASSERT_EQUAL_HEX32(0, get(EXTI_PR));
        pass(edge_ns + 20 * US - board_ns(b));
        TEST_ASSERT_EQUAL_HEX32(BIT(6), get(EXTI_PR));
        put_ok(EXTI_PR, BIT(6));
    }
}

static void test_an_edge_that_is_wanted_is_pending_until_it_is_cleared(void)
{
    board_set_pin(b, PIN('B', 6), PIN_LEVEL_HIGH);
    put_ok(SYSCFG_EXTICR(1), 1u << 8);
    put_ok(EXTI_FTSR, BIT(6));
    board_set_pin(b, PIN('B', 6), PIN_LEVEL_LOW);
    TEST_ASSERT_EQUAL_HEX32(BIT(6), get(EXTI_PR));
    TEST_ASSERT_FALSE(asks(23));
    put_ok(EXTI_IMR, BIT(6));
    TEST_ASSERT_TRUE(asks(23));
    put_ok(EXTI_PR, BIT(5));
    TEST_ASSERT_TRUE(asks(23));
    put_ok(EXTI_PR, BIT(6));
    TEST_ASSERT_EQUAL_HEX32(0, get(EXTI_PR));
    TEST_ASSERT_FALSE(asks(23));
    board_set_pin(b, PIN('B', 6), PIN_LEVEL_HIGH); /* a rising edge is not wanted */
    TEST_ASSERT_EQUAL_HEX32(0, get(EXTI_PR));
    put_ok(EXTI_RTSR, BIT(6));
    put_ok(EXTI_FTSR, 0);
    board_set_pin(b, PIN('B', 6), PIN_LEVEL_LOW);
    TEST_ASSERT_EQUAL_HEX32(0, get(EXTI_PR));
    board_set_pin(b, PIN('B', 6), PIN_LEVEL_HIGH);
    TEST_ASSERT_EQUAL_HEX32(BIT(6), get(EXTI_PR));
}

static enum pin_level low_at_b6(void *context, uint64_t now_ns, unsigned pin)
{
    (void)context;
    (void)now_ns;
    return pin == PIN('B', 6) ? PIN_LEVEL_LOW : PIN_LEVEL_OPEN;
}

static void test_a_pin_has_the_level_that_the_world_gives_it(void)
{
    const struct world wired = {.pin_input = low_at_b6}, none = {.context = NULL};
    board_set_pin(b, PIN('B', 6), PIN_LEVEL_HIGH);
    board_set_pin(b, PIN('B', 5), PIN_LEVEL_HIGH);
    board_set_world(b, &wired);
    TEST_ASSERT_EQUAL_HEX32(BIT(5), get(GPIO_IDR(1)) & (BIT(5) | BIT(6)));
    board_set_world(b, &none);
    TEST_ASSERT_EQUAL_HEX32(BIT(5) | BIT(6), get(GPIO_IDR(1)) & (BIT(5) | BIT(6)));
}

static void test_a_line_sees_the_port_that_is_chosen(void)
{
    put_ok(EXTI_FTSR, BIT(1));
    board_set_pin(b, PIN('A', 1), PIN_LEVEL_HIGH);
    board_set_pin(b, PIN('B', 1), PIN_LEVEL_HIGH);
    board_set_pin(b, PIN('B', 1), PIN_LEVEL_LOW);
    TEST_ASSERT_EQUAL_HEX32(0, get(EXTI_PR));
    put_ok(SYSCFG_EXTICR(0), 1u << 4); /* from a high pin to a low one: no edge */
    TEST_ASSERT_EQUAL_HEX32(0, get(EXTI_PR));
    board_set_pin(b, PIN('A', 1), PIN_LEVEL_LOW);
    TEST_ASSERT_EQUAL_HEX32(0, get(EXTI_PR));
    put(SYSCFG_EXTICR(0), 7u << 4);
    expect_verdict("a pin of port H for line 1 of EXTI is not modelled");
    put(EXTI_IMR, BIT(17));
    expect_verdict("is not modelled");
}

/* Of an output of the board, too. */
static void test_an_output_makes_edges(void)
{
    put_ok(EXTI_RTSR, BIT(5));
    put_ok(GPIOA_MODER, 0xA8000000u | 1u << 10);
    put_ok(GPIO_BSRR(0), BIT(5));
    TEST_ASSERT_EQUAL_HEX32(BIT(5), get(EXTI_PR));
}

static void test_each_line_has_its_interrupt(void)
{
    static const unsigned irqs[16] = {6, 7, 8, 9, 10, 23, 23, 23, 23, 23, 40, 40, 40, 40, 40, 40};
    put_ok(EXTI_RTSR, 0xFFFFu);
    put_ok(EXTI_IMR, 0xFFFFu);
    for (unsigned line = 0; line < 13; line++) { /* the debugger's pins have pulls */
        board_set_pin(b, PIN('A', line), PIN_LEVEL_HIGH);
        TEST_ASSERT_EQUAL_HEX32(BIT(line), get(EXTI_PR));
        for (unsigned k = 0; k < 13; k++)
            TEST_ASSERT_EQUAL(irqs[k] == irqs[line], asks(irqs[k]));
        put_ok(EXTI_PR, BIT(line));
    }
}

/* ---- pulse widths ---- */

static void timer_on(uint32_t prescaler, uint32_t counts)
{
    put_ok(TIM_PSC(TIM3), prescaler);
    put_ok(TIM_ARR(TIM3), counts - 1u);
    put_ok(TIM_EGR(TIM3), TIM_EGR_UG);
    put_ok(TIM_CR1(TIM3), TIM_CR1_CEN);
}

static void give_pin(void)
{
    put_ok(GPIO_AFR(0, 0), 2u << 24); /* PA6 */
    put_ok(GPIOA_MODER, 0xA8000000u | 2u << 12);
}

static void test_a_channel_has_the_width_and_frequency_of_its_registers(void)
{
    timer_on(15, 1000);
    put_ok(TIM_CCMR(TIM3, 0), TIM_CCMR_PWM1);
    put_ok(TIM_CCER(TIM3), TIM_CCER_E);
    put_ok(TIM_CCR(TIM3, 0), 250);
    TEST_ASSERT_EQUAL(0, seen.times); /* no pin */
    give_pin();
    TEST_ASSERT_EQUAL(1, seen.times);
    TEST_ASSERT_EQUAL(PIN('A', 6), seen.pin);
    TEST_ASSERT_EQUAL_FLOAT(1000.0, seen.hz);
    TEST_ASSERT_EQUAL_FLOAT(0.25, seen.high);
    put_ok(TIM_CCER(TIM3), TIM_CCER_E | TIM_CCER_P);
    TEST_ASSERT_EQUAL_FLOAT(0.75, seen.high);
    put_ok(TIM_CCR(TIM3, 0), 1000);
    TEST_ASSERT_EQUAL_FLOAT(0, seen.high);
    TEST_ASSERT_EQUAL(3, seen.times);
    put_ok(GPIOA_MODER, 0xA8000000u);
    TEST_ASSERT_EQUAL_FLOAT(0, seen.hz);
}

static void test_a_reset_ends_pulses(void)
{
    timer_on(0, 100);
    put_ok(TIM_CCMR(TIM3, 0), TIM_CCMR_PWM1);
    put_ok(TIM_CCER(TIM3), TIM_CCER_E);
    put_ok(TIM_CCR(TIM3, 0), 50);
    give_pin();
    TEST_ASSERT_EQUAL_FLOAT(160000.0, seen.hz);
    restart(RESET_SOFTWARE);
    TEST_ASSERT_EQUAL_FLOAT(0, seen.hz);
}

static void test_what_a_timer_does_not_do_here(void)
{
    put(TIM_CCMR(TIM3, 0), 0x70u);
    expect_verdict("a channel of TIM3 in a mode of 0x70 is not modelled");
    put_ok(TIM_CR1(TIM3), TIM_CR1_CEN);
    put(TIM_PSC(TIM3), 7u);
    expect_verdict("TIM3 runs with a prescaler that no update has taken over");
    put(TIM_CR1(TIM3), BIT(7) | TIM_CR1_CEN);
    expect_verdict("is not modelled");
}

/* ---- the converter ---- */

static void converter_on(void)
{
    put_ok(GPIOA_MODER, 0xA8000000u | 3u << 8); /* PA4: channel 4 */
    put_ok(ADC_CCR, ADC_CCR_TSVREFE);           /* 8 MHz */
    put_ok(ADC1_CR1, ADC_CR1_EOCIE | ADC_CR1_SCAN);
    put_ok(ADC1_CR2, ADC_CR2_ADON | ADC_CR2_EOCS);
    pass(4u * US);
}

static void start_scan(void)
{
    put_ok(ADC1_CR2, ADC_CR2_ADON | ADC_CR2_EOCS | ADC_CR2_SWSTART);
}

static void test_a_conversion_takes_its_sampling_time_and_twelve_cycles(void)
{
    converter_on();
    seen.volts = 1.1;
    put_ok(ADC1_SMPR2, 2u << 12); /* 28 cycles: 5 us in all */
    put_ok(ADC1_SQR3, 4u);
    start_scan();
    pass(4900);
    TEST_ASSERT_EQUAL(0, get(ADC1_SR) & ADC_SR_EOC);
    TEST_ASSERT_FALSE(asks(18));
    pass(200);
    TEST_ASSERT_EQUAL(ADC_SR_EOC, get(ADC1_SR) & ADC_SR_EOC);
    TEST_ASSERT_TRUE(asks(18));
    TEST_ASSERT_EQUAL(PIN('A', 4), seen.pin);
    TEST_ASSERT_EQUAL(1365, get(ADC1_DR));
    TEST_ASSERT_EQUAL(0, get(ADC1_SR) & ADC_SR_EOC);
    TEST_ASSERT_FALSE(asks(18));
    seen.volts = 4;
    start_scan();
    pass(6u * US);
    TEST_ASSERT_EQUAL(4095, get(ADC1_DR));
}

static void test_a_sequence_goes_on_by_itself_as_long_as_it_is_read(void)
{
    converter_on();
    seen.volts = 3.3;
    put_ok(ADC1_SMPR1, 7u << 21);
    put_ok(ADC1_SQR1, 1u << 20);
    put_ok(ADC1_SQR3, 4u | 17u << 5);
    start_scan();
    pass(2u * US);
    TEST_ASSERT_EQUAL(4095, get(ADC1_DR));
    pass(62u * US);
    TEST_ASSERT_EQUAL(bus_read(b, VREFIN_CAL, 2) & 0xFFFFu, get(ADC1_DR)); /* the supply is 3.3 V */
    start_scan();
    pass(2u * US); /* nobody reads */
    pass(62u * US);
    TEST_ASSERT_EQUAL(ADC_SR_OVR | ADC_SR_EOC, get(ADC1_SR) & (ADC_SR_OVR | ADC_SR_EOC));
    put(ADC1_CR2, ADC_CR2_ADON | ADC_CR2_EOCS | ADC_CR2_SWSTART);
    expect_verdict("ADC1 is started with its overrun not cleared");
    put_ok(ADC1_SR, 0);
    start_scan();
    pass(2u * US);
    TEST_ASSERT_EQUAL(4095, get(ADC1_DR));
}

static void test_what_a_program_must_not_do_with_the_converter(void)
{
    put_ok(ADC1_CR2, ADC_CR2_ADON | ADC_CR2_EOCS);
    put(ADC1_CR2, ADC_CR2_ADON | ADC_CR2_EOCS | ADC_CR2_SWSTART);
    expect_verdict("ADC1 is started before it has been on for 3000 ns");
    converter_on();
    put_ok(ADC1_SQR3, 5u);
    put(ADC1_CR2, ADC_CR2_ADON | ADC_CR2_EOCS | ADC_CR2_SWSTART);
    expect_verdict("ADC1 converts channel 5, whose pin is no analogue input");
    put(ADC1_SQR3, 4u);
    expect_verdict("the sequence of ADC1 changes while it runs");
    put(ADC1_CR2, ADC_CR2_ADON | ADC_CR2_EOCS | ADC_CR2_SWSTART);
    expect_verdict("ADC1 is started while a sequence runs");
    put_ok(ADC1_CR2, 0);
    converter_on();
    put_ok(ADC1_SQR3, 17u);
    put(ADC1_CR2, ADC_CR2_ADON | ADC_CR2_EOCS | ADC_CR2_SWSTART);
    expect_verdict("samples its reference for 375 ns");
    put_ok(ADC1_CR2, 0);
    put(ADC1_CR2, ADC_CR2_ADON | BIT(8));
    expect_verdict("ADC1_CR2 of 0x101 is not modelled");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_edge_that_is_wanted_is_pending_until_it_is_cleared);
    RUN_TEST(test_edges_that_the_world_makes_by_itself_are_pending_at_their_time);
    RUN_TEST(test_a_pin_has_the_level_that_the_world_gives_it);
    RUN_TEST(test_a_line_sees_the_port_that_is_chosen);
    RUN_TEST(test_an_output_makes_edges);
    RUN_TEST(test_each_line_has_its_interrupt);
    RUN_TEST(test_a_channel_has_the_width_and_frequency_of_its_registers);
    RUN_TEST(test_a_reset_ends_pulses);
    RUN_TEST(test_what_a_timer_does_not_do_here);
    RUN_TEST(test_a_conversion_takes_its_sampling_time_and_twelve_cycles);
    RUN_TEST(test_a_sequence_goes_on_by_itself_as_long_as_it_is_read);
    RUN_TEST(test_what_a_program_must_not_do_with_the_converter);
    board_free(b);
    return UNITY_END();
}
