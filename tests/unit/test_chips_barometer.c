/* The models of a BME280 and a BMP280. What they measure is worked out with the maker's own way for integers of 32 and 64 bits (BMP280 data sheet
 * 3.11.3, BME280 4.2.3), written from its formulas; the models use its way for floating point, backwards. */
#include "chip_bench.h"

#define AT 0x76u

struct words {
    uint16_t t1;
    int16_t t2, t3;
    uint16_t p1;
    int16_t p[10]; /* from 2 on */
};

void setUp(void)
{
    bench_make("bme280", "varied=0", BENCH_SEED);
}

void tearDown(void)
{
    bench_free();
}

static void anew(const char *kind, const char *properties, uint64_t seed)
{
    bench_free();
    bench_make(kind, properties, seed);
}

static uint8_t get(uint8_t at)
{
    uint8_t byte = 0;
    TEST_ASSERT_TRUE(bench_i2c_read(AT, at, &byte, 1));
    return byte;
}

static void put(uint8_t at, uint8_t value)
{
    uint8_t bytes[2] = {at, value};
    TEST_ASSERT_TRUE(bench_i2c_write(AT, bytes, 2));
}

static struct words calibration(void)
{
    uint8_t b[24];
    struct words w;
    int32_t word[12];
    TEST_ASSERT_TRUE(bench_i2c_read(AT, 0x88, b, 24));
    for (unsigned i = 0; i < 12; i++) {
        word[i] = b[(size_t)2 * i] | b[(size_t)2 * i + 1] << 8;
    }
    w.t1 = (uint16_t)word[0];
    w.t2 = (int16_t)word[1];
    w.t3 = (int16_t)word[2];
    w.p1 = (uint16_t)word[3];
    for (unsigned i = 2; i < 10; i++) {
        w.p[i] = (int16_t)word[i + 2];
    }
    return w;
}

/* Fine temperature; its hundredths of a degree. */
static int32_t fine(const struct words *w, int32_t adc, double *degc)
{
    int32_t far = (adc >> 3) - ((int32_t)w->t1 << 1);
    int32_t near = (adc >> 4) - (int32_t)w->t1;
    int32_t t_fine = ((far * w->t2) >> 11) + ((((near * near) >> 12) * w->t3) >> 14);
    *degc = ((t_fine * 5 + 128) >> 8) / 100.0;
    return t_fine;
}

static double pascal(const struct words *w, int32_t adc, int32_t t_fine)
{
    int64_t v = (int64_t)t_fine - 128000;
    int64_t offset = v * v * w->p[6] + v * w->p[5] * 131072 + (int64_t)w->p[4] * 34359738368;
    int64_t scale = ((v * v * w->p[3]) >> 8) + v * w->p[2] * 4096;
    scale = ((140737488355328 + scale) * w->p1) >> 33;
    int64_t p = ((int64_t)(1048576 - adc) * 2147483648 - offset) * 3125 / scale;
    int64_t a = (w->p[9] * (p >> 13) * (p >> 13)) >> 25;
    int64_t b = (w->p[8] * p) >> 19;
    return (double)(((p + a + b) >> 8) + (int64_t)w->p[7] * 16) / 256.0;
}

static void codes(int32_t *p, int32_t *t)
{
    uint8_t b[6];
    TEST_ASSERT_TRUE(bench_i2c_read(AT, 0xF7, b, 6));
    *p = b[0] << 12 | b[1] << 4 | b[2] >> 4;
    *t = b[3] << 12 | b[4] << 4 | b[5] >> 4;
}

/* One forced measurement with the most samples, and what a driver makes of it. */
static void measure(double *pa, double *degc)
{
    int32_t p;
    int32_t t;
    struct words w = calibration();
    put(0xF4, 5u << 5 | 5u << 2 | 1u);
    bench_wait_ms(76.0); /* 1.25 + 16 x 2.3 + 16 x 2.3 + 0.575 ms */
    codes(&p, &t);
    int32_t t_fine = fine(&w, t, degc);
    *pa = pascal(&w, p, t_fine);
}

static void the_worked_example_has_its_calibration_and_its_results(void)
{
    /* Example of the maker, as tests of public drivers have it: 519888 and 415148 are 25.08 degC and 100653.27 Pa. */
    struct words w = calibration();
    double degc;
    TEST_ASSERT_EQUAL_UINT16(27504, w.t1);
    TEST_ASSERT_EQUAL_INT16(-1000, w.t3);
    TEST_ASSERT_EQUAL_UINT16(36477, w.p1);
    TEST_ASSERT_EQUAL_INT16(6000, w.p[9]);
    int32_t t_fine = fine(&w, 519888, &degc);
    TEST_ASSERT_EQUAL_INT32(128422, t_fine);
    TEST_ASSERT_EQUAL_DOUBLE(25.08, degc);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 100653.27, pascal(&w, 415148, t_fine));
}

