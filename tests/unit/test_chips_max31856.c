/* The model of a MAX31856 against its registers (table 6), formats and fault rules, and the reference functions of thermocouples. */
#include "chip_bench.h"
#include "chips/thermocouple.h"

#define AUTO      0x80u
#define ONESHOT   0x40u
#define OPEN_01   0x10u
#define CJ_OFF    0x08u
#define INTERRUPT 0x04u
#define CLEAR     0x02u
#define HZ_50     0x01u

#define STATUS 0x0Fu

struct reading {
    int cold; /* 2^-6 degC */
    int hot;  /* 2^-7 degC */
    uint8_t status;
};

void setUp(void)
{
    bench_make("max31856", "", BENCH_SEED);
}

void tearDown(void)
{
    bench_free();
}

static void anew(const char *properties)
{
    bench_free();
    bench_make("max31856", properties, BENCH_SEED);
}

/* One burst 0Ah to 0Fh. */
static struct reading read_all(void)
{
    uint8_t b[6];
    bench_spi_read(0x0A, b, 6);
    int32_t hot =
        (int32_t)((uint32_t)b[2] << 24 | (uint32_t)b[3] << 16 | (uint32_t)b[4] << 8) >> 13;
    TEST_ASSERT_EQUAL_HEX8(0, b[4] & 0x1Fu); /* 19 bits */
    TEST_ASSERT_EQUAL_HEX8(0, b[1] & 0x03u); /* 14 bits */
    return (struct reading){(int16_t)(uint16_t)(b[0] << 8 | b[1]) >> 2, hot, b[5]};
}

static struct reading one_shot(uint8_t more)
{
    bench_spi_put(0x80, (uint8_t)(ONESHOT | HZ_50 | more));
    bench_wait_ms(210);
    return read_all();
}

static void registers_at_power_on_are_those_of_table_6(void)
{
    static const uint8_t first[16] = {0, 3, 0xFF, 0x7F, 0xC0, 0x7F, 0xFF, 0x80};
    uint8_t bytes[16];
    bench_spi_read(0x00, bytes, 16);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(first, bytes, 16);
}

static void each_type_reads_the_temperature_of_its_hot_junction(void)
{
    static const double degc[8][3] = {{300, 1000, 1800},  {-150, 20, 900},   {-200, 78.3, 1100},
                                      {-190, 78.3, 1300}, {-150, 100, 1250}, {-40, 150, 1700},
                                      {-40, 150, 1700},   {-190, 78.3, 390}};
    for (unsigned type = 0; type < 8; type++) {
        char properties[] = "type=B";
        properties[5] = THERMOCOUPLES[type];
        anew(properties);
        bench_spi_put(0x81, (uint8_t)type);
        bench_set("cold", 31.25);
        for (unsigned i = 0; i < 3; i++) {
            bench_set("temperature", degc[type][i]);
            struct reading r = one_shot(0);
            TEST_ASSERT_DOUBLE_WITHIN(0.5 / 128.0 + 1e-6, degc[type][i], r.hot / 128.0);
            TEST_ASSERT_EQUAL_INT(31.25 * 64, r.cold);
            TEST_ASSERT_EQUAL_HEX8(0, r.status);
        }
        bench_expect_right();
    }
}

static void another_type_than_the_wire_reads_wrongly(void)
{
    /* 78.3 degC of a K junction at 20 degC look like those of the same voltage in a J wire. */
    bench_set("temperature", 78.3);
    bench_spi_put(0x81, 2);
    double mv = thermocouple_mv('K', 78.3) - thermocouple_mv('K', 20) + thermocouple_mv('J', 20);
    double expected = thermocouple_degc('J', mv, -210, 1200);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, expected, one_shot(0).hot / 128.0);
    TEST_ASSERT_TRUE(expected < 70.0);
}

static void temperatures_below_zero_are_negative_codes(void)
{
    bench_set("temperature", -0.25);
    bench_set("cold", -10.5);
    struct reading r = one_shot(0);
    TEST_ASSERT_EQUAL_INT(-32, r.hot);
    TEST_ASSERT_EQUAL_INT(-672, r.cold);
}

