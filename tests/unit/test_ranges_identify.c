/* Arguments of identification at the ends of their ranges. */
#include "identify/fopdt_fit.h"
#include "identify/guard.h"
#include "identify/moments.h"
#include "identify/relay.h"
#include "identify/settling.h"
#include "identify/steady.h"
#include "ranges.h"

void setUp(void) {}
void tearDown(void) {}

static struct only only;

static struct guard guard;
static struct guard_config guard_config;

static enum err try_guard(void)
{
    return guard_init(&guard, &guard_config);
}

static void of_the_guard(void)
{
    static const struct range ranges[] = {
        RANGE(guard_config, h_s, 1e-3, 1e5),
        RANGE(guard_config, blanking_s, 0, 1e6),
        RANGE(guard_config, noise_share, 1e-6, 0.5),
        RANGE(guard_config, output[1].initial, -1e9, 1e9),
        RANGE(guard_config, output[1].limit, 1e-9, 1e9),
        RANGE(guard_config, output[1].noise_sd, 0, 1e9),
        RANGE(guard_config, output[1].dead_time_s, 0, 1e6),
    };
    guard_config =
        (struct guard_config){.outputs = 2, .h_s = REAL_C(1.0), .noise_share = REAL_C(0.05)};
    guard_config.output[0].limit = guard_config.output[1].limit = REAL_C(1.0);
    CHECK(guard_config, ranges, try_guard);
    guard_config.outputs = 0;
    TEST_ASSERT_EQUAL(ERR_RANGE, try_guard());
    guard_config.outputs = CHANNEL_MAX + 1;
    TEST_ASSERT_EQUAL(ERR_RANGE, try_guard());
}

static struct steady steady;
static struct steady_config steady_config;

static enum err try_steady(void)
{
    return steady_init(&steady, &steady_config);
}

static void of_rest(void)
{
    static const struct range ranges[] = {
        RANGE(steady_config, h_s, 1e-3, 1e5),
        ABOVE(steady_config, noise_floor, 0, 1e6),
        RANGE(steady_config, motion_limit, 0.1, 1e3),
        RANGE(steady_config, variance_limit, 1, 1e3),
    };
    steady_config = (struct steady_config){.outputs = 1,
                                           .block = 1,
                                           .h_s = REAL_C(1.0),
                                           .noise_floor = REAL_C(1e-3),
                                           .motion_limit = REAL_C(3.0),
                                           .variance_limit = REAL_C(4.0)};
    CHECK(steady_config, ranges, try_steady);
    steady_config.block = 0;
    TEST_ASSERT_EQUAL(ERR_RANGE, try_steady());
    steady_config.block = 1u << 24;
    TEST_ASSERT_EQUAL(ERR_OK, try_steady());
    steady_config.block++;
    TEST_ASSERT_EQUAL(ERR_RANGE, try_steady());
    steady_config.block = 1;
    for (unsigned n = 0; n <= CHANNEL_MAX + 1u; n++) {
        steady_config.outputs = n;
        TEST_ASSERT_EQUAL(n >= 1 && n <= CHANNEL_MAX ? ERR_OK : ERR_RANGE, try_steady());
    }
}

static struct moments moments;
static struct moments_config moments_config;

static enum err try_moments(void)
{
    return moments_init(&moments, &moments_config);
}

static void of_moments(void)
{
    static const struct range ranges[] = {
        RANGE(moments_config, h_s, 1e-3, 1e5),
        RANGE(moments_config, fastest, 1e-4, 1),
        RANGE(moments_config, ratio, 1.1, 10),
    };
    moments_config = (struct moments_config){.outputs = 1,
                                             .alphas = 1,
                                             .h_s = REAL_C(1.0),
                                             .fastest = REAL_C(0.5),
                                             .ratio = REAL_C(2.0)};
    CHECK(moments_config, ranges, try_moments);
    for (unsigned n = 0; n <= MOMENTS_ALPHAS_MAX + 1u; n++) {
        moments_config.alphas = n;
        TEST_ASSERT_EQUAL(n >= 1 && n <= MOMENTS_ALPHAS_MAX ? ERR_OK : ERR_RANGE, try_moments());
    }
    moments_config.alphas = 1;
    for (unsigned n = 0; n <= CHANNEL_MAX + 1u; n++) {
        moments_config.outputs = n;
        TEST_ASSERT_EQUAL(n >= 1 && n <= CHANNEL_MAX ? ERR_OK : ERR_RANGE, try_moments());
    }
}

