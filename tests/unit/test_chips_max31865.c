/* The model of a MAX31865 against its data sheet 19-6478 rev. 3 (tables 1, 5, 9 to 12, pages 3, 11 to 17) and vectors computed from IEC 60751. */
#include "chip_bench.h"

#define CONFIG  0x80u
#define BIAS    0x80u
#define AUTO    0x40u
#define ONESHOT 0x20u
#define WIRES_3 0x10u
#define CLEAR   0x02u
#define HZ_50   0x01u

void setUp(void)
{
    bench_make("max31865", "reference=400", BENCH_SEED);
}

void tearDown(void)
{
    bench_free();
}

static void anew(const char *properties)
{
    bench_free();
    bench_make("max31865", properties, BENCH_SEED);
}

static unsigned rtd_register(void)
{
    uint8_t bytes[2];
    bench_spi_read(0x01, bytes, 2);
    return (unsigned)(bytes[0] << 8 | bytes[1]);
}

/* One conversion by the book, 50 Hz; `more` are bits of the configuration beside. The register. */
static unsigned one_shot(uint8_t more)
{
    bench_spi_put(CONFIG, (uint8_t)(BIAS | HZ_50 | more));
    bench_wait_ms(10);
    bench_spi_put(CONFIG, (uint8_t)(BIAS | ONESHOT | HZ_50 | more));
    bench_wait_ms(66);
    return rtd_register();
}

static void set_thresholds(unsigned low, unsigned high)
{
    uint8_t bytes[4] = {(uint8_t)(high >> 8), (uint8_t)high, (uint8_t)(low >> 8), (uint8_t)low};
    bench_spi_write(0x83, bytes, 4);
}

static void registers_at_power_on_are_those_of_table_1(void)
{
    static const uint8_t first[8] = {0, 0, 0, 0xFF, 0xFF, 0, 0, 0};
    uint8_t bytes[8];
    bench_spi_read(0x00, bytes, 8);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(first, bytes, 8);
    bench_expect_right();
}

static void temperatures_give_the_codes_of_the_standard(void)
{
    /* R = R0(1 + A T + B T^2 + C (T - 100) T^3), 400 ohm; all but 25 and 78.3 degC are table 9. */
    static const struct {
        double degc;
        int code;
    } rows[] = {{-200, 1517},  {-100, 4936}, {-40, 6903},  {0, 8192},    {25, 8989},
                {78.3, 10670}, {100, 11346}, {120, 11966}, {250, 15901}, {275, 16639},
                {300, 17371},  {400, 20242}, {500, 23018}, {550, 24370}};
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        bench_set("temperature", rows[i].degc);
        TEST_ASSERT_INT_WITHIN(1, rows[i].code, (int)(one_shot(0) >> 1));
    }
    bench_expect_right();
}

static void a_ratio_gives_the_code_of_table_5(void)
{
    anew("reference=400 nominal=10");
    bench_set("temperature", 0);
    TEST_ASSERT_EQUAL_HEX16(0x0666, one_shot(0)); /* 0.025 */
    anew("reference=400 nominal=50");
    bench_set("temperature", 0);
    TEST_ASSERT_EQUAL_HEX16(0x2000, one_shot(0)); /* 0.125 */
    anew("reference=400 nominal=300");
    bench_set("temperature", 0);
    TEST_ASSERT_EQUAL_HEX16(0xC000, one_shot(0)); /* 0.75 */
}

static void leads_count_twice_with_two_wires_and_not_with_three_or_four(void)
{
    /* 1 ohm of each lead is 81.92 codes with 400 ohm. */
    bench_set("temperature", 0);
    bench_set("lead", 1);
    TEST_ASSERT_INT_WITHIN(1, 8192 + 164, (int)(one_shot(0) >> 1));
    bench_expect_right();
    anew("reference=400 wires=4");
    bench_set("temperature", 0);
    bench_set("lead", 1);
    TEST_ASSERT_EQUAL_INT(8192, one_shot(0) >> 1);
    bench_expect_right();
    anew("reference=400 wires=3");
    bench_set("temperature", 0);
    bench_set("lead", 1);
    TEST_ASSERT_EQUAL_INT(8192, one_shot(WIRES_3) >> 1);
    bench_expect_right();
    TEST_ASSERT_INT_WITHIN(1, 8192 + 82, (int)(one_shot(0) >> 1));
    bench_expect_wrong("3-wire bit is 0 with 3 wires");
}

