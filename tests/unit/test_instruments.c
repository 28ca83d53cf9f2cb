/* Sensors and actuators around a perfect plant. Accuracy: lag and slew within 1e-12 of the closed form (relative);
 * noise statistics within four standard errors of 20000 draws. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "instruments.h"
#include "two_by_two.h"
#include "unity.h"

#define SEED 11u

enum { U1, U2, D, Y1, Y2 };

static struct plant *plant;
static struct instruments in;
static struct link_sample sample;
static char err[256];

static void fresh(double noise)
{
    TEST_ASSERT_TRUE(instruments_init(&in, &two_by_two, SEED, noise, err, sizeof(err)));
}

void setUp(void)
{
    plant = two_by_two.create(err, sizeof(err));
    TEST_ASSERT_NOT_NULL(plant);
    fresh(0.0);
}

void tearDown(void)
{
    two_by_two.destroy(plant);
}

static void measure(double dt_s)
{
    instruments_measure(&in, plant, dt_s, &sample);
}

static void command(float u1, float u2)
{
    struct link_command c = {.n_outputs = 2};
    c.output[0].value = u1;
    c.output[0].drive = true;
    c.output[1].value = u2;
    c.output[1].drive = true;
    instruments_command(&in, &c);
}

static void drive(double dt_s)
{
    TEST_ASSERT_TRUE_MESSAGE(instruments_drive(&in, plant, dt_s, err, sizeof(err)), err);
}

static void a_perfect_sensor_reads_the_plant(void)
{
    measure(0.0);
    TEST_ASSERT_EQUAL_UINT8(2, sample.n_measurements);
    TEST_ASSERT_EQUAL_UINT8(2, sample.n_readback);
    TEST_ASSERT_EQUAL_FLOAT(45.0f, sample.measurement[0].value);
    TEST_ASSERT_EQUAL_UINT8(QUALITY_GOOD, sample.measurement[0].quality);
    TEST_ASSERT_EQUAL_FLOAT(20.0f, sample.readback[0].value);
}

static void bias_is_added_and_clipping_at_the_span_is_uncertain(void)
{
    instruments_set(&in, Y1, OPTION_BIAS, 1.5);
    measure(0.0);
    TEST_ASSERT_EQUAL_FLOAT(46.5f, sample.measurement[0].value);
    TEST_ASSERT_EQUAL_FLOAT(51.0f, sample.measurement[1].value);
    instruments_set(&in, Y1, OPTION_BIAS, 1000.0);
    measure(10.0);
    TEST_ASSERT_EQUAL_FLOAT(200.0f, sample.measurement[0].value);
    TEST_ASSERT_EQUAL_UINT8(QUALITY_UNCERTAIN, sample.measurement[0].quality);
}

static void readings_are_multiples_of_the_resolution(void)
{
    instruments_set(&in, Y1, OPTION_RESOLUTION, 0.25);
    instruments_set(&in, Y1, OPTION_NOISE, 1.0);
    for (unsigned i = 0; i < 200; i++) {
        measure(10.0);
        double steps = (double)sample.measurement[0].value / 0.25;
        TEST_ASSERT_EQUAL_DOUBLE(round(steps), steps);
    }
}

static void a_forced_quality_is_sent_and_a_missing_reading_is_zero(void)
{
    instruments_set(&in, Y2, OPTION_QUALITY, QUALITY_BAD);
    measure(0.0);
    TEST_ASSERT_EQUAL_UINT8(QUALITY_BAD, sample.measurement[1].quality);
    TEST_ASSERT_EQUAL_FLOAT(51.0f, sample.measurement[1].value);
    instruments_set(&in, Y2, OPTION_QUALITY, QUALITY_MISSING);
    measure(10.0);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, sample.measurement[1].value);
    TEST_ASSERT_EQUAL_UINT8(QUALITY_MISSING, sample.measurement[1].quality);
}

static void a_sensor_lag_follows_a_straight_line_exactly(void)
{
    /* A disturbance moves y1 towards +5; between samples the truth is taken as a straight line. */
    const double tau = 17.0;
    const double dt = 10.0;
    instruments_set(&in, Y1, OPTION_LAG, tau);
    measure(0.0);
    TEST_ASSERT_TRUE(two_by_two.set_input(plant, D, 5.0, err, sizeof(err)));
    double y = 45.0;
    double u0 = 45.0;
    for (unsigned k = 1; k <= 50; k++) {
        TEST_ASSERT_TRUE(two_by_two.advance(plant, k * dt, err, sizeof(err)));
        measure(dt);
        double u1 = two_by_two.value(plant, Y1);
        /* Fine integration of tau dy/dt = u - y, Runge-Kutta of fourth order, 200 steps. */
        double h = dt / 200.0;
        for (unsigned i = 0; i < 200; i++) {
            double a = u0 + (u1 - u0) * i / 200.0;
            double b = u0 + (u1 - u0) * (i + 0.5) / 200.0;
            double c = u0 + (u1 - u0) * (i + 1.0) / 200.0;
            double k1 = (a - y) / tau;
            double k2 = (b - y - 0.5 * h * k1) / tau;
            double k3 = (b - y - 0.5 * h * k2) / tau;
            double k4 = (c - y - h * k3) / tau;
            y += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        }
        u0 = u1;
        TEST_ASSERT_DOUBLE_WITHIN(1e-10 * y, y, in.sensor[0].filtered);
    }
}

