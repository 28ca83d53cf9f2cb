/* identify/guard.[ch].
 *
 * Contract (both scalar types), first-order responses with dead time L, samples h apart:
 *   noise-free, at every sample from L + h on
 *       L known      true peak <= predicted
 *       L not known  true peak <= predicted + v L, v the slope now
 *   when it trips    true peak <= limit + one sample's motion + v L, v the steepest slope
 *   with noise       no trip of a response that stays below 0.7 of its limit, in 500 runs
 * The source's rule v t alone is below y itself once the response bends; its worst is printed.
 */
#include <string.h>

#include "identify/common.h"
#include "identify/guard.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20240611u

static struct guard guard;
static struct guard_config config;

void setUp(void) {}
void tearDown(void) {}

static void start(double limit, double dead, double noise)
{
    config =
        (struct guard_config){.outputs = 1, .h_s = 1, .blanking_s = 0, .noise_share = (real_t)0.05};
    config.output[0] = (struct guard_output){0, (real_t)limit, (real_t)noise, (real_t)dead};
    TEST_ASSERT_EQUAL_INT(ERR_OK, guard_init(&guard, &config));
}

static int step_one(double y)
{
    int trip = -2;
    real_t value = (real_t)y;
    TEST_ASSERT_EQUAL_INT(ERR_OK, guard_step(&guard, &value, &trip));
    return trip;
}

/* Peak of the response when the negative half begins after k samples. */
static double true_peak(const struct test_element *e, double k)
{
    return e->gain * -expm1(-k / e->lag);
}

static struct test_element random_element(struct random_source *source)
{
    struct test_element e = {1.0, spread_over(source, 3.0, 300.0), 0.0};
    e.dead = random_below(source, 3) ? e.lag * spread_over(source, 0.02, 5.0) : 0.0;
    return e;
}

static void no_prediction_is_below_the_true_peak(void)
{
    struct random_source source = {SEED};
    double source_worst = 0.0;
    for (int i = 0; i < 400; i++) {
        struct test_element e = random_element(&source);
        bool known = i % 2;
        start(1e6, known ? e.dead : 0.0, 0.0);
        uint32_t n = (uint32_t)(3.0 * e.lag + e.dead) + 5;
        for (uint32_t k = 0; k < n; k++) {
            TEST_ASSERT_EQUAL_INT(-1, step_one(step_response(&e, k)));
            if (k < e.dead + 1.0 || k < 2)
                continue;
            struct guard_prediction p;
            TEST_ASSERT_EQUAL_INT(ERR_OK, guard_predict(&guard, 0, &p));
            double slope = exp(-(k - e.dead) / e.lag) / e.lag, peak = true_peak(&e, k);
            TEST_ASSERT_TRUE(peak <= (double)p.predicted + (known ? 0.0 : slope * e.dead) + 1e-5);
            double short_of = peak - (double)p.source;
            source_worst = short_of > source_worst ? short_of : source_worst;
        }
    }
    char text[120];
    snprintf(text, sizeof text,
             "seed %u, 400 plants: v t alone falls short of the peak by up to %.2f of the gain",
             SEED, source_worst);
    TEST_MESSAGE(text);
    TEST_ASSERT_TRUE(source_worst > 0.5); /* or the additions to the rule were not needed */
}

static void after_a_trip_the_peak_is_over_by_a_samples_motion_and_the_dead_time_at_most(void)
{
    struct random_source source = {SEED};
    int trips = 0;
    double worst = 0.0;
    for (int i = 0; i < 2000; i++) {
        struct test_element e = random_element(&source);
        double limit = spread_over(&source, 0.05, 2.0), sign = i % 2 ? 1.0 : -1.0,
               steepest = 1.0 / e.lag;
        start(limit, i % 3 ? e.dead : 0.0, 0.0);
        uint32_t n = (uint32_t)(8.0 * e.lag + e.dead) + 5, k = 0;
        int trip = -1;
        for (; k < n && trip < 0; k++)
            trip = step_one(sign * step_response(&e, k));
        if (trip < 0) {
            TEST_ASSERT_TRUE(true_peak(&e, n) <= limit + steepest * e.dead);
            continue;
        }
        double over = true_peak(&e, k - 1) - limit, allowed = steepest * (1.0 + e.dead);
        /* below 3 samples nothing trips */
        allowed += k <= 3 ? steepest : 0.0;
        TEST_ASSERT_TRUE(over <= allowed + 1e-5);
        worst = over / allowed > worst ? over / allowed : worst;
        trips++;
    }
    char text[120];
    snprintf(text, sizeof text,
             "seed %u, %d trips: peak over the limit by at most %.2f of what is allowed", SEED,
             trips, worst);
    TEST_MESSAGE(text);
    TEST_ASSERT_GREATER_THAN_INT(1000, trips);
}

