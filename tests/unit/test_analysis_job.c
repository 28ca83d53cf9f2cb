/* commission/analysis_job.c: elements as tests may find them, far beyond what the analysis takes, do not end it with an error. */
#include "commission/analysis_job.h"
#include "commission_outcome.h"

#include <complex.h>

static struct shape_found *found(unsigned output, unsigned input, struct shape shape)
{
    struct shape_found *f = &c.work->element[output][input].found;
    *f = (struct shape_found){.kind = SHAPE_ONE_LAG, .parameters = 3, .shape = shape};
    f->sd[SHAPE_GAIN] = REAL_C(0.01);
    return f;
}

void setUp(void)
{
    outcome_begin();
    commission_lease(&c);
    for (unsigned j = 0; j < 2; j++)
        for (unsigned k = 0; k < 2; k++)
            found(j, k,
                  (struct shape){
                      .gain = j == k ? REAL_C(1.0) : REAL_C(0.2), .lag_s = 100, .dead_time_s = 5});
}
void tearDown(void) {}

static const struct interact_plant *analysed(void)
{
    analysis_job_begin(&c, cf, 2);
    unsigned pieces = 0;
    while (analysis_job_piece(&c))
        TEST_ASSERT_LESS_THAN_UINT(10000000, ++pieces);
    TEST_ASSERT_EQUAL_INT(ERR_OK, c.analysis_job.error);
    return &c.work->analysis.plant;
}

/* As found for a slow element of a 4 x 4 column under drift: lags of 2.9e6 s. */
static const struct shape slow = {
    .gain = 60, .square_s2 = REAL_C(8.5e12), .lag_s = REAL_C(6e6), .dead_time_s = 20};

static void a_product_of_lags_beyond_the_largest_is_analysed(void)
{
    found(0, 1, slow);
    analysed();
}

static double complex response(struct shape s, double omega)
{
    double complex p = I * omega;
    return (double)s.gain * ((double)s.zero_s * p + 1.0) * cexp(-p * (double)s.dead_time_s) /
           ((double)s.square_s2 * p * p + (double)s.lag_s * p + 1.0);
}

static void what_the_tests_saw_of_it_is_kept(void)
{
    found(0, 1, slow);
    const struct interact_plant *plant = analysed();
    for (double omega = 1e-4; omega < 0.1; omega *= 2.0) {
        struct cmatrix r;
        interact_response(plant, NULL, (real_t)omega, &r);
        double complex wanted = response(slow, omega);
        double complex error = (double)r.value[0][1].re + I * (double)r.value[0][1].im - wanted;
        TEST_ASSERT_TRUE(cabs(error) < 0.01 * cabs(wanted));
    }
}

static void a_damping_that_such_a_reduction_makes_too_low_is_raised(void)
{
    found(1, 0,
          (struct shape){.gain = 1, .square_s2 = REAL_C(9e15), .lag_s = REAL_C(2e7), .zero_s = -3});
    analysed();
}

static void a_zero_or_a_dead_time_beyond_the_largest_is_analysed(void)
{
    found(0, 1, (struct shape){.gain = 1, .lag_s = 100, .zero_s = REAL_C(-3e6)});
    found(1, 0, (struct shape){.gain = 1, .lag_s = 100, .dead_time_s = REAL_C(3e6)});
    analysed();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_product_of_lags_beyond_the_largest_is_analysed);
    RUN_TEST(what_the_tests_saw_of_it_is_kept);
    RUN_TEST(a_damping_that_such_a_reduction_makes_too_low_is_raised);
    RUN_TEST(a_zero_or_a_dead_time_beyond_the_largest_is_analysed);
    return UNITY_END();
}