static void an_offset_moves_the_cold_junction_and_what_it_compensates(void)
{
    bench_set("cold", 25);
    bench_set("temperature", 25);
    bench_spi_put(0x89, 0x10); /* 1 degC */
    struct reading r = one_shot(0);
    TEST_ASSERT_EQUAL_INT(26 * 64, r.cold);
    TEST_ASSERT_EQUAL_INT(26 * 128, r.hot);
    bench_spi_put(0x89, 0xF8); /* -0.5 degC */
    TEST_ASSERT_EQUAL_INT(1568, one_shot(0).cold);
}

static void a_cold_junction_from_outside_is_written(void)
{
    static const uint8_t degc_50[2] = {0x32, 0x00};
    bench_spi_write(0x8A, degc_50, 2);
    bench_expect_wrong("register 0Ah written while the chip measures the cold junction itself");
    bench_spi_put(0x80, CJ_OFF | HZ_50);
    bench_spi_write(0x8A, degc_50, 2);
    bench_set("cold", 20);
    bench_set("temperature", 20);
    struct reading r = one_shot(CJ_OFF);
    TEST_ASSERT_EQUAL_INT(50 * 64, r.cold);
    TEST_ASSERT_EQUAL_INT(50 * 128, r.hot);
    bench_expect_right();
}

static void a_conversion_takes_its_time_and_averaging_more(void)
{
    for (uint64_t seed = 1; seed <= 10; seed++) {
        for (unsigned average = 0; average <= 4; average += 2) {
            bench_free();
            bench_make("max31856", "", seed);
            bench_spi_put(0x81, (uint8_t)(average << 4 | 3u));
            bench_spi_put(0x80, ONESHOT | HZ_50);
            uint64_t start_ns = bench_ns;
            while (bench_spi_get(0x00) & ONESHOT) {
                bench_wait_us(100);
            }
            double ms = (double)(bench_ns - start_ns) * 1e-6;
            double more = average == 0 ? 0.0 : average == 2 ? 3 * 40.0 : 15 * 40.0;
            TEST_ASSERT_TRUE(ms > 168.9 + more && ms < 185.2 + more);
        }
    }
}

static void a_result_read_too_early_is_noticed_and_old(void)
{
    bench_set("temperature", 100);
    bench_spi_put(0x80, ONESHOT);
    bench_wait_ms(100);
    TEST_ASSERT_EQUAL_INT(0, read_all().hot);
    bench_expect_wrong(
        "register 0Ch read 100.0 ms after a conversion began, which takes up to 155 ms");
    bench_wait_ms(56);
    TEST_ASSERT_EQUAL_INT(12800, read_all().hot);
    bench_expect_right();
}

static void automatic_mode_converts_about_ten_times_a_second(void)
{
    bench_spi_put(0x80, AUTO);
    bench_wait_ms(156);
    bench_set("temperature", 100);
    bench_wait_ms(180);
    TEST_ASSERT_EQUAL_INT(12800, read_all().hot);
    bench_set("temperature", 200);
    bench_wait_ms(20);
    TEST_ASSERT_EQUAL_INT(12800, read_all().hot);
    bench_wait_ms(160);
    TEST_ASSERT_EQUAL_INT(25600, read_all().hot);
    bench_expect_right();
}

static void an_open_wire_is_found_in_each_shot_that_tests_for_it(void)
{
    bench_set("temperature", 150);
    bench_set("cold", 25);
    bench_set("open", 1);
    struct reading r = one_shot(0);
    TEST_ASSERT_EQUAL_HEX8(0, r.status);
    TEST_ASSERT_EQUAL_INT(25 * 128, r.hot); /* a plausible number */
    TEST_ASSERT_EQUAL_HEX8(0x01, one_shot(OPEN_01).status);
    bench_set("open", 0);
    TEST_ASSERT_EQUAL_HEX8(0x00, one_shot(OPEN_01).status);
    bench_expect_right();
}