/* A ramp after a dead time nobody knows: there the source's rule is exact. */
static void the_peak_of_a_ramp_is_the_sources(void)
{
    struct guard_prediction p;
    start(10, 0, 0);
    for (int k = 0; k <= 60; k++)
        (void)step_one(k > 20 ? 0.01 * (k - 20) : 0.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, guard_predict(&guard, 0, &p));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.6, (double)p.source); /* 0.01 * 60 = y(60 + 20) */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.6, (double)p.predicted);
    TEST_ASSERT_EQUAL_UINT32(2, p.window);
}

static void noise_trips_nothing_and_costs_little(void)
{
    struct random_source source = {SEED};
    int missed = 0;
    double worst = 0.0;
    for (int i = 0; i < 500; i++) {
        struct test_element e = {0.7, spread_over(&source, 20.0, 300.0), 0.0};
        double noise = 0.02;
        uint32_t n = (uint32_t)(5.0 * e.lag);
        start(1.0, 0.0, noise);
        for (uint32_t k = 0; k < n; k++) /* y: 0.7; v t: 0.7/e */
            TEST_ASSERT_EQUAL_INT(-1, step_one(step_response(&e, k) + noise * normal(&source)));
        e.gain = 2.0;
        start(1.0, 0.0, noise);
        uint32_t k = 0;
        int trip = -1;
        for (; k < n && trip < 0; k++)
            trip = step_one(step_response(&e, k) + noise * normal(&source));
        missed += trip < 0;
        double over = true_peak(&e, k - 1) - 1.0;
        worst = over > worst ? over : worst;
    }
    char text[120];
    snprintf(text, sizeof text,
             "seed %u: noise of 2 %% of the limit, peak over it by at most %.1f %%", SEED,
             100.0 * worst);
    TEST_MESSAGE(text);
    TEST_ASSERT_EQUAL_INT(0, missed);
    TEST_ASSERT_TRUE(worst < 0.1);
}

static void nothing_trips_while_blanked(void)
{
    start(0.1, 0, 0);
    config.blanking_s = 30;
    TEST_ASSERT_EQUAL_INT(ERR_OK, guard_init(&guard, &config));
    for (int k = 0; k < 30; k++)
        TEST_ASSERT_EQUAL_INT(-1,
                              step_one(-0.02 * k)); /* the wrong way, at a rate that would trip */
    TEST_ASSERT_EQUAL_INT(0, step_one(-0.6));
}

static void the_output_most_over_its_limit_is_named(void)
{
    config = (struct guard_config){.outputs = 3, .h_s = 2, .noise_share = (real_t)0.05};
    config.output[0] = (struct guard_output){1, 10, 0, 0};
    config.output[1] = (struct guard_output){0, (real_t)0.5, 0, 0};
    config.output[2] = (struct guard_output){-1, (real_t)0.5, 0, 0};
    TEST_ASSERT_EQUAL_INT(ERR_OK, guard_init(&guard, &config));
    int trip = -1;
    for (int k = 0; k < 100 && trip < 0; k++) {
        real_t y[3] = {1, (real_t)(0.01 * k), (real_t)(-1 - 0.02 * k)};
        TEST_ASSERT_EQUAL_INT(ERR_OK, guard_step(&guard, y, &trip));
    }
    TEST_ASSERT_EQUAL_INT(2, trip);
}

static struct fopdt_fit_result fit_so_far(const struct test_element *e, uint32_t k, double noise,
                                          struct random_source *source)
{
    static struct record record;
    static struct fopdt_fit fit;
    struct fopdt_fit_result r;
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, 1, 1));
    for (uint32_t i = 0; i <= 40 + k; i++) {
        real_t y = (real_t)(0.1 * step_response(e, (double)i - 40.0) + noise * normal(source));
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &y));
        if (i == 40)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, (real_t)0.1));
    }
    struct fopdt_fit_options o = {.baseline = {.noise_sd = (real_t)noise}, .free_offset = true};
    TEST_ASSERT_EQUAL_INT(ERR_OK, fopdt_fit_begin(&fit, &record, 0, &o));
    TEST_ASSERT_TRUE(fopdt_fit_run(&fit, FOPDT_FIT_UNITS_MAX));
    TEST_ASSERT_EQUAL_INT(ERR_OK, fopdt_fit_result(&fit, &r));
    return r;
}