static struct relay relay;
static struct relay_config relay_config;

static enum err try_relay(void)
{
    return relay_begin(&relay, &relay_config);
}

static void of_a_relay_test(void)
{
    static const struct range ranges[] = {
        RANGE(relay_config, h_s, 1e-3, 1e5),  RANGE(relay_config, reference, -1e12, 1e12),
        RANGE(relay_config, noise_sd, 0, 1),  ABOVE(relay_config, hysteresis, 0, 1),
        RANGE(relay_config, amplitude, 0, 1), ABOVE(relay_config, first, 0, 1),
        ABOVE(relay_config, wanted, 0, 1),
    };
    relay_config = (struct relay_config){.h_s = REAL_C(1.0),
                                         .sign = 1,
                                         .hysteresis = REAL_C(0.01),
                                         .first = REAL_C(0.1),
                                         .most = REAL_C(1.0),
                                         .wanted = REAL_C(0.05),
                                         .patience = 10,
                                         .half_most = 100};
    CHECK(relay_config, ranges, try_relay);
    static const struct {
        double amplitude, first, most;
        unsigned patience, half_most;
        int sign;
        bool good;
    } cases[] = {
        {0.3, 0.1, 0.3, 10, 100, 1, true},
        {0.301, 0.1, 0.3, 10, 100, 1, false},
        {0, 0.3, 0.3, 10, 100, -1, true},
        {0, 0.301, 0.3, 10, 100, 1, false},
        {0, 0.1, 1.001, 10, 100, 1, false},
        {0, 0.1, 0.3, 0, 100, 1, false},
        {0, 0.1, 0.3, 1, 2, 1, true},
        {0, 0.1, 0.3, 10, 10, 1, false},
        {0, 0.1, 0.3, 10, 11, 1, true},
        {0, 0.1, 0.3, 10, 1u << 28, 1, true},
        {0, 0.1, 0.3, 10, (1u << 28) + 1u, 1, false},
        {0, 0.1, 0.3, 10, 100, 0, false},
        {0, 0.1, 0.3, 10, 100, 2, false},
        {0, 0.1, 0.3, 10, 100, -2, false},
    };
    for (unsigned k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        relay_config.amplitude = (real_t)cases[k].amplitude;
        relay_config.first = (real_t)cases[k].first;
        relay_config.most = (real_t)cases[k].most;
        relay_config.patience = cases[k].patience;
        relay_config.half_most = cases[k].half_most;
        relay_config.sign = (int8_t)cases[k].sign;
        TEST_ASSERT_EQUAL_MESSAGE(cases[k].good ? ERR_OK : ERR_RANGE, try_relay(),
                                  "case of a relay");
    }
}

static struct identified model;

static enum err try_settling(void)
{
    real_t t_98, omega;
    return settling_from_model(&model, &t_98, &omega);
}

static struct baseline baseline;

static enum err try_baseline(void)
{
    return baseline_validate(&baseline);
}

static struct fopdt element;

static enum err try_element(void)
{
    return fopdt_validate(&element, NULL, NULL);
}

static struct record record;

static enum err try_record(void)
{
    return record_init(&record, 1, only.x);
}