static void a_conversion_ends_between_its_typical_and_its_longest_time(void)
{
    for (uint64_t seed = 1; seed <= 20; seed++) {
        for (unsigned hz_50 = 0; hz_50 <= 1; hz_50++) {
            bench_free();
            bench_make("max31865", "", seed);
            bench_spi_put(CONFIG, (uint8_t)(BIAS | hz_50));
            bench_wait_ms(10);
            bench_spi_put(CONFIG, (uint8_t)(BIAS | ONESHOT | hz_50));
            uint64_t start_ns = bench_ns;
            while (bench_spi_get(0x00) & ONESHOT) {
                bench_wait_us(50);
            }
            double ms = (double)(bench_ns - start_ns) * 1e-6;
            TEST_ASSERT_TRUE(ms > (hz_50 ? 62.4 : 51.9) && ms < (hz_50 ? 66.1 : 55.1));
        }
    }
}

static void a_result_read_too_early_is_noticed_and_old(void)
{
    bench_set("temperature", 0);
    unsigned before = one_shot(0);
    bench_set("temperature", 100);
    bench_spi_put(CONFIG, BIAS | ONESHOT | HZ_50);
    bench_wait_ms(60);
    TEST_ASSERT_EQUAL_HEX16(before, rtd_register());
    bench_expect_wrong(
        "register 01h read 60.0 ms after a conversion began, which takes up to 66 ms");
    bench_wait_ms(7);
    TEST_ASSERT_INT_WITHIN(1, 11346, (int)(rtd_register() >> 1));
    bench_expect_right();
}

static void automatic_mode_goes_on_at_the_rate_of_the_notch(void)
{
    bench_set("temperature", 0);
    bench_spi_put(CONFIG, BIAS);
    bench_wait_ms(10);
    bench_spi_put(CONFIG, BIAS | AUTO);
    bench_wait_ms(55);
    TEST_ASSERT_EQUAL_INT(8192, rtd_register() >> 1);
    bench_set("temperature", 100);
    bench_wait_ms(2 * 17.6); /* the one that runs may have begun before */
    TEST_ASSERT_INT_WITHIN(1, 11346, (int)(rtd_register() >> 1));
    bench_expect_right();
    bench_spi_put(CONFIG, BIAS);
    bench_spi_put(CONFIG, BIAS | AUTO);
    bench_wait_ms(30);
    (void)rtd_register();
    bench_expect_wrong(
        "which takes up to 55 ms"); /* note 5 of page 3: the first takes as long as a single one */
}

static void inputs_between_two_looks_count_when_their_conversion_ends(void)
{
    bench_set("temperature", 0);
    bench_spi_put(CONFIG, BIAS | AUTO);
    bench_wait_ms(500);
    chip_at(bench_chip, bench_ns);
    bench_set("temperature", 100);
    bench_wait_us(1);
    TEST_ASSERT_EQUAL_INT(8192, rtd_register() >> 1);
}

static void a_shot_before_the_bias_has_settled_reads_low_and_is_noticed(void)
{
    /* 10.5 x 400 ohm x 100 nF and 1 ms: 1.42 ms. */
    bench_set("temperature", 0);
    bench_spi_put(CONFIG, BIAS | HZ_50);
    bench_wait_ms(0.3);
    bench_spi_put(CONFIG, BIAS | ONESHOT | HZ_50);
    bench_expect_wrong("1-shot 0.3");
    bench_wait_ms(66);
    TEST_ASSERT_LESS_THAN_INT(8192 - 300, (int)(rtd_register() >> 1));
    bench_spi_put(CONFIG, HZ_50);
    bench_spi_put(CONFIG, BIAS | HZ_50);
    bench_wait_ms(1.45);
    bench_spi_put(CONFIG, BIAS | ONESHOT | HZ_50);
    bench_wait_ms(66);
    TEST_ASSERT_INT_WITHIN(1, 8192, (int)(rtd_register() >> 1));
    bench_expect_right();
    bench_spi_put(CONFIG, ONESHOT | HZ_50);
    bench_expect_wrong("1-shot without VBIAS");
}

