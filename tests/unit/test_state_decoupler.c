/* design/state_decoupler.[ch], state_zeros.[ch] and lti/state_model.[ch]; built in float and in double. eps is REAL_EPSILON.
 *
 * Contract
 *   references     36 plants of 2 outputs, tests/reference/state_decoupler_reference.py: indices; F, G, Tf to 256 eps of their
 *                  largest element times the condition of B*; zeros to their error; sampled matrices to 64 eps of the largest; radius
 *   tolerance      an element of rounding's size is no index; one above the tolerance is
 *   refusals       each with its reason: b_star, output, index, zero, pole, integral_s, hold_s with its radius, sizes, no number
 */
#include <math.h>
#include <string.h>

#include "csv.h"
#include "state_design.h"
#include "unity.h"

#define EPS ((double)REAL_EPSILON)

static void set_poles(double at)
{
    for (unsigned i = 0; i < STATE_LOOPS; i++)
        for (unsigned k = 0; k < STATE_POLES; k++)
            goal.pole[i][k] = cplx((real_t)at, (real_t)0);
}

/* Two chains, of one and of two integrators, and a state of their own at -1/2 that output 1 moves. */
static void take_plain_plant(void)
{
    memset(&model, 0, sizeof model);
    set_size(&model.a, 4, 4);
    set_size(&model.b, 4, 2);
    set_size(&model.c, 2, 4);
    set_size(&model.e, 4, 1);
    model.a.value[0][0] = model.a.value[0][1] = (real_t)-0.25;
    model.a.value[1][2] = (real_t)1;
    model.a.value[2][0] = model.a.value[2][1] = (real_t)0.5;
    model.a.value[3][3] = (real_t)-0.5;
    model.a.value[3][0] = model.a.value[0][3] = (real_t)0.5;
    model.b.value[0][0] = model.b.value[2][1] = (real_t)2;
    model.b.value[0][1] = (real_t)1;
    model.c.value[0][0] = model.c.value[1][1] = (real_t)1;
    model.e.value[0][0] = (real_t)0.5;
}

void setUp(void)
{
    take_plain_plant();
    state_decoupler_config_default(&config);
    memset(&goal, 0, sizeof goal);
    set_poles(-1);
}
void tearDown(void) {}

static void assert_refused(enum err code, const char *field, unsigned loop)
{
    TEST_ASSERT_EQUAL(code, design());
    TEST_ASSERT_EQUAL_STRING(field, why.field);
    TEST_ASSERT_TRUE(strlen(why.wanted) > 0);
    TEST_ASSERT_EQUAL_UINT8(loop, why.loop);
}

/* ---- references ---- */

/* Rows of `wide` numbers. */
static void take(const double *at, unsigned wide, struct matrix *a, unsigned rows, unsigned cols)
{
    set_size(a, rows, cols);
    for (unsigned i = 0; i < rows; i++)
        for (unsigned j = 0; j < cols; j++)
            a->value[i][j] = (real_t)at[i * wide + j];
}

static void assert_near(const double *wanted, unsigned wide, const struct matrix *a, double bound)
{
    double most = 0;
    for (unsigned i = 0; i < a->rows; i++)
        for (unsigned j = 0; j < a->cols; j++)
            most = fmax(most, fabs(wanted[i * wide + j]));
    for (unsigned i = 0; i < a->rows; i++)
        for (unsigned j = 0; j < a->cols; j++)
            TEST_ASSERT_DOUBLE_WITHIN(bound * fmax(most, 1e-3), wanted[i * wide + j],
                                      (double)a->value[i][j]);
}

static void assert_zeros(const double *wanted, unsigned n)
{
    bool taken[6] = {false};
    TEST_ASSERT_EQUAL_UINT8(n, d.zeros.n);
    for (unsigned k = 0; k < n; k++) {
        unsigned best = 0;
        double least = 1e9;
        for (unsigned l = 0; l < n; l++) {
            double far = hypot(wanted[(size_t)2 * l] - (double)d.zeros.mode[k].re,
                               wanted[(size_t)2 * l + 1] - (double)d.zeros.mode[k].im);
            if (!taken[l] && far < least) {
                least = far;
                best = l;
            }
        }
        taken[best] = true;
        /* The error is that of the matrix; 64: zeros that are apart by 1/2, of a matrix of 4 states at most. */
        TEST_ASSERT_TRUE(least < 64 * (double)d.zeros.error);
    }
}