static void of_models_and_records(void)
{
    static const struct range settling[] = {
        RANGE(identified, time_constant_s, 0, 1e9),
        RANGE(identified, dead_time_s, 0, 1e9),
    };
    static const struct range line[] = {
        RANGE(baseline, offset, -1e12, 1e12), RANGE(baseline, slope_per_s, -1e12, 1e12),
        RANGE(baseline, offset_sd, 0, 1e12),  RANGE(baseline, slope_sd_per_s, 0, 1e12),
        RANGE(baseline, noise_sd, 0, 1e12),
    };
    static const struct range first_order[] = {
        RANGE(fopdt, dead_time_s, 0, 1e6),
        ABOVE(fopdt, time_constant_s, 0, 1e6),
    };
    static const struct range interval[] = {RANGE(only, x, 1e-3, 1e5)};
    model = (struct identified){.time_constant_s = REAL_C(10.0), .dead_time_s = REAL_C(2.0)};
    CHECK(model, settling, try_settling);
    CHECK(baseline, line, try_baseline);
    element = (struct fopdt){REAL_C(1.0), REAL_C(2.0), REAL_C(20.0)};
    CHECK(element, first_order, try_element);
    only.x = REAL_C(1.0);
    CHECK(only, interval, try_record);
    for (unsigned n = 0; n <= CHANNEL_MAX + 1u; n++)
        TEST_ASSERT_EQUAL(n >= 1 && n <= CHANNEL_MAX ? ERR_OK : ERR_RANGE,
                          record_init(&record, n, REAL_C(1.0)));
}

static struct fopdt_fit fit;
static struct fopdt_fit_options options;
static struct identified start;

static enum err try_fit(void)
{
    return fopdt_fit_begin(&fit, &record, 0, &options);
}

static void of_a_fit(void)
{
    static const struct range ranges[] = {RANGE(fopdt_fit_options, time_max_s, 0, 1e9)};
    static const struct range starts[] = {
        RANGE(identified, time_constant_s, 0, 1e9),
        RANGE(identified, dead_time_s, 0, 1e9),
    };
    static const double inputs[][2] = {{1e-6, 1}, {0.999e-6, 0}, {1e6, 1}, {1.001e6, 0}};
    for (unsigned k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL(ERR_OK, record_init(&record, 1, REAL_C(1.0)));
        for (unsigned i = 0; i < 100; i++) {
            real_t y = i < 10 ? REAL_C(0.0) : REAL_C(1.0);
            TEST_ASSERT_EQUAL(ERR_OK, record_step(&record, &y));
            if (i == 5)
                TEST_ASSERT_EQUAL(ERR_OK, record_move(&record, (real_t)inputs[k][0]));
        }
        options = (struct fopdt_fit_options){.free_offset = true, .free_slope = true};
        TEST_ASSERT_EQUAL(inputs[k][1] > 0 ? ERR_OK : ERR_RANGE, try_fit());
        if (inputs[k][1] <= 0)
            continue;
        CHECK(options, ranges, try_fit);
        options.start = &start;
        CHECK(start, starts, try_fit);
        TEST_ASSERT_EQUAL(ERR_RANGE, fopdt_fit_begin(&fit, &record, 1, NULL));
    }
}

/* A plant that the first alpha is fast enough for needs no second. */
static void of_the_slowest_time_that_moments_are_for(void)
{
    real_t slowest = REAL_C(1.0) / (real_t)MOMENTS_FASTEST;
    TEST_ASSERT_EQUAL(1, moments_alphas_for(REAL_C(1.0), slowest));
    TEST_ASSERT_EQUAL(2, moments_alphas_for(REAL_C(1.0), slowest * REAL_C(1.01)));
    TEST_ASSERT_EQUAL(MOMENTS_ALPHAS_MAX, moments_alphas_for(REAL_C(1.0), REAL_C(1e9)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(of_the_guard);
    RUN_TEST(of_rest);
    RUN_TEST(of_moments);
    RUN_TEST(of_a_relay_test);
    RUN_TEST(of_models_and_records);
    RUN_TEST(of_a_fit);
    RUN_TEST(of_the_slowest_time_that_moments_are_for);
    return UNITY_END();
}