static void an_open_wire_is_found_every_sixteen_conversions_in_automatic_mode(void)
{
    bench_spi_put(0x80, AUTO | OPEN_01);
    bench_wait_ms(400);
    bench_set("open", 1);
    double waited_ms = 0.0;
    while (!(bench_spi_get(STATUS) & 1u)) {
        bench_wait_ms(10);
        waited_ms += 10.0;
        TEST_ASSERT_TRUE(waited_ms < 2500.0);
    }
    TEST_ASSERT_TRUE(waited_ms > 900.0); /* 16 x 82 ms, less 400 */
    bench_set("open", 0);
    bench_wait_ms(1000);
    TEST_ASSERT_EQUAL_HEX8(1, bench_spi_get(STATUS) & 1u);
    bench_wait_ms(600);
    TEST_ASSERT_EQUAL_HEX8(0, bench_spi_get(STATUS) & 1u);
}

static void overvoltage_keeps_the_old_value_and_hides_other_faults(void)
{
    bench_set("temperature", 100);
    (void)one_shot(0);
    bench_set("overvoltage", 1);
    bench_set("open", 1);
    struct reading r = one_shot(OPEN_01);
    TEST_ASSERT_EQUAL_INT(12800, r.hot);
    TEST_ASSERT_EQUAL_HEX8(0x02, r.status);
    bench_set("overvoltage", 0);
    TEST_ASSERT_EQUAL_HEX8(0x01, one_shot(OPEN_01).status);
}

static void a_short_reads_the_cold_junction_without_a_word(void)
{
    bench_set("temperature", 300);
    bench_set("cold", 30);
    bench_set("short", 1);
    struct reading r = one_shot(OPEN_01);
    TEST_ASSERT_EQUAL_INT(30 * 128, r.hot);
    TEST_ASSERT_EQUAL_HEX8(0, r.status);
}

static void thresholds_work_although_all_faults_are_masked(void)
{
    static const uint8_t thresholds[6] = {40,   10,   0x0C,
                                          0x80, 0x03, 0x20}; /* 40, 10; 200, 50 degC */
    bench_spi_write(0x83, thresholds, 6);
    bench_set("cold", 20);
    bench_set("temperature", 100);
    TEST_ASSERT_EQUAL_HEX8(0x00, one_shot(0).status);
    bench_set("temperature", 201);
    TEST_ASSERT_EQUAL_HEX8(0x08, one_shot(0).status);
    bench_set("temperature", 49);
    TEST_ASSERT_EQUAL_HEX8(0x04, one_shot(0).status);
    bench_set("temperature", 100);
    bench_set("cold", 41);
    TEST_ASSERT_EQUAL_HEX8(0x20, one_shot(0).status);
    bench_set("cold", 9);
    TEST_ASSERT_EQUAL_HEX8(0x10, one_shot(0).status);
}

static void a_threshold_lets_go_two_degrees_later_in_comparator_mode(void)
{
    static const uint8_t high[2] = {0x06, 0x40}; /* 100 degC */
    bench_spi_write(0x85, high, 2);
    bench_set("temperature", 101);
    TEST_ASSERT_EQUAL_HEX8(0x08, one_shot(0).status);
    bench_set("temperature", 98.5);
    TEST_ASSERT_EQUAL_HEX8(0x08, one_shot(0).status);
    bench_set("temperature", 97.5);
    TEST_ASSERT_EQUAL_HEX8(0x00, one_shot(0).status);
}

static void interrupt_mode_latches_until_it_is_cleared(void)
{
    bench_set("open", 1);
    TEST_ASSERT_EQUAL_HEX8(0x01, one_shot(OPEN_01 | INTERRUPT).status);
    bench_set("open", 0);
    TEST_ASSERT_EQUAL_HEX8(0x01, one_shot(OPEN_01 | INTERRUPT).status);
    bench_spi_put(0x80, CLEAR | HZ_50); /* has no effect in comparator mode */
    TEST_ASSERT_EQUAL_HEX8(0x01, bench_spi_get(STATUS));
    bench_spi_put(0x80, CLEAR | HZ_50 | INTERRUPT);
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(STATUS));
    TEST_ASSERT_EQUAL_HEX8(HZ_50 | INTERRUPT, bench_spi_get(0x00));
}

