/* identify/record.[ch], identify/response.[ch].
 *
 * Contract
 *   record       every point is the mean of its samples within 1e-6 of the largest, whatever the number of halvings
 *   response     model of a block within 2e-5 of the mean of the exact response at its samples (float; 1e-7 in double,
 *                where the lag of 0 stands for 0.001 samples)
 */
#include <string.h>

#include "identify/common.h"
#include "identify/record.h"
#include "identify/response.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20240608u

static struct record record;

void setUp(void) {}
void tearDown(void) {}

static void start(uint32_t outputs)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, outputs, 2));
}

static void a_record_keeps_the_mean_of_every_block(void)
{
    static double kept[20000];
    struct random_source source = {SEED};
    const uint32_t counts[] = {1, 127, 128, 129, 256, 257, 1000, 12345, 20000};
    for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
        real_t reference[2] = {(real_t)0.5, (real_t)-0.25}, y[2];
        start(2);
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_begin(&record, reference));
        for (uint32_t k = 0; k < counts[c]; k++) {
            kept[k] = uniform(&source, -1.0, 1.0);
            y[0] = (real_t)(0.5 + kept[k]);
            y[1] = (real_t)(-0.25 - 2.0 * kept[k]);
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, y));
        }
        TEST_ASSERT_EQUAL_UINT32(counts[c], record.samples);
        TEST_ASSERT_EQUAL_UINT32(counts[c], record.points * record.block + record.waiting);
        TEST_ASSERT_TRUE(record.points <= RECORD_POINTS);
        TEST_ASSERT_TRUE(record.block == 1 || record.points >= RECORD_POINTS / 2);
        for (uint32_t i = 0; i < record.points; i++) {
            double mean = 0.0;
            for (uint32_t k = 0; k < record.block; k++)
                mean += kept[i * record.block + k] / record.block;
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, mean, (double)record.y[0][i]);
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, -2.0 * mean, (double)record.y[1][i]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, 2.0 * (i * record.block + 0.5 * (record.block - 1)),
                                      (double)record_time(&record, i));
        }
    }
}

static void a_record_knows_when_the_input_moved(void)
{
    real_t y = 0;
    start(1);
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, record_move(&record, 1));
    for (int k = 0; k < 300; k++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &y));
        if (k == 10 || k == 200)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, k == 10 ? (real_t)0.5 : 0));
    }
    TEST_ASSERT_EQUAL_UINT32(2, record.input.edges);
    TEST_ASSERT_EQUAL_UINT32(10, record_first_edge(&record));
    TEST_ASSERT_EQUAL_UINT32(200, record.input.edge[1].sample);
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, record_move(&record, (real_t)NAN));
}

static void a_record_looks_at_its_own_outputs_only(void)
{
    const real_t reference[2] = {REAL_C(3.0), (real_t)NAN};
    start(1);
    record.reference[1] = REAL_C(7.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_begin(&record, reference));
    TEST_ASSERT_TRUE(record.reference[0] == REAL_C(3.0) && record.reference[1] == REAL_C(7.0));
}

static void a_record_refuses_what_is_not_finite(void)
{
    real_t y[2] = {1, (real_t)NAN};
    start(2);
    struct record was = record;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, record_step(&record, y));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, record_begin(&record, y));
    TEST_ASSERT_EQUAL_MEMORY(&was, &record, sizeof was);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, record_init(&record, 0, 1));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, record_init(&record, CHANNEL_MAX + 1, 1));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, record_init(&record, 1, 0));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, record_init(&record, 1, (real_t)NAN));
}

static void the_model_of_a_block_is_the_mean_of_its_samples(void)
{
    const double bound = sizeof(real_t) == sizeof(float) ? 2e-5 : 1e-7;
    struct random_source source = {SEED};
    for (int i = 0; i < 500; i++) {
        real_t model[RECORD_POINTS], by_dead[RECORD_POINTS], later[RECORD_POINTS];
        uint32_t block = 1u << random_below(&source, 7);
        struct test_element e = {1.0, i % 10 ? spread_over(&source, 0.05, 3000.0) : 0.0,
                                 i % 7 ? uniform(&source, 0.0, 500.0)
                                       : (double)random_below(&source, 30)};
        uint32_t at = random_below(&source, 200), t1 = 1 + random_below(&source, 3000);
        struct excitation u;
        TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, at, t1, t1, 1));
        e.lag = (double)(real_t)e.lag;
        e.dead = (double)(real_t)e.dead;
        response_model(&u, (real_t)e.lag, (real_t)e.dead, block, RECORD_POINTS, model, by_dead);
        for (uint32_t p = 0; p < RECORD_POINTS; p++) {
            double mean = 0.0;
            for (uint32_t k = 0; k < block; k++)
                mean += double_step_response(&e, t1, t1, (double)(p * block + k) - at) / block;
            TEST_ASSERT_DOUBLE_WITHIN(bound, mean, (double)model[p]);
        }
        /* the derivative, by a difference that stays between two samples */
        double room = 1.0 - (e.dead - floor(e.dead)), step = 0.5 * room;
        if (e.lag < 1.0 || step < 0.1)
            continue;
        response_model(&u, (real_t)e.lag, (real_t)(e.dead + step), block, RECORD_POINTS, later,
                       NULL);
        for (uint32_t p = 0; p < RECORD_POINTS; p++)
            TEST_ASSERT_DOUBLE_WITHIN(2e-3 + 3.0 * step / (e.lag * e.lag),
                                      (double)(later[p] - model[p]) / step, (double)by_dead[p]);
    }
}

static void differences_of_exponentials_do_not_cancel(void)
{
    const double bound = sizeof(real_t) == sizeof(float) ? 3e-7 : 1e-13;
    double x = 1e-9;
    for (int i = 0; i < 375; i++, x *= 1.07) { /* to 100 */
        double want = -expm1(-(double)(real_t)x);
        TEST_ASSERT_DOUBLE_WITHIN(bound * want, want, (double)one_less_exp((real_t)x));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_record_keeps_the_mean_of_every_block);
    RUN_TEST(a_record_knows_when_the_input_moved);
    RUN_TEST(a_record_looks_at_its_own_outputs_only);
    RUN_TEST(a_record_refuses_what_is_not_finite);
    RUN_TEST(the_model_of_a_block_is_the_mean_of_its_samples);
    RUN_TEST(differences_of_exponentials_do_not_cancel);
    return UNITY_END();
}
