/* commission/analysis_crossover.c: where the gain of a loop by itself is 1, and the relative gain of its pair there, beside formulas in
 * double. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "commission/analysis_crossover.h"
#include "commission/analysis_state.h"
#include "unity.h"

static struct analysis a;

/* Two loops of integral time and lag 100 s: the gain of loop k broken is gain/(100 omega), for samples that are short. */
void setUp(void)
{
    memset(&a, 0, sizeof a);
    a.plant.outputs = a.plant.inputs = a.pairs.n = 2;
    a.pairs.output[0] = 1; /* y2 by u1, y1 by u2 */
    a.pairs.input[1] = 1;
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            a.plant.element[i][j] =
                (struct fopdt){.gain = i == j ? REAL_C(0.5) : REAL_C(1.0), .time_constant_s = 100};
    for (unsigned k = 0; k < 2; k++)
        a.loops.tuning[k] =
            (struct tuning){.gain = (real_t)(k + 1), .ti_s = 100, .action = TUNING_REVERSE};
    a.loops.pairs = a.pairs;
    a.loops.interval_s = a.config.h_s = REAL_C(0.1);
    a.loops.derivative_filter = 8;
}
void tearDown(void) {}

static double response(unsigned i, unsigned j, double omega)
{
    const struct fopdt *e = &a.plant.element[i][j];
    double complex lag = 1.0 + I * omega * (double)e->time_constant_s;
    return (double)e->gain / cabs(lag);
}

static void find(uint8_t k)
{
    analysis_crossover_begin(&a, k);
    while (analysis_crossover_step(&a, k) == ERR_BUSY)
        ;
}

static void every_loop_has_the_frequency_at_which_its_own_gain_is_1(void)
{
    for (uint8_t k = 0; k < 2; k++) {
        find(k);
        TEST_ASSERT_DOUBLE_WITHIN(2e-5 * (k + 1), 0.01 * (k + 1), (double)a.crossover[k]);
    }
}

static void gains_that_are_large_or_small_move_it_as_far(void)
{
    for (unsigned n = 0; n < 5; n++) {
        double gain = pow(10.0, (double)n - 3.0);
        a.loops.tuning[0].gain = (real_t)gain;
        find(0);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * gain / 100, gain / 100, (double)a.crossover[0]);
    }
}

static void it_is_half_of_the_sampling_frequency_at_most(void)
{
    a.loops.tuning[0].gain = 1e4f;
    find(0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 31.4159265, (double)a.crossover[0]);
}

static void alike_lags_leave_the_relative_gain_what_it_is_at_rest(void)
{
    for (uint8_t k = 0; k < 2; k++) {
        find(k);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0 / (1.0 - 0.25), (double)a.crossover_lambda[k]);
    }
}

static void a_slow_way_across_matters_less_where_the_loops_act(void)
{
    a.plant.element[0][0].time_constant_s = 2000; /* from u1 to y1, across */
    for (uint8_t k = 0; k < 2; k++) {
        find(k);
        double omega = (double)a.crossover[k];
        double complex across = 0.5 / (1.0 + I * omega * 2000.0) * 0.5 / (1.0 + I * omega * 100.0);
        double complex own = 1.0 / cpow(1.0 + I * omega * 100.0, 2);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, cabs(1.0 / (1.0 - across / own)),
                                  (double)a.crossover_lambda[k]);
        TEST_ASSERT_TRUE((double)a.crossover_lambda[k] < 1.1);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, 1.0,
                                  response(k == 0, k != 0, omega) * (k + 1) *
                                      cabs(1.0 + 1.0 / (I * omega * 100.0)));
    }
}

static void a_pair_without_relative_gain_has_none_there_either(void)
{
    for (unsigned i = 0; i < 2; i++)
        a.plant.element[i][i].gain = 1;
    find(0);
    TEST_ASSERT_EQUAL_FLOAT(0, a.crossover[0]);
    TEST_ASSERT_EQUAL_FLOAT(0, a.crossover_lambda[0]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_loop_has_the_frequency_at_which_its_own_gain_is_1);
    RUN_TEST(gains_that_are_large_or_small_move_it_as_far);
    RUN_TEST(it_is_half_of_the_sampling_frequency_at_most);
    RUN_TEST(alike_lags_leave_the_relative_gain_what_it_is_at_rest);
    RUN_TEST(a_slow_way_across_matters_less_where_the_loops_act);
    RUN_TEST(a_pair_without_relative_gain_has_none_there_either);
    return UNITY_END();
}