static void every_reference_is_met(void)
{
    FILE *f = csv_open("reference/state_decoupler.csv");
    double v[180];
    unsigned cases = 0;
    while (csv_row(f, v, 180)) {
        unsigned n = (unsigned)v[0];
        const double *at = v + 2;
        memset(&model, 0, sizeof model);
        take(at, 6, &model.a, n, n);
        take(at + 36, 2, &model.b, n, 2);
        take(at + 48, 6, &model.c, 2, n);
        take(at + 60, 2, &model.e, n, 2);
        for (unsigned i = 0; i < 2; i++)
            for (unsigned k = 0; k < 3; k++)
                goal.pole[i][k] = cplx((real_t)at[72 + 3 * i + k], (real_t)0);
        goal.feedforward = STATE_FEEDFORWARD_STATES;
        goal.hold_s = (real_t)v[1];
        enum err err = design();
        double bound = 256 * EPS * (double)d.condition;
        TEST_ASSERT_DOUBLE_WITHIN(4000 * sqrt(EPS) * at[117], at[117], (double)d.radius);
        TEST_ASSERT_EQUAL(at[117] < 1 ? ERR_OK : ERR_RANGE, err);
        if (err)
            TEST_ASSERT_EQUAL_STRING("hold_s", why.field);
        for (unsigned i = 0; i < 2; i++)
            TEST_ASSERT_EQUAL_UINT8((unsigned)at[78 + i], d.index[i]);
        assert_near(at + 80, 6, &d.f, bound);
        assert_near(at + 92, 2, &d.g, bound);
        assert_near(at + 96, 2, &d.tf, bound);
        assert_zeros(at + 105, (unsigned)at[104]);
        assert_near(at + 118, 6, &work.sampled.a, 64 * EPS);
        assert_near(at + 154, 2, &work.sampled.b, 64 * EPS);
        assert_near(at + 166, 2, &work.sampled.e, 64 * EPS);
        goal.feedforward = STATE_FEEDFORWARD_OUTPUTS;
        goal.hold_s = 0;
        TEST_ASSERT_EQUAL(ERR_OK, design());
        assert_near(at + 100, 2, &d.tf, bound);
        cases++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_UINT(36, cases);
}

/* ---- the rest ---- */

static void a_plain_plant_is_decoupled(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(0, d.index[0]);
    TEST_ASSERT_EQUAL_UINT8(1, d.index[1]);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)d.k_star[0]);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)d.k_star[1]);
    TEST_ASSERT_EQUAL_DOUBLE(-1.0, (double)d.m[1][0]);
    TEST_ASSERT_EQUAL_DOUBLE(-2.0, (double)d.m[1][1]);
    TEST_ASSERT_EQUAL_UINT8(1, d.zeros.n);
    TEST_ASSERT_DOUBLE_WITHIN(8 * EPS, -0.5, (double)d.zeros.outermost);
    TEST_ASSERT_EQUAL_STRING("", why.field);
}

static void states_that_count_in_no_loop_need_not_be_measured(void)
{
    model.a.value[0][3] = 0;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(3, d.needed_count);
    TEST_ASSERT_EQUAL_HEX16(0x7, d.needed);
    model.a.value[0][3] = (real_t)1e-9;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(3, d.needed_count);
    model.a.value[0][3] = (real_t)1e-3;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(4, d.needed_count);
}