static void noise_has_the_stated_mean_and_deviation(void)
{
    printf("noise statistics, seed %u\n", SEED);
    instruments_set(&in, Y1, OPTION_NOISE, 0.5);
    const unsigned n = 20000;
    double sum = 0.0;
    double sum2 = 0.0;
    double sum3 = 0.0;
    double neighbour = 0.0;
    double last = 0.0;
    unsigned beyond_two = 0;
    for (unsigned i = 0; i < n; i++) {
        measure(10.0);
        double x = ((double)sample.measurement[0].value - 45.0) / 0.5;
        sum += x;
        sum2 += x * x;
        sum3 += x * x * x;
        neighbour += x * last;
        last = x;
        beyond_two += fabs(x) > 2.0 ? 1u : 0u;
    }
    TEST_ASSERT_DOUBLE_WITHIN(4.0 / sqrt(n), 0.0, sum / n);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * sqrt(2.0 / n), 1.0, sum2 / n);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * sqrt(15.0 / n), 0.0, sum3 / n);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 / sqrt(n), 0.0, neighbour / n);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * sqrt(0.0455 * 0.9545 / n), 0.0455, (double)beyond_two / n);
}

static void the_random_source_gives_its_published_numbers(void)
{
    /* PCG32, seed 42, stream 54: the first outputs of the reference implementation's demo. */
    const uint32_t expected[] = {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u,
                                 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu};
    struct noise n;
    noise_seed(&n, 42, 54);
    for (unsigned i = 0; i < 6; i++) {
        TEST_ASSERT_EQUAL_HEX32(expected[i], noise_bits(&n));
    }
}

static void the_same_seed_gives_the_same_readings_and_another_seed_others(void)
{
    float first[100];
    fresh(1.0);
    for (unsigned i = 0; i < 100; i++) {
        measure(10.0);
        first[i] = sample.measurement[0].value;
    }
    fresh(1.0);
    for (unsigned i = 0; i < 100; i++) {
        measure(10.0);
        TEST_ASSERT_EQUAL_FLOAT(first[i], sample.measurement[0].value);
    }
    TEST_ASSERT_TRUE(instruments_init(&in, &two_by_two, SEED + 1, 1.0, err, sizeof(err)));
    measure(10.0);
    TEST_ASSERT_TRUE(first[0] != sample.measurement[0].value);
}