static void a_notch_may_change_only_between_conversions(void)
{
    bench_spi_put(CONFIG, BIAS);
    bench_wait_ms(2);
    bench_spi_put(CONFIG, BIAS | ONESHOT);
    bench_wait_ms(20);
    bench_spi_put(CONFIG, BIAS | HZ_50);
    bench_expect_wrong("register 00h: notch changed while it converts");
    bench_wait_ms(66);
    bench_spi_put(CONFIG, BIAS);
    bench_expect_right();
    bench_spi_put(CONFIG, BIAS | AUTO);
    bench_spi_put(CONFIG, BIAS | AUTO | HZ_50);
    bench_expect_wrong("notch changed");
}

static void thresholds_latch_their_faults_until_these_are_cleared(void)
{
    set_thresholds(0x2000, 0xC000);
    bench_set("temperature", 100);
    TEST_ASSERT_EQUAL_HEX16(0, one_shot(0) & 1u);
    bench_set("open", 1);
    TEST_ASSERT_EQUAL_HEX16(0xFFFF, one_shot(0)); /* full scale, and a fault */
    TEST_ASSERT_EQUAL_HEX8(0x80, bench_spi_get(0x07));
    bench_set("open", 0);
    TEST_ASSERT_EQUAL_HEX16(1, one_shot(0) & 1u);
    TEST_ASSERT_EQUAL_HEX8(0x80, bench_spi_get(0x07));
    bench_spi_put(CONFIG, BIAS | HZ_50 | CLEAR);
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(0x07));
    TEST_ASSERT_EQUAL_HEX8(BIAS | HZ_50, bench_spi_get(0x00)); /* D1 clears itself */
    bench_set("short", 1);
    TEST_ASSERT_EQUAL_HEX16(0x0001, one_shot(0));
    TEST_ASSERT_EQUAL_HEX8(0x40, bench_spi_get(0x07));
    bench_expect_right();
}

static void clearing_does_nothing_together_with_a_shot(void)
{
    set_thresholds(0x2000, 0xC000);
    bench_set("open", 1);
    (void)one_shot(0);
    bench_set("open", 0);
    bench_spi_put(CONFIG, BIAS | HZ_50 | CLEAR | ONESHOT);
    TEST_ASSERT_EQUAL_HEX8(0x80, bench_spi_get(0x07));
}

static void thresholds_of_power_on_do_not_detect_an_open_element(void)
{
    bench_set("open", 1);
    TEST_ASSERT_EQUAL_HEX16(0xFFFE, one_shot(0));
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(0x07));
}

static void a_threshold_is_reached_by_its_own_value(void)
{
    bench_set("temperature", 0); /* 4000h */
    set_thresholds(0x0000, 0x4002);
    TEST_ASSERT_EQUAL_HEX16(0x4000, one_shot(0));
    set_thresholds(0x0000, 0x4000);
    TEST_ASSERT_EQUAL_HEX16(0x4001, one_shot(0));
    TEST_ASSERT_EQUAL_HEX8(0x80, bench_spi_get(0x07));
}

/* Bits of the status after an automatic fault-detection cycle. */
static uint8_t automatic_cycle(void)
{
    bench_spi_put(CONFIG, BIAS | HZ_50);
    bench_wait_ms(10);
    bench_spi_put(CONFIG, BIAS | HZ_50 | 0x04u);
    TEST_ASSERT_EQUAL_HEX8(BIAS | HZ_50 | 0x04u, bench_spi_get(0x00)); /* table 3: still running */
    bench_wait_us(600);
    TEST_ASSERT_EQUAL_HEX8(BIAS | HZ_50, bench_spi_get(0x00));
    return bench_spi_get(0x07);
}

