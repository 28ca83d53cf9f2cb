/* The one-step method: its order whatever the Jacobian, stiff decay, and what it remembers between stretches. */
#include "columns/rosenbrock.h"
#include "unity.h"

#include <math.h>

/* x' = -a (x - cos z) - sin z, z' = 1 with z(0) = 0: x = cos t on the slow manifold. What linearise gives is the
 * Jacobian times a factor. */
static struct {
    double a, truth, g;
    int calls, factors;
    double fails_above; /* x beyond which there are no rates */
} problem;
static struct rosenbrock method;

static bool rates(void *context, const double *y, double *f)
{
    (void)context;
    problem.calls++;
    if (y[0] > problem.fails_above)
        return false;
    f[0] = -problem.a * (y[0] - cos(y[1])) - sin(y[1]);
    f[1] = 1.0;
    return true;
}

static double slope_z;

static void linearise(void *context, const double *y)
{
    (void)context;
    slope_z = -problem.a * sin(y[1]) - cos(y[1]);
}

static bool factor(void *context, double g)
{
    (void)context;
    problem.factors++;
    problem.g = g;
    return true;
}

/* I - g J is triangular: z first. */
static void solve(void *context, double *b)
{
    (void)context;
    double g = problem.g * problem.truth;
    b[0] = (b[0] + g * slope_z * b[1]) / (1.0 + g * problem.a);
}

static void start(double a, double truth, double tolerance)
{
    problem.a = a;
    problem.truth = truth;
    problem.calls = problem.factors = 0;
    problem.fails_above = INFINITY;
    const struct rosenbrock_problem p = {
        .n = 2, .rates = rates, .linearise = linearise, .factor = factor, .solve = solve};
    TEST_ASSERT_TRUE(rosenbrock_init(&method, &p, tolerance, tolerance));
}

void setUp(void) {}

void tearDown(void)
{
    rosenbrock_free(&method);
}

/* Error at t = 1 after equal steps: the tolerance is wide open, and each step a stretch of its own. */
static double error_after(int steps, double truth)
{
    double y[2] = {0.5, 0.0}, f[2];
    start(1.0, truth, 1e6);
    for (int k = 0; k < steps; k++) {
        TEST_ASSERT_TRUE(rates(NULL, y, f));
        double end = (k + 1.0) / steps;
        TEST_ASSERT_TRUE(rosenbrock_run(&method, (double)k / steps, end, y, f, 1) == end);
    }
    rosenbrock_free(&method);
    return fabs(y[0] - (cos(1.0) - 0.5 * exp(-1.0)));
}

static void it_is_of_third_order_with_the_jacobian_a_wrong_one_and_none(void)
{
    static const double truths[] = {1.0, 0.6, 1.7, 0.0};
    for (int i = 0; i < 4; i++) {
        double order = log2(error_after(20, truths[i]) / error_after(40, truths[i]));
        TEST_ASSERT_DOUBLE_WITHIN(0.35, 3.0, order);
        TEST_ASSERT_TRUE(error_after(40, truths[i]) < 1e-5);
    }
}

static void a_stiff_transient_is_damped_in_one_long_step(void)
{
    double y[2] = {0.0, 0.0}, f[2];
    start(1e8, 1.0, 1e6); /* anything passes: one step over the lot */
    TEST_ASSERT_TRUE(rates(NULL, y, f));
    TEST_ASSERT_TRUE(rosenbrock_run(&method, 0.0, 0.1, y, f, 1) == 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, cos(0.1), y[0]);
}

static void the_error_keeps_to_the_tolerance(void)
{
    for (double tolerance = 1e-3; tolerance > 1e-9; tolerance *= 0.1) {
        double y[2] = {0.3, 0.0}, f[2];
        start(50.0, 1.0, tolerance);
        TEST_ASSERT_TRUE(rates(NULL, y, f));
        TEST_ASSERT_TRUE(rosenbrock_run(&method, 0.0, 2.0, y, f, 100000) == 2.0);
        double error = fabs(y[0] - cos(2.0));
        TEST_ASSERT_TRUE(error < 5.0 * tolerance);
        rosenbrock_free(&method);
    }
    start(1.0, 1.0, 1.0); /* for tearDown */
}

static void after_a_jump_it_begins_with_the_step_of_the_last_jump(void)
{
    double y[2] = {0.9, 0.0}, f[2];
    long tried[3];
    start(100.0, 1.0, 1e-5);
    for (int k = 0; k < 3; k++) {
        y[0] += 0.1;
        rosenbrock_jump(&method);
        long before = method.rejected;
        TEST_ASSERT_TRUE(rates(NULL, y, f));
        TEST_ASSERT_TRUE(rosenbrock_run(&method, k, k + 1.0, y, f, 100000) == k + 1.0);
        tried[k] = method.rejected - before;
        TEST_ASSERT_TRUE(method.first < 0.1 * method.next);
    }
    TEST_ASSERT_TRUE(tried[1] <= 1 && tried[2] <= 1);
}

static void it_stops_after_the_steps_it_may_take_and_goes_on_from_there(void)
{
    double y[2] = {0.0, 0.0}, f[2];
    start(30.0, 1.0, 1e-7);
    TEST_ASSERT_TRUE(rates(NULL, y, f));
    double t = rosenbrock_run(&method, 0.0, 1.0, y, f, 5);
    TEST_ASSERT_TRUE(t > 0.0 && t < 1.0);
    TEST_ASSERT_EQUAL(5, method.steps);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, t, y[1]); /* z counts time */
    TEST_ASSERT_TRUE(rates(NULL, y, f));
    TEST_ASSERT_TRUE(rosenbrock_run(&method, t, 1.0, y, f, 100000) == 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, cos(1.0), y[0]);
}

static void a_step_into_the_forbidden_is_shortened_and_a_wall_ends_the_stretch(void)
{
    double y[2] = {0.0, 0.0}, f[2];
    start(5.0, 1.0, 1e3);
    problem.fails_above = 0.5;
    TEST_ASSERT_TRUE(rates(NULL, y, f));
    double t = rosenbrock_run(&method, 0.0, 1.0, y, f, 100000);
    TEST_ASSERT_TRUE(t > 0.05 && t < 0.2); /* x reaches 0.5 at about 0.14 */
    TEST_ASSERT_TRUE(y[0] > 0.3 && y[0] <= 0.5);
    TEST_ASSERT_TRUE(isfinite(method.next));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_is_of_third_order_with_the_jacobian_a_wrong_one_and_none);
    RUN_TEST(a_stiff_transient_is_damped_in_one_long_step);
    RUN_TEST(the_error_keeps_to_the_tolerance);
    RUN_TEST(after_a_jump_it_begins_with_the_step_of_the_last_jump);
    RUN_TEST(it_stops_after_the_steps_it_may_take_and_goes_on_from_there);
    RUN_TEST(a_step_into_the_forbidden_is_shortened_and_a_wall_ends_the_stretch);
    return UNITY_END();
}
