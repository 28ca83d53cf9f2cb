/* identify/settling.[ch].
 *
 * Contract (both scalar types)
 *   noise-free step      t_98 within one point of the record and 1 % of L + 3.912 T
 *   noise of 0.3 % of the change, 2 % and 5 %: median of 200 within 5 %, 10 % and 20 %
 */
#include <stdlib.h>

#include "identify/common.h"
#include "identify/settling.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20240612u

static struct record record;

void setUp(void) {}
void tearDown(void) {}

static void take(const struct test_element *e, uint32_t before, uint32_t samples, double noise,
                 struct random_source *source)
{
    real_t reference = (real_t)0.4;
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, 1, 2));
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_begin(&record, &reference));
    for (uint32_t k = 0; k < samples; k++) {
        real_t y = (real_t)(0.4 + step_response(e, (double)k - before) +
                            (source ? noise * normal(source) : 0.0));
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &y));
        if (k == before)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, (real_t)0.1));
    }
}

static void omega_of_a_first_order_step_is_4_over_its_98_percent_time(void)
{
    struct random_source source = {SEED};
    for (int i = 0; i < 100; i++) {
        struct test_element e = {i % 2 ? 0.05 : -0.2, spread_over(&source, 20.0, 2000.0), 0.0};
        e.dead = uniform(&source, 0.0, 0.5) * e.lag;
        struct settling s;
        take(&e, (uint32_t)e.lag, (uint32_t)(9.0 * e.lag + e.dead), 0.0, NULL);
        TEST_ASSERT_EQUAL_INT(ERR_OK, settling_from_record(&record, 0, &s));
        double want = 2.0 * (e.dead + 3.912023 * e.lag);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * want + 2.0 * record.block, want, (double)s.t_98_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 4.0 / (double)s.t_98_s, (double)s.omega_per_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.005 * fabs(e.gain), e.gain, (double)s.change);
        /* the model's is the same */
        struct identified m = {.time_constant_s = (real_t)(2.0 * e.lag),
                               .dead_time_s = (real_t)(2.0 * e.dead)};
        real_t t_98, omega;
        TEST_ASSERT_EQUAL_INT(ERR_OK, settling_from_model(&m, &t_98, &omega));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * want, want, (double)t_98);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * 4.0 / want, 4.0 / want, (double)omega);
    }
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void noise_is_averaged_until_the_band_stands_out_of_it(void)
{
    struct random_source source = {SEED};
    struct test_element e = {0.1, 300.0, 50.0};
    const double noise[] = {0.003, 0.02, 0.05}, bound[] = {0.05, 0.1, 0.2};
    for (int level = 0; level < 3; level++) {
        double found[200];
        int n = 0;
        for (int i = 0; i < 200; i++) {
            struct settling s;
            take(&e, 300, 3500, 0.1 * noise[level], &source);
            enum err err = settling_from_record(&record, 0, &s);
            if (err) {
                TEST_ASSERT_EQUAL_INT(ERR_RANGE, err); /* says so rather than guess */
                continue;
            }
            TEST_ASSERT_TRUE(level < 2 || s.mean_of > 1);
            found[n++] = (double)s.t_98_s;
        }
        TEST_ASSERT_GREATER_THAN_INT(150, n);
        qsort(found, (size_t)n, sizeof found[0], ascending);
        double want = 2.0 * (50.0 + 3.912023 * 300.0);
        char text[100];
        snprintf(text, sizeof text, "noise %.1f %%: %d of 200, median %+.1f %%", 100 * noise[level],
                 n, 100.0 * (found[n / 2] / want - 1.0));
        TEST_MESSAGE(text);
        TEST_ASSERT_DOUBLE_WITHIN(bound[level], 1.0, found[n / 2] / want);
    }
}

static void what_gives_no_answer_is_refused(void)
{
    struct random_source source = {SEED};
    struct test_element e = {0.1, 300.0, 0.0}, none = {0.0, 300.0, 0.0};
    struct settling s;
    take(&e, 300, 1200, 0.0, NULL); /* still on its way */
    TEST_ASSERT_EQUAL_INT(ERR_STATE, settling_from_record(&record, 0, &s));
    take(&e, 2, 3000, 0.0, NULL); /* no level to begin from */
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, settling_from_record(&record, 0, &s));
    take(&none, 300, 3000, 0.001, &source);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, settling_from_record(&record, 0, &s));
    take(&none, 300, 3000, 0.0, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, settling_from_record(&record, 0, &s));
    take(&e, 300, 3000, 0.0, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, settling_from_record(&record, 1, &s));
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, 0));
    TEST_ASSERT_EQUAL_INT(ERR_STATE, settling_from_record(&record, 0, &s));
    struct identified m = {.time_constant_s = 0, .dead_time_s = 0};
    real_t t_98, omega;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, settling_from_model(&m, &t_98, &omega));
    m.time_constant_s = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, settling_from_model(&m, &t_98, &omega));
    m.time_constant_s = -1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, settling_from_model(&m, &t_98, &omega));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(omega_of_a_first_order_step_is_4_over_its_98_percent_time);
    RUN_TEST(noise_is_averaged_until_the_band_stands_out_of_it);
    RUN_TEST(what_gives_no_answer_is_refused);
    return UNITY_END();
}