static void what_is_small_against_its_directions_is_no_way_to_move_an_output(void)
{
    model.b.value[1][0] = (real_t)1e-3; /* cosine 5e-4 */
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(1, d.index[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 5e-4, (double)d.neglected);
    model.b.value[1][0] = (real_t)1e-2;
    (void)design();
    TEST_ASSERT_EQUAL_UINT8(0, d.index[1]);
}

static void poles_in_pairs_are_assigned_and_others_refused(void)
{
    goal.pole[1][0] = cplx((real_t)-1, (real_t)2);
    goal.pole[1][1] = cplx((real_t)-1, (real_t)-2);
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_DOUBLE_WITHIN(16 * EPS, 5.0, (double)d.k_star[1]);
    goal.pole[1][1] = cplx((real_t)-1, (real_t)1);
    assert_refused(ERR_RANGE, "pole", 1);
}

static void poles_that_are_not_stable_are_refused(void)
{
    goal.pole[0][0] = cplx((real_t)0, (real_t)0);
    assert_refused(ERR_RANGE, "pole", 0);
    goal.pole[0][0] = cplx((real_t)NAN, (real_t)0);
    assert_refused(ERR_NOT_FINITE, "pole", 0);
}

static void a_pole_that_sampling_makes_unstable_is_refused_with_the_radius(void)
{
    goal.pole[0][0] = cplx((real_t)-10, (real_t)0);
    goal.hold_s = (real_t)0.125;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    goal.hold_s = (real_t)0.5;
    assert_refused(ERR_RANGE, "hold_s", STATE_LOOP_NONE);
    /* Near |1 - 10 T|, that of the loop alone. */
    TEST_ASSERT_DOUBLE_WITHIN(0.8, 4.0, (double)d.radius);
}

static void integrals_are_judged_with_the_poles(void)
{
    goal.integral_s[0] = (real_t)0.1; /* s^2 + s + 10: stable whatever it is */
    TEST_ASSERT_EQUAL(ERR_OK, design());
    goal.integral_s[1] = (real_t)0.1; /* s^3 + 2 s^2 + s + 10 is not */
    assert_refused(ERR_RANGE, "integral_s", 1);
    goal.derivative_s[1] = (real_t)10; /* s^3 + 2 s^2 + 11 s + 10 is */
    TEST_ASSERT_EQUAL(ERR_OK, design());
    goal.derivative_s[1] = (real_t)-1;
    assert_refused(ERR_RANGE, "derivative_s", 1);
}

static void sampled_with_an_integral_the_radius_is_that_of_the_whole_loop(void)
{
    /* One integrator, y' = u, pole -1, T_I 1, sampled at 1/4: x <- x + (q - x)/4, q <- q - x/4. */
    memset(&model, 0, sizeof model);
    set_size(&model.a, 1, 1);
    set_size(&model.b, 1, 1);
    set_size(&model.c, 1, 1);
    model.b.value[0][0] = model.c.value[0][0] = (real_t)1;
    goal.hold_s = (real_t)0.25;
    goal.integral_s[0] = (real_t)1;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_DOUBLE_WITHIN(32 * EPS, sqrt(0.75 + 0.0625), (double)d.radius);
    /* With T_D 1 besides: u = -y + q - 4 (y - y before). z^3 - (1.75 - 1.25) ... of [[-1/4, 1/4, 1], [-1/4, 1, 0], [1, 0, 0]]. */
    goal.derivative_s[0] = (real_t)1;
    assert_refused(ERR_RANGE, "hold_s", STATE_LOOP_NONE);
    TEST_ASSERT_TRUE((double)d.radius > 1.0);
}

static void inputs_that_do_the_same_are_refused(void)
{
    model.b.value[2][0] = (real_t)4;
    model.b.value[2][1] = (real_t)2;
    assert_refused(ERR_SINGULAR, "b_star", STATE_LOOP_NONE);
    model.b.value[2][1] = (real_t)2.0001;
    assert_refused(ERR_SINGULAR, "b_star", STATE_LOOP_NONE);
    config.condition_hi = (real_t)1e6;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_TRUE((double)d.condition > 1e4);
}

static void an_output_that_nothing_moves_is_refused(void)
{
    for (unsigned k = 0; k < 4; k++)
        model.c.value[1][k] = 0;
    assert_refused(ERR_SINGULAR, "output", 1);
    model.c.value[1][3] = (real_t)1;
    model.a.value[3][0] = 0;
    assert_refused(ERR_SINGULAR, "output", 1);
}

static void an_input_five_integrators_away_is_refused(void)
{
    memset(&model, 0, sizeof model);
    set_size(&model.a, 5, 5);
    set_size(&model.b, 5, 1);
    set_size(&model.c, 1, 5);
    for (unsigned k = 0; k < 4; k++)
        model.a.value[k][k + 1] = (real_t)1;
    model.b.value[4][0] = model.c.value[0][0] = (real_t)1;
    assert_refused(ERR_RANGE, "index", 0);
    model.b.value[3][0] = (real_t)1;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(3, d.index[0]);
}

static void outputs_that_are_one_are_refused(void)
{
    for (unsigned k = 0; k < 4; k++)
        model.c.value[1][k] = model.c.value[0][k];
    assert_refused(ERR_SINGULAR, "b_star", STATE_LOOP_NONE);
}

static void a_zero_that_is_not_stable_is_refused_and_told(void)
{
    model.a.value[3][3] = (real_t)0.25;
    assert_refused(ERR_RANGE, "zero", STATE_LOOP_NONE);
    TEST_ASSERT_EQUAL_UINT8(1, d.zeros.n);
    TEST_ASSERT_DOUBLE_WITHIN(8 * EPS, 0.25, (double)d.zeros.mode[0].re);
    model.a.value[3][3] = 0; /* neither does one at the limit die out */
    assert_refused(ERR_RANGE, "zero", STATE_LOOP_NONE);
    model.period_s = (real_t)1;
    set_poles(0.5);
    model.a.value[3][3] = (real_t)-1.25;
    assert_refused(ERR_RANGE, "zero", STATE_LOOP_NONE);
    TEST_ASSERT_DOUBLE_WITHIN(16 * EPS, 1.25, (double)d.zeros.outermost);
}

static void sizes_that_do_not_fit_are_refused(void)
{
    model.b.cols = 1;
    assert_refused(ERR_RANGE, "outputs", STATE_LOOP_NONE);
    take_plain_plant();
    model.a.cols = 3;
    assert_refused(ERR_RANGE, "a", STATE_LOOP_NONE);
    take_plain_plant();
    model.b.rows = 3;
    assert_refused(ERR_RANGE, "b", STATE_LOOP_NONE);
    take_plain_plant();
    model.c.cols = 5;
    assert_refused(ERR_RANGE, "c", STATE_LOOP_NONE);
    take_plain_plant();
    model.e.cols = 9;
    assert_refused(ERR_RANGE, "e", STATE_LOOP_NONE);
}

static void what_is_no_number_is_refused(void)
{
    model.a.value[1][1] = (real_t)NAN;
    assert_refused(ERR_NOT_FINITE, "a", STATE_LOOP_NONE);
    take_plain_plant();
    model.e.value[1][0] = (real_t)INFINITY;
    assert_refused(ERR_NOT_FINITE, "e", STATE_LOOP_NONE);
    take_plain_plant();
    model.period_s = (real_t)NAN;
    assert_refused(ERR_RANGE, "period_s", STATE_LOOP_NONE);
    take_plain_plant();
    goal.hold_s = (real_t)NAN;
    assert_refused(ERR_RANGE, "hold_s", STATE_LOOP_NONE);
}

static void a_config_out_of_range_is_refused(void)
{
    config.row_lo = (real_t)0.2;
    assert_refused(ERR_RANGE, "row_lo", STATE_LOOP_NONE);
    state_decoupler_config_default(&config);
    config.condition_hi = (real_t)0.5;
    assert_refused(ERR_RANGE, "condition_hi", STATE_LOOP_NONE);
    state_decoupler_config_default(&config);
    config.weight_lo = (real_t)NAN;
    assert_refused(ERR_RANGE, "weight_lo", STATE_LOOP_NONE);
}

static void sampling_refuses_what_it_cannot_sample(void)
{
    static struct state_model_work sampling;
    static struct state_model sampled;
    TEST_ASSERT_EQUAL(ERR_RANGE, state_model_sample(&model, (real_t)0, &sampling, &sampled));
    TEST_ASSERT_EQUAL(ERR_RANGE, state_model_sample(&model, (real_t)NAN, &sampling, &sampled));
    model.a.value[3][3] = (real_t)1; /* e^100 is more than a matrix holds */
    TEST_ASSERT_EQUAL(ERR_RANGE, state_model_sample(&model, (real_t)100, &sampling, &sampled));
    take_plain_plant();
    model.period_s = (real_t)1;
    TEST_ASSERT_EQUAL(ERR_RANGE, state_model_sample(&model, (real_t)1, &sampling, &sampled));
}

static void more_states_and_integrals_than_fit_are_refused(void)
{
    memset(&model, 0, sizeof model);
    set_size(&model.a, 16, 16);
    set_size(&model.b, 16, 1);
    set_size(&model.c, 1, 16);
    for (unsigned k = 0; k < 16; k++)
        model.a.value[k][k] = (real_t)-1;
    model.b.value[0][0] = model.c.value[0][0] = (real_t)1;
    goal.hold_s = (real_t)0.1;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    goal.integral_s[0] = (real_t)1;
    assert_refused(ERR_FULL, "states", STATE_LOOP_NONE);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_reference_is_met);
    RUN_TEST(a_plain_plant_is_decoupled);
    RUN_TEST(states_that_count_in_no_loop_need_not_be_measured);
    RUN_TEST(what_is_small_against_its_directions_is_no_way_to_move_an_output);
    RUN_TEST(poles_in_pairs_are_assigned_and_others_refused);
    RUN_TEST(poles_that_are_not_stable_are_refused);
    RUN_TEST(a_pole_that_sampling_makes_unstable_is_refused_with_the_radius);
    RUN_TEST(integrals_are_judged_with_the_poles);
    RUN_TEST(sampled_with_an_integral_the_radius_is_that_of_the_whole_loop);
    RUN_TEST(inputs_that_do_the_same_are_refused);
    RUN_TEST(an_output_that_nothing_moves_is_refused);
    RUN_TEST(an_input_five_integrators_away_is_refused);
    RUN_TEST(outputs_that_are_one_are_refused);
    RUN_TEST(a_zero_that_is_not_stable_is_refused_and_told);
    RUN_TEST(sizes_that_do_not_fit_are_refused);
    RUN_TEST(what_is_no_number_is_refused);
    RUN_TEST(a_config_out_of_range_is_refused);
    RUN_TEST(sampling_refuses_what_it_cannot_sample);
    RUN_TEST(more_states_and_integrals_than_fit_are_refused);
    return UNITY_END();
}
