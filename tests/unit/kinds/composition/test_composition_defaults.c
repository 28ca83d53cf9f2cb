/* What a filter takes where nobody gives a number, and how sure its points are. Whether these numbers are right is a campaign's affair
 * (tests/campaign/composition); here is what they do. */
#include "composition_filter_bench.h"
#include "random_source.h"

static struct random_source source;

void setUp(void)
{
    bench_filter(METHOD_EKF, COVARIANCE_FULL);
    all_settings.noise = all_settings.model = 0;
    source.state = 1;
}
void tearDown(void)
{
    bench_frees();
}

/* Twelve uniform numbers: a standard deviation of 1. */
static float normal(void)
{
    float sum = -6;
    for (unsigned k = 0; k < 12; k++)
        sum += (float)random_below(&source, 1u << 20) / (float)(1u << 20);
    return sum;
}

static void run_with_noise(float noise, unsigned n)
{
    while (n-- > 0) {
        plant_runs(1);
        for (unsigned k = T_LOW; k <= T_COMPARED; k++)
            put(k, truth(all_settings.s.place[k][AT_STAGE]) + noise * normal());
        tick_of(&filter);
    }
}

static void a_noise_that_nobody_gives_is_that_of_the_readings(void)
{
    begin_both();
    run_with_noise(0.3f, 3 * WATCHES);
    for (unsigned k = 0; k < 2; k++)
        TEST_ASSERT_FLOAT_WITHIN(0.05f, 0.3f, sqrtf((float)filter.b->sensors.sensor[k].noise2));
    TEST_ASSERT_FLOAT_WITHIN(0.4f, 1, value_named("nis_1"));
    TEST_ASSERT_FALSE(raised(EVENT_NIS));
}

static void the_least_noise_that_is_found_is_a_twentieth_of_a_kelvin(void)
{
    begin_both();
    run_with_noise(0, WATCHES);
    TEST_ASSERT_EQUAL_FLOAT(0.0025f, (float)filter.b->sensors.sensor[0].noise2);
}

static void a_noise_that_is_given_stays(void)
{
    all_settings.noise = 0.1f;
    begin_both();
    run_with_noise(0.3f, WATCHES);
    TEST_ASSERT_EQUAL_FLOAT(0.01f, (float)filter.b->sensors.sensor[0].noise2);
}

static void only_a_whole_covariance_of_the_moment_trusts_its_model(void)
{
    static const struct {
        enum composition_method method;
        enum composition_covariance covariance;
        float model;
    } ways[] = {{METHOD_EKF, COVARIANCE_FULL, 0.011f},
                {METHOD_EKF, COVARIANCE_BAND, 0.1f},
                {METHOD_EKF, COVARIANCE_STEADY, 0.1f},
                {METHOD_KALMAN, COVARIANCE_FULL, 0.1f},
                {METHOD_REKF, COVARIANCE_FULL, 0.1f}};
    for (unsigned i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        static struct composition_sensors all;
        all_settings.s.method = (uint8_t)ways[i].method;
        all_settings.s.covariance = (uint8_t)ways[i].covariance;
        memset(&all, 0, sizeof all);
        composition_sensors_set(&all, &setup);
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, ways[i].model, sqrtf(3600 * (float)all.model2));
        TEST_ASSERT_EQUAL(i == 0, all.finds_noise);
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, i == 0 ? 0.05f : 0.2f, sqrtf((float)all.sensor[0].noise2));
    }
}

static void the_feeds_flow_is_looked_for_where_nobody_measures_it(void)
{
    all_settings.s.feed_f = -1;
    TEST_ASSERT_EQUAL_FLOAT(0, (float)composition_feed_f(&all_settings.s, setup.inputs));
    all_settings.s.role[FEED] = IS_PRESSURE;
    TEST_ASSERT_EQUAL_FLOAT(0.1f, (float)composition_feed_f(&all_settings.s, setup.inputs));
    all_settings.s.feed_f = 0;
    TEST_ASSERT_EQUAL_FLOAT(0, (float)composition_feed_f(&all_settings.s, setup.inputs));
    all_settings.s.feed_f = 0.3f;
    TEST_ASSERT_EQUAL_FLOAT(0.3f, (float)composition_feed_f(&all_settings.s, setup.inputs));
}

/* It begins in the plant's state, with the impurities of the table: 0.005 in the distillate, 0.2 in the bottoms. */
static void has_found_its_plant(void)
{
    begin_both();
    run_with_noise(0, LOCKED + 10);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[TOP_FRACTION]);
}

static void what_the_model_is_off_by_for_good_is_part_of_the_impurity(void)
{
    has_found_its_plant();
    filter.b->filter.certainty.sd[TOP_FRACTION] = filter.b->filter.certainty.sd[BOTTOM_FRACTION] =
        0;
    filter.b->s.lasting = 0.25f;
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.25f * (1 - fraction(12)), value_named("sd_1"));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.25f * fraction(1), value_named("sd_2"));
    TEST_ASSERT_TRUE(value_named("sd_3") < 0.2f); /* K: it has none */
}

static void innovations_larger_than_expected_widen_the_standard_deviation(void)
{
    has_found_its_plant();
    filter.b->watch.sensor[0].square = filter.b->watch.sensor[1].square = 0.5f;
    float sd = value_named("sd_1");
    filter.b->watch.sensor[1].square = 4;
    TEST_ASSERT_FLOAT_WITHIN(1e-4f * sd, 2 * sd, value_named("sd_1"));
}

static void innovations_off_to_one_side_raise_nis_where_the_model_is_trusted(void)
{
    for (unsigned trusts = 0; trusts < 2; trusts++) {
        setUp();
        all_settings.noise = trusts ? 0 : 0.2f;
        begin_both();
        run_with_noise(0, WATCHES);
        TEST_ASSERT_FALSE(raised(EVENT_NIS));
        filter.b->watch.sensor[1].mean = -0.5f;
        run_with_noise(0, 1);
        TEST_ASSERT_EQUAL(trusts, raised(EVENT_NIS));
    }
}

static void a_point_is_uncertain_that_is_not_known_to_a_part_of_its_impurity(void)
{
    has_found_its_plant();
    filter.b->s.sure = 0;
    filter.b->s.sure_part = 0.5f;
    filter.b->s.lasting = 0.4f;
    run_with_noise(0, 1);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[TOP_FRACTION]);
    filter.b->s.lasting = 0.6f;
    run_with_noise(0, 1);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[TOP_FRACTION]);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[BOTTOM_FRACTION]);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[INNER_TEMPERATURE]);
    filter.b->s.sure_part = 0;
    run_with_noise(0, 1);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[TOP_FRACTION]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_noise_that_nobody_gives_is_that_of_the_readings);
    RUN_TEST(the_least_noise_that_is_found_is_a_twentieth_of_a_kelvin);
    RUN_TEST(a_noise_that_is_given_stays);
    RUN_TEST(only_a_whole_covariance_of_the_moment_trusts_its_model);
    RUN_TEST(the_feeds_flow_is_looked_for_where_nobody_measures_it);
    RUN_TEST(what_the_model_is_off_by_for_good_is_part_of_the_impurity);
    RUN_TEST(innovations_larger_than_expected_widen_the_standard_deviation);
    RUN_TEST(innovations_off_to_one_side_raise_nis_where_the_model_is_trusted);
    RUN_TEST(a_point_is_uncertain_that_is_not_known_to_a_part_of_its_impurity);
    return UNITY_END();
}