static void the_example_s_pressure_gives_the_example_s_code(void)
{
    int32_t p;
    int32_t t;
    bench_set("temperature", 128422 / 5120.0);
    bench_set("pressure", 100653.27);
    put(0xF4, 5u << 5 | 5u << 2 | 1u);
    bench_wait_ms(76.0);
    codes(&p, &t);
    TEST_ASSERT_INT_WITHIN(1, 519888, t);
    TEST_ASSERT_INT_WITHIN(1, 415148, p);
    bench_expect_right();
}

static void a_driver_gets_the_pressure_that_is_set(void)
{
    static const double pressures[5] = {30000, 87000, 95000, 101325, 110000};
    static const double temperatures[4] = {-20, 5, 23.4, 60};
    for (uint64_t seed = 1; seed <= 6; seed++) {
        anew(seed % 2 ? "bme280" : "bmp280", "", seed);
        for (unsigned i = 0; i < 20; i++) {
            double pa;
            double degc;
            bench_set("pressure", pressures[i % 5]);
            bench_set("temperature", temperatures[i % 4]);
            measure(&pa, &degc);
            /* The integers drop 3 bits of the temperature's code: up to 27000 / 2048 = 13.2 units of t_fine, and one more for the rest, of
             * 0.033 Pa each at 110 kPa. Half a code of pressure is 0.09 Pa. */
            TEST_ASSERT_DOUBLE_WITHIN(14.2 * 0.033 + 0.09, pressures[i % 5], pa);
            TEST_ASSERT_DOUBLE_WITHIN(0.011, temperatures[i % 4], degc);
        }
        bench_expect_right();
    }
}

static void the_chips_have_their_numbers(void)
{
    TEST_ASSERT_EQUAL_HEX8(0x60, get(0xD0));
    anew("bmp280", "", BENCH_SEED);
    TEST_ASSERT_EQUAL_HEX8(0x58, get(0xD0));
}

static void what_is_not_measured_reads_80000h(void)
{
    int32_t p;
    int32_t t;
    codes(&p, &t);
    TEST_ASSERT_EQUAL_HEX32(0x80000, p);
    TEST_ASSERT_EQUAL_HEX32(0x80000, t);
    put(0xF4, 1u << 5 | 1u); /* temperature alone */
    bench_wait_ms(4);
    codes(&p, &t);
    TEST_ASSERT_EQUAL_HEX32(0x80000, p);
    TEST_ASSERT_NOT_EQUAL(0x80000, t);
}

static void fewer_samples_have_fewer_bits(void)
{
    for (unsigned over = 1; over <= 5; over++) {
        int32_t p;
        int32_t t;
        int32_t mask = (1 << (5u - over)) - 1;
        put(0xF4, (uint8_t)(over << 5 | over << 2 | 1u));
        bench_wait_ms(76);
        codes(&p, &t);
        TEST_ASSERT_EQUAL_INT32(0, (p | t) & mask);
    }
}

static void a_forced_measurement_ends_in_sleep_and_in_time(void)
{
    for (uint64_t seed = 1; seed <= 10; seed++) {
        anew("bmp280", "", seed);
        put(0xF4, 1u << 5 | 1u << 2 | 1u);
        uint64_t start_ns = bench_ns;
        TEST_ASSERT_EQUAL_HEX8(0x08, get(0xF3));
        while (get(0xF3) & 0x08u) {
        }
        double ms = (double)(bench_ns - start_ns) * 1e-6;
        TEST_ASSERT_TRUE(ms > 5.4 && ms < 6.43 + 0.4); /* and one more look */
        TEST_ASSERT_EQUAL_HEX8(1u << 5 | 1u << 2, get(0xF4));
        bench_expect_right();
    }
}

static void a_result_read_too_early_is_noticed(void)
{
    int32_t p;
    int32_t t;
    put(0xF4, 1u << 5 | 1u << 2 | 1u);
    bench_wait_ms(2);
    codes(&p, &t);
    TEST_ASSERT_EQUAL_HEX32(0x80000, p);
    bench_expect_wrong("register F7h read");
}