static void beyond_its_range_a_junction_is_told(void)
{
    anew("type=T");
    bench_spi_put(0x81, 7);
    bench_set("temperature", 450);
    TEST_ASSERT_EQUAL_HEX8(0x48, one_shot(0).status | 0x08u);
    bench_set("temperature", 100);
    bench_set("cold", 126);
    TEST_ASSERT_EQUAL_HEX8(0x80, one_shot(0).status);
}

static void voltage_mode_gives_gain_times_voltage(void)
{
    anew("type=K");
    bench_set("cold", 0);
    bench_set("temperature", 500); /* 20.644 mV */
    bench_spi_put(0x81, 0x08);
    TEST_ASSERT_INT_WITHIN(1, 34636, one_shot(0).hot); /* 8 x 1.6 x 2^17 x 0.0206443 V */
    bench_set("temperature", 300);                     /* 12.209 mV */
    bench_spi_put(0x81, 0x0C);
    TEST_ASSERT_INT_WITHIN(4, 81932, one_shot(0).hot);
}

static void settings_of_a_conversion_may_change_only_between(void)
{
    bench_spi_put(0x80, ONESHOT);
    bench_wait_ms(10);
    bench_spi_put(0x81, 0x13);
    bench_expect_wrong("register 01h: averaging changed while it converts");
    bench_spi_put(0x80, HZ_50);
    bench_expect_wrong("register 00h: notch changed while it converts");
    bench_wait_ms(300);
    bench_spi_put(0x80, AUTO | HZ_50);
    bench_spi_put(0x80, AUTO | ONESHOT | HZ_50);
    bench_expect_wrong("1-shot in automatic mode");
    bench_spi_put(0x8C, 1);
    bench_expect_wrong("register 0Ch written; it is read-only");
    bench_mode = 0;
    (void)bench_spi_get(0x00);
    bench_expect_wrong("SPI mode 0");
}

static void a_brown_out_loses_the_type(void)
{
    bench_spi_put(0x81, 7);
    bench_set("brownout", 1);
    TEST_ASSERT_EQUAL_HEX8(3, bench_spi_get(0x01));
    bench_spi_put(0x81, 7);
    TEST_ASSERT_EQUAL_HEX8(7, bench_spi_get(0x01));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(registers_at_power_on_are_those_of_table_6);
    RUN_TEST(each_type_reads_the_temperature_of_its_hot_junction);
    RUN_TEST(another_type_than_the_wire_reads_wrongly);
    RUN_TEST(temperatures_below_zero_are_negative_codes);
    RUN_TEST(an_offset_moves_the_cold_junction_and_what_it_compensates);
    RUN_TEST(a_cold_junction_from_outside_is_written);
    RUN_TEST(a_conversion_takes_its_time_and_averaging_more);
    RUN_TEST(a_result_read_too_early_is_noticed_and_old);
    RUN_TEST(automatic_mode_converts_about_ten_times_a_second);
    RUN_TEST(an_open_wire_is_found_in_each_shot_that_tests_for_it);
    RUN_TEST(an_open_wire_is_found_every_sixteen_conversions_in_automatic_mode);
    RUN_TEST(overvoltage_keeps_the_old_value_and_hides_other_faults);
    RUN_TEST(a_short_reads_the_cold_junction_without_a_word);
    RUN_TEST(thresholds_work_although_all_faults_are_masked);
    RUN_TEST(a_threshold_lets_go_two_degrees_later_in_comparator_mode);
    RUN_TEST(interrupt_mode_latches_until_it_is_cleared);
    RUN_TEST(beyond_its_range_a_junction_is_told);
    RUN_TEST(voltage_mode_gives_gain_times_voltage);
    RUN_TEST(settings_of_a_conversion_may_change_only_between);
    RUN_TEST(a_brown_out_loses_the_type);
    return UNITY_END();
}