static void changing_one_sensor_leaves_the_noise_of_the_others_as_it_was(void)
{
    float first[50];
    fresh(1.0);
    for (unsigned i = 0; i < 50; i++) {
        measure(10.0);
        first[i] = sample.measurement[1].value;
    }
    fresh(1.0);
    instruments_set(&in, Y1, OPTION_NOISE, 0.0);
    for (unsigned i = 0; i < 50; i++) {
        measure(10.0);
        TEST_ASSERT_EQUAL_FLOAT(first[i], sample.measurement[1].value);
    }
}

/* The plant with a first output that is an analyser. */
static bool with_analyser(double every_s, double delay_s, double tick_s)
{
    static struct plant_channel channels[6];
    static struct plant_class class;
    class = two_by_two;
    memcpy(channels, two_by_two.channels, sizeof(channels));
    channels[Y1].every_s = every_s;
    channels[Y1].delay_s = delay_s;
    class.channels = channels;
    TEST_ASSERT_TRUE(instruments_init(&in, &class, SEED, 0.0, err, sizeof(err)));
    return instruments_analysers(&in, tick_s, err, sizeof(err));
}

static void an_analyser_of_the_plant_shows_in_its_turn_what_was_sampled_before(void)
{
    double truth[40];
    TEST_ASSERT_TRUE_MESSAGE(with_analyser(50.0, 20.0, 10.0), err);
    TEST_ASSERT_TRUE(two_by_two.set_input(plant, D, 5.0, err, sizeof(err)));
    for (unsigned n = 0; n < 40; n++) {
        truth[n] = two_by_two.value(plant, Y1);
        measure(10.0);
        unsigned turn = n - n % 5;
        TEST_ASSERT_EQUAL_FLOAT(truth[turn >= 2 ? turn - 2 : 0], sample.measurement[0].value);
        TEST_ASSERT_EQUAL_FLOAT(two_by_two.value(plant, Y2), sample.measurement[1].value);
        TEST_ASSERT_TRUE(two_by_two.advance(plant, 10.0 * (n + 1), err, sizeof(err)));
    }
}

static void an_analyser_whose_times_are_no_whole_ticks_is_refused_in_words(void)
{
    TEST_ASSERT_TRUE(with_analyser(0.0, 30.0, 10.0));
    TEST_ASSERT_TRUE(with_analyser(0.3, 0.2, 0.1));
    TEST_ASSERT_FALSE(with_analyser(50.0, 20.0, 7.0));
    TEST_ASSERT_EQUAL_STRING(
        "plant two_by_two: y1 has a new value every 50 s, sampled 20 s before; "
        "both must be whole ticks of 7 s, at most 10000 and 100 of them",
        err);
    TEST_ASSERT_FALSE(with_analyser(50.0, 25.0, 10.0));
    TEST_ASSERT_FALSE(with_analyser(5.0, 0.0, 10.0));
    TEST_ASSERT_FALSE(with_analyser(10.0, 1010.0, 10.0));
}

static void an_actuator_without_limits_applies_the_command_at_once(void)
{
    command(35.0f, 40.0f);
    drive(10.0);
    TEST_ASSERT_EQUAL_DOUBLE(35.0, two_by_two.value(plant, U1));
    measure(10.0);
    TEST_ASSERT_EQUAL_FLOAT(35.0f, sample.readback[0].value);
    TEST_ASSERT_EQUAL_FLOAT(40.0f, sample.readback[1].value);
}

static void a_command_is_clipped_at_the_limits_and_the_readback_says_so(void)
{
    command(1e9f, -1e9f);
    instruments_set(&in, U1, OPTION_HI, 60.0);
    drive(10.0);
    measure(10.0);
    TEST_ASSERT_EQUAL_FLOAT(60.0f, sample.readback[0].value);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, sample.readback[1].value);
    instruments_set(&in, U1, OPTION_HI, 100.0); /* recovered: the command still stands */
    drive(10.0);
    TEST_ASSERT_EQUAL_DOUBLE(100.0, in.actuator[0].applied);
}