static void normal_mode_goes_on_by_itself_and_keeps_its_configuration(void)
{
    int32_t first;
    int32_t second;
    int32_t t;
    put(0xF5, 1u << 5); /* 62.5 ms between two */
    put(0xF4, 1u << 5 | 1u << 2 | 3u);
    bench_wait_ms(7);
    codes(&first, &t);
    bench_set("pressure", 90000);
    bench_wait_ms(30);
    codes(&second, &t);
    TEST_ASSERT_EQUAL_INT32(first, second);
    bench_wait_ms(40);
    codes(&second, &t);
    TEST_ASSERT_TRUE(second > first + 10000); /* a lower pressure is a higher code */
    bench_expect_right();
    put(0xF5, 0);
    bench_expect_wrong("register F5h written in normal mode");
    TEST_ASSERT_EQUAL_HEX8(1u << 5, get(0xF5));
}

static void the_filter_approaches_a_step(void)
{
    int32_t p[3];
    int32_t t;
    put(0xF5, 2u << 2); /* coefficient 4 */
    for (unsigned i = 0; i < 3; i++) {
        put(0xF4, 5u << 5 | 5u << 2 | 1u);
        bench_wait_ms(76);
        codes(&p[i], &t);
        bench_set("pressure", 90000);
    }
    double step = (p[2] - p[1]) / (double)(p[1] - p[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.75, step);
}

static void humidity_takes_effect_with_the_next_measurement_only(void)
{
    put(0xF2, 1);
    TEST_ASSERT_EQUAL_HEX8(1, get(0xF2));
    put(0xF4, 1u << 5 | 1u << 2 | 1u);
    bench_wait_ms(7);
    TEST_ASSERT_EQUAL_HEX8(0x80, get(0xFD));
    bench_expect_wrong("which takes up to 9.30 ms");
}

static void a_reset_and_the_supply_take_two_milliseconds(void)
{
    put(0xF4, 0x24);
    put(0xE0, 0xB6);
    TEST_ASSERT_EQUAL_HEX8(0x01, get(0xF3));
    bench_expect_wrong("start-up time of 2 ms");
    bench_wait_ms(2);
    TEST_ASSERT_EQUAL_HEX8(0x00, get(0xF3));
    TEST_ASSERT_EQUAL_HEX8(0x00, get(0xF4));
    bench_expect_right();
}

static void expect_calibration(const uint8_t *wanted)
{
    uint8_t bytes[24];
    TEST_ASSERT_TRUE(bench_i2c_read(AT, 0x88, bytes, 24));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(wanted, bytes, 24);
}

static void a_chip_keeps_its_calibration_through_resets(void)
{
    uint8_t own[24];
    double pa;
    double degc;
    anew("bme280", "noise=1", BENCH_SEED);
    TEST_ASSERT_TRUE(bench_i2c_read(AT, 0x88, own, 24));
    for (unsigned i = 0; i < 3; i++) {
        measure(&pa, &degc); /* which takes random numbers */
        put(0xE0, 0xB6);
        bench_wait_ms(3);
        expect_calibration(own);
    }
}

static void calibration_is_read_only(void)
{
    put(0x88, 1);
    bench_expect_wrong("register 88h written; it is read-only");
    put(0xD0, 1);
    bench_expect_wrong("register D0h");
}

static void faults_are_silence_and_a_result_that_stays(void)
{
    int32_t before;
    int32_t after;
    int32_t t;
    put(0xF4, 1u << 5 | 1u << 2 | 1u);
    bench_wait_ms(7);
    codes(&before, &t);
    bench_set("stuck", 1);
    bench_set("pressure", 80000);
    put(0xF4, 1u << 5 | 1u << 2 | 1u);
    bench_wait_ms(7);
    codes(&after, &t);
    TEST_ASSERT_EQUAL_INT32(before, after);
    bench_set("dead", 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_SILENT, chips_start(bench_bus, bench_ns, AT, false));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_worked_example_has_its_calibration_and_its_results);
    RUN_TEST(the_example_s_pressure_gives_the_example_s_code);
    RUN_TEST(a_driver_gets_the_pressure_that_is_set);
    RUN_TEST(the_chips_have_their_numbers);
    RUN_TEST(what_is_not_measured_reads_80000h);
    RUN_TEST(fewer_samples_have_fewer_bits);
    RUN_TEST(a_forced_measurement_ends_in_sleep_and_in_time);
    RUN_TEST(a_result_read_too_early_is_noticed);
    RUN_TEST(normal_mode_goes_on_by_itself_and_keeps_its_configuration);
    RUN_TEST(the_filter_approaches_a_step);
    RUN_TEST(humidity_takes_effect_with_the_next_measurement_only);
    RUN_TEST(a_reset_and_the_supply_take_two_milliseconds);
    RUN_TEST(a_chip_keeps_its_calibration_through_resets);
    RUN_TEST(calibration_is_read_only);
    RUN_TEST(faults_are_silence_and_a_result_that_stays);
    return UNITY_END();
}