static void an_automatic_cycle_finds_the_faults_of_tables_10_to_12(void)
{
    anew("reference=400 wires=4");
    TEST_ASSERT_EQUAL_HEX8(0x00, automatic_cycle());
    bench_set("force_open", 1);
    TEST_ASSERT_EQUAL_HEX8(0x20, automatic_cycle());
    bench_spi_put(CONFIG, BIAS | HZ_50 | CLEAR);
    bench_set("force_open", 0);
    bench_set("ground", 1);
    TEST_ASSERT_EQUAL_HEX8(0x18, automatic_cycle());
    bench_spi_put(CONFIG, BIAS | HZ_50 | CLEAR);
    bench_set("ground", 0);
    bench_set("open", 1);
    TEST_ASSERT_EQUAL_HEX8(0x20, automatic_cycle());
    bench_expect_right();
    bench_spi_put(CONFIG, BIAS | HZ_50 | 0x04u);
    bench_wait_us(300);
    (void)bench_spi_get(0x07);
    bench_expect_wrong("register 07h read");
}

static void a_manual_cycle_has_two_steps(void)
{
    bench_set("ground", 1);
    bench_spi_put(CONFIG, BIAS | HZ_50);
    bench_wait_ms(10);
    bench_spi_put(CONFIG, BIAS | HZ_50 | 0x08u);
    bench_wait_ms(1);
    TEST_ASSERT_EQUAL_HEX8(BIAS | HZ_50 | 0x08u,
                           bench_spi_get(0x00)); /* waits for the second step */
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(0x07));
    bench_spi_put(CONFIG, BIAS | HZ_50 | 0x0Cu);
    bench_wait_ms(1);
    TEST_ASSERT_EQUAL_HEX8(BIAS | HZ_50, bench_spi_get(0x00));
    TEST_ASSERT_EQUAL_HEX8(0x18, bench_spi_get(0x07));
    bench_expect_right();
}

static void the_input_settles_again_after_a_cycle(void)
{
    (void)automatic_cycle();
    bench_spi_put(CONFIG, BIAS | ONESHOT | HZ_50);
    bench_expect_wrong("ms after fault detection; 5 time constants and 1 ms are 1.200 ms");
    bench_wait_ms(66);
    (void)automatic_cycle();
    bench_wait_ms(1.2);
    bench_spi_put(CONFIG, BIAS | ONESHOT | HZ_50);
    bench_expect_right();
}

static void a_cycle_wants_the_bias_and_no_shot(void)
{
    bench_spi_put(CONFIG, 0x04u);
    bench_expect_wrong("fault-detection cycle wants");
    bench_spi_put(CONFIG, BIAS | ONESHOT | 0x04u);
    bench_expect_wrong("1-shot and fault detection in one write");
    TEST_ASSERT_EQUAL_HEX8(BIAS, bench_spi_get(0x00)); /* both are ignored */
}

static void overvoltage_halts_conversions_and_comes_back_when_cleared(void)
{
    bench_set("temperature", 0);
    (void)one_shot(0);
    bench_set("overvoltage", 1);
    bench_set("temperature", 100);
    TEST_ASSERT_EQUAL_HEX16(0x4001, one_shot(0));
    bench_spi_put(CONFIG, BIAS | HZ_50 | CLEAR);
    TEST_ASSERT_EQUAL_HEX8(0x04, bench_spi_get(0x07));
    bench_set("overvoltage", 0);
    bench_spi_put(CONFIG, BIAS | HZ_50 | CLEAR);
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(0x07));
}

static void an_open_wire_of_the_current_reads_differently_each_time(void)
{
    anew("reference=400 wires=4");
    bench_set("force_open", 1);
    unsigned first = one_shot(0);
    TEST_ASSERT_NOT_EQUAL(first, one_shot(0));
    anew("reference=400"); /* with two wires it is the element that is open */
    bench_set("force_open", 1);
    TEST_ASSERT_EQUAL_HEX16(0xFFFE, one_shot(0));
}