static void a_slow_actuator_delivers_the_mean_of_its_way(void)
{
    instruments_set(&in, U1, OPTION_SLEW, 2.0); /* 20 to 50 takes 15 s */
    command(50.0f, 30.0f);
    drive(10.0); /* 20 to 40 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 30.0, in.actuator[0].applied);
    drive(10.0); /* 40 to 50 in 5 s, then 5 s at 50 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 47.5, in.actuator[0].applied);
    drive(10.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 50.0, in.actuator[0].applied);
    command(49.0f, 30.0f); /* and down: 0.5 s of ramp */
    drive(10.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 49.0 + 0.5 * 0.5 / 10.0, in.actuator[0].applied);
}

static void an_actuator_lag_delivers_the_exact_mean(void)
{
    const double tau = 8.0;
    instruments_set(&in, U1, OPTION_LAG, tau);
    command(60.0f, 30.0f);
    drive(10.0);
    double e = exp(-10.0 / tau);
    double mean = 60.0 - 40.0 * tau / 10.0 * (1.0 - e);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * 60.0, mean, in.actuator[0].applied);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * 60.0, 60.0 - 40.0 * e, in.actuator[0].output);
}

static void a_stuck_actuator_ignores_commands_until_it_is_free(void)
{
    instruments_set(&in, U1, OPTION_STUCK, 33.0);
    command(80.0f, 30.0f);
    drive(10.0);
    TEST_ASSERT_EQUAL_DOUBLE(33.0, two_by_two.value(plant, U1));
    instruments_set(&in, U1, OPTION_FREE, 1.0);
    drive(10.0);
    TEST_ASSERT_EQUAL_DOUBLE(80.0, two_by_two.value(plant, U1));
}

static void outputs_that_are_not_driven_keep_their_value_and_silence_means_safe(void)
{
    command(50.0f, 60.0f);
    drive(10.0);
    struct link_command c = {.n_outputs = 2};
    c.output[0].value = 0.0f;
    c.output[0].drive = false;
    c.output[1].value = 70.0f;
    c.output[1].drive = true;
    instruments_command(&in, &c);
    drive(10.0);
    TEST_ASSERT_EQUAL_DOUBLE(50.0, two_by_two.value(plant, U1));
    TEST_ASSERT_EQUAL_DOUBLE(70.0, two_by_two.value(plant, U2));
    instruments_safe(&in);
    drive(10.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, two_by_two.value(plant, U1));
    TEST_ASSERT_EQUAL_DOUBLE(5.0, two_by_two.value(plant, U2));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_perfect_sensor_reads_the_plant);
    RUN_TEST(bias_is_added_and_clipping_at_the_span_is_uncertain);
    RUN_TEST(readings_are_multiples_of_the_resolution);
    RUN_TEST(a_forced_quality_is_sent_and_a_missing_reading_is_zero);
    RUN_TEST(a_sensor_lag_follows_a_straight_line_exactly);
    RUN_TEST(noise_has_the_stated_mean_and_deviation);
    RUN_TEST(the_random_source_gives_its_published_numbers);
    RUN_TEST(the_same_seed_gives_the_same_readings_and_another_seed_others);
    RUN_TEST(changing_one_sensor_leaves_the_noise_of_the_others_as_it_was);
    RUN_TEST(an_analyser_of_the_plant_shows_in_its_turn_what_was_sampled_before);
    RUN_TEST(an_analyser_whose_times_are_no_whole_ticks_is_refused_in_words);
    RUN_TEST(an_actuator_without_limits_applies_the_command_at_once);
    RUN_TEST(a_command_is_clipped_at_the_limits_and_the_readback_says_so);
    RUN_TEST(a_slow_actuator_delivers_the_mean_of_its_way);
    RUN_TEST(an_actuator_lag_delivers_the_exact_mean);
    RUN_TEST(a_stuck_actuator_ignores_commands_until_it_is_free);
    RUN_TEST(outputs_that_are_not_driven_keep_their_value_and_silence_means_safe);
    return UNITY_END();
}