/* Long before gain and lag are known apart, their product is, and with it the peak. */
static void the_fitted_model_predicts_the_peak_within_its_own_margin(void)
{
    struct random_source source = {SEED};
    int within = 0, runs = 0;
    double line_error = 0.0, model_error = 0.0;
    for (int i = 0; i < 300; i++) {
        struct test_element e = {1.0, spread_over(&source, 30.0, 300.0), 0.0};
        e.dead = uniform(&source, 0.0, 0.5) * e.lag;
        uint32_t k = (uint32_t)(e.dead + uniform(&source, 0.3, 2.5) * e.lag);
        struct fopdt_fit_result r = fit_so_far(&e, k, 0.002, &source);
        real_t peak, sd;
        TEST_ASSERT_EQUAL_INT(ERR_OK, guard_model_peak(&r, (real_t)0.1, (real_t)k, &peak, &sd));
        double truth = 0.1 * true_peak(&e, k);
        within += fabs((double)peak - truth) < 2.0 * (double)sd;
        model_error += fabs((double)peak - truth) / truth;
        struct guard_prediction p;
        start(0.2, 0.0, 0.002);
        for (uint32_t j = 0; j <= k; j++)
            (void)step_one(0.1 * step_response(&e, j) + 0.002 * normal(&source));
        TEST_ASSERT_EQUAL_INT(ERR_OK, guard_predict(&guard, 0, &p));
        line_error += fabs((double)p.predicted - truth) / truth;
        runs++;
    }
    char text[160];
    snprintf(text, sizeof text,
             "seed %u: true peak within 2 sd in %d of %d; mean error: model %.1f %%, line %.1f %%",
             SEED, within, runs, 100.0 * model_error / runs, 100.0 * line_error / runs);
    TEST_MESSAGE(text);
    TEST_ASSERT_GREATER_THAN_INT(270, within);
    TEST_ASSERT_TRUE(model_error < line_error);
}

static void a_model_without_gain_says_what_the_noise_could_hide(void)
{
    struct fopdt_fit_result r = {
        .element = {.gain = (real_t)0.3, .gain_sd = (real_t)0.2, .flags = IDENTIFIED_NO_GAIN},
        .slope_per_s = (real_t)1e-3};
    real_t peak, sd;
    TEST_ASSERT_EQUAL_INT(ERR_OK, guard_model_peak(&r, (real_t)-0.1, 50, &peak, &sd));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, (double)peak); /* the drift goes on */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.02, (double)sd);
    r.element.gain = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, guard_model_peak(&r, 1, 50, &peak, &sd));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, guard_model_peak(&r, (real_t)NAN, 50, &peak, &sd));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, guard_model_peak(&r, 1, -1, &peak, &sd));
}

static void what_cannot_be_is_refused(void)
{
    int trip = 7;
    struct guard_prediction p;
    real_t nan = (real_t)NAN;
    start(1, 0, 0);
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, guard_predict(&guard, 0, &p));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, guard_predict(&guard, 1, &p));
    struct guard was = guard;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, guard_step(&guard, &nan, &trip));
    TEST_ASSERT_EQUAL_INT(7, trip);
    struct guard_config c = config;
    c.output[0].limit = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, guard_init(&guard, &c));
    c = config;
    c.output[0].noise_sd = nan;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, guard_init(&guard, &c));
    c = config;
    c.outputs = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, guard_init(&guard, &c));
    c = config;
    c.noise_share = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, guard_init(&guard, &c));
    TEST_ASSERT_EQUAL_MEMORY(&was, &guard, sizeof was);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(no_prediction_is_below_the_true_peak);
    RUN_TEST(after_a_trip_the_peak_is_over_by_a_samples_motion_and_the_dead_time_at_most);
    RUN_TEST(the_peak_of_a_ramp_is_the_sources);
    RUN_TEST(noise_trips_nothing_and_costs_little);
    RUN_TEST(nothing_trips_while_blanked);
    RUN_TEST(the_output_most_over_its_limit_is_named);
    RUN_TEST(the_fitted_model_predicts_the_peak_within_its_own_margin);
    RUN_TEST(a_model_without_gain_says_what_the_noise_could_hide);
    RUN_TEST(what_cannot_be_is_refused);
    return UNITY_END();
}