static void a_brown_out_loses_the_settings_once(void)
{
    static const uint8_t first[8] = {0, 0, 0, 0xFF, 0xFF, 0, 0, 0};
    uint8_t bytes[8];
    set_thresholds(0x2000, 0xC000);
    (void)one_shot(0);
    bench_set("brownout", 1);
    bench_spi_read(0x00, bytes, 8);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(first, bytes, 8);
    set_thresholds(0x2000, 0xC000);
    bench_spi_read(0x00, bytes, 8);
    TEST_ASSERT_EQUAL_HEX8(0xC0, bytes[3]);
}

static void a_dead_chip_leaves_the_line_alone(void)
{
    bench_set("dead", 1);
    TEST_ASSERT_EQUAL_HEX8(0xFF, bench_spi_get(0x03));
    TEST_ASSERT_EQUAL_HEX8(0xFF, bench_spi_get(0x00));
    TEST_ASSERT_TRUE(chips_set(bench_bus, "floats_low", 1, bench_err, sizeof(bench_err)));
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(0x03));
    bench_set("dead", 0);
    TEST_ASSERT_EQUAL_HEX8(0xFF, bench_spi_get(0x03));
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(0x00));
}

static void a_chip_without_power_does_not_answer_and_begins_anew(void)
{
    bench_spi_put(0x83, 0x12);
    chip_power(bench_chip, bench_ns, false);
    TEST_ASSERT_EQUAL_HEX8(0xFF, bench_spi_get(0x00));
    chip_power(bench_chip, bench_ns, true);
    TEST_ASSERT_EQUAL_HEX8(0xFF, bench_spi_get(0x03));
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(0x00));
}

static void noise_scatters_as_much_as_its_property_says(void)
{
    anew("reference=400 noise=0.1");
    bench_set("temperature", 0);
    double sum = 0.0;
    double squares = 0.0;
    enum { N = 400 };
    for (unsigned i = 0; i < N; i++) {
        double d = (double)(one_shot(0) >> 1) - 8192.0;
        sum += d;
        squares += d * d;
    }
    /* 0.1 ohm are 8.19 codes; four standard errors. */
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * 8.19 / 20.0, 0.0, sum / N);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * 67.1 * 0.0708, 67.1, squares / N);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(registers_at_power_on_are_those_of_table_1);
    RUN_TEST(temperatures_give_the_codes_of_the_standard);
    RUN_TEST(a_ratio_gives_the_code_of_table_5);
    RUN_TEST(leads_count_twice_with_two_wires_and_not_with_three_or_four);
    RUN_TEST(a_conversion_ends_between_its_typical_and_its_longest_time);
    RUN_TEST(a_result_read_too_early_is_noticed_and_old);
    RUN_TEST(automatic_mode_goes_on_at_the_rate_of_the_notch);
    RUN_TEST(inputs_between_two_looks_count_when_their_conversion_ends);
    RUN_TEST(a_shot_before_the_bias_has_settled_reads_low_and_is_noticed);
    RUN_TEST(a_notch_may_change_only_between_conversions);
    RUN_TEST(thresholds_latch_their_faults_until_these_are_cleared);
    RUN_TEST(clearing_does_nothing_together_with_a_shot);
    RUN_TEST(thresholds_of_power_on_do_not_detect_an_open_element);
    RUN_TEST(a_threshold_is_reached_by_its_own_value);
    RUN_TEST(an_automatic_cycle_finds_the_faults_of_tables_10_to_12);
    RUN_TEST(a_manual_cycle_has_two_steps);
    RUN_TEST(the_input_settles_again_after_a_cycle);
    RUN_TEST(a_cycle_wants_the_bias_and_no_shot);
    RUN_TEST(overvoltage_halts_conversions_and_comes_back_when_cleared);
    RUN_TEST(an_open_wire_of_the_current_reads_differently_each_time);
    RUN_TEST(a_brown_out_loses_the_settings_once);
    RUN_TEST(a_dead_chip_leaves_the_line_alone);
    RUN_TEST(a_chip_without_power_does_not_answer_and_begins_anew);
    RUN_TEST(noise_scatters_as_much_as_its_property_says);
    return UNITY_END();
}
