/* Kind `inferential` beside published vectors, and what has to come out whatever the gains: no offset, no windup, no stalling.
 *
 * Contract, float and fixed: the published digit and eight roundings of a temperature, which has a span of 8 here. */
#include "inferential_bench.h"

#define ROUNDINGS        (8 * 8 * 0x1p-25)
#define HOURS(n, step_s) ((unsigned)((n)*3600.0 / (step_s) + 0.5))

static struct infer_bench b;

void setUp(void) {}
void tearDown(void) {}

static double deviation(void)
{
    return b.plant[0].t[0] - b.plant[0].setpoint;
}

/* dT1/dt = u + 1, dT2/dt = 2 u + 1/2, from rest at u = 0. */
static void begin_vector(enum inferential_law law, enum inferential_form form, double step_s)
{
    bench_plain(&b, law, form, step_s);
    bench_begin(&b);
    b.plant[0].load[0] += 1;
    b.plant[0].load[1] += 0.5;
}

struct vector {
    enum inferential_law law;
    double hours, y1, e2; /* NAN: not published */
};

/* y1 and e2 where a vector has them, of one course in Euler steps. */
static void course(const struct vector *v, unsigned n, double step_s, double is[][2])
{
    unsigned at = 0;
    for (unsigned i = 0; i < n; i++) {
        if (i == 0 || v[i].law != v[i - 1].law) {
            begin_vector(v[i].law, FORM_EULER, step_s);
            at = 0;
        }
        for (; at < HOURS(v[i].hours, step_s); at++)
            bench_cycle(&b);
        bench_step(&b);
        is[i][0] = deviation();
        is[i][1] = bench_value(&b, "y2_1");
        bench_apply(&b);
        bench_go_on(&b);
        at++;
    }
}

/* Digest of Frau's thesis, vectors of the control blocks. */
static void euler_steps_of_ten_seconds_give_the_published_vectors(void)
{
    static const struct vector v[] = {
        {LAW_CONVENTIONAL, 0.1, 0.038363, NAN}, {LAW_CONVENTIONAL, 1, 0.007477, NAN},
        {LAW_CASCADE, 0.1, 0.036090, NAN},      {LAW_CASCADE, 0.5, 0.014371, NAN},
        {LAW_CASCADE, 1, 0.004298, 0.000560},   {LAW_CLF, 0.1, 0.034128, NAN},
        {LAW_CLF, 0.5, 0.012533, NAN},          {LAW_CLF, 1, 0.004986, -0.003567},
    };
    enum { N = sizeof v / sizeof v[0] };
    double is[N][2];
    course(v, N, 10, is);
    for (unsigned i = 0; i < N; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.5e-6 + ROUNDINGS, v[i].y1, is[i][0]);
        if (!isnan(v[i].e2))
            TEST_ASSERT_DOUBLE_WITHIN(0.5e-6 + ROUNDINGS, v[i].e2, is[i][1]);
    }
}

/* Euler is of first order: twice the course in fine steps less the one in steps twice as long is the course without steps, and has
 * three times the roundings. */
static void fine_euler_steps_give_the_published_courses_without_steps(void)
{
    static const struct vector v[] = {
        {LAW_CONVENTIONAL, 0.05, 0.0298310, NAN}, {LAW_CONVENTIONAL, 0.1, 0.0379664, NAN},
        {LAW_CONVENTIONAL, 0.5, 0.0204352, NAN},  {LAW_CONVENTIONAL, 1, 0.0075186, NAN},
        {LAW_CONVENTIONAL, 2, 0.0010175, NAN},    {LAW_CASCADE, 0.05, 0.029005, 0.014089},
        {LAW_CASCADE, 0.1, 0.035701, 0.016718},   {LAW_CASCADE, 0.5, 0.014445, 0.004228},
        {LAW_CASCADE, 1, 0.004332, 0.000572},     {LAW_CASCADE, 2, 0.000519, 0.000010},
        {LAW_CLF, 0.05, 0.028235, 0.012493},      {LAW_CLF, 0.1, 0.033759, 0.012502},
        {LAW_CLF, 0.5, 0.012604, -0.004346},      {LAW_CLF, 1, 0.005007, -0.003569},
        {LAW_CLF, 2, 0.001150, -0.000896},
    };
    enum { N = sizeof v / sizeof v[0] };
    double fine[N][2], twice[N][2];
    course(v, N, 0.36, fine);
    course(v, N, 0.72, twice);
    for (unsigned i = 0; i < N; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.5e-6 + 3 * ROUNDINGS, v[i].y1, 2 * fine[i][0] - twice[i][0]);
        if (!isnan(v[i].e2))
            TEST_ASSERT_DOUBLE_WITHIN(0.5e-6 + 3 * ROUNDINGS, v[i].e2,
                                      2 * fine[i][1] - twice[i][1]);
    }
}

/* u within +-0.5, the load 1 for an hour. Published: 1.515 h, y(2) = 0.094, y(2.5) = 0.035, from a script that stepped the plant
 * before the observer; in the order of a controller all comes 0.001 h earlier, at rates of 0.5/h and less. */
static void the_limit_is_left_when_the_published_vector_says(void)
{
    bench_plain(&b, LAW_CONVENTIONAL, FORM_EULER, 0.36);
    b.plant[0].lo = 1.5;
    b.plant[0].hi = 2.5;
    bench_begin(&b);
    double leaves = 0;
    for (unsigned at = 0; at <= 25000; at++) {
        double t = at * 1e-4;
        b.plant[0].load[0] = (at < 10000 ? 1 : 0) - 2;
        if (at == 10000)
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.507, deviation());
        if (at == 15000)
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.257, deviation());
        if (at == 20000)
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.094, deviation());
        if (at == 25000)
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.035, deviation());
        bench_cycle(&b);
        if (b.plant[0].u < 1.5 + 1e-6)
            leaves = t;
    }
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 1.515, leaves);
}

/* A column's temperature settles by itself: what it cannot do by u, T stops doing at a distance from the setpoint. */
static double hours_at_the_limit(enum inferential_law law, enum inferential_form form,
                                 double cut_hours)
{
    const double step_s = 30;
    bench_plain(&b, law, form, step_s);
    b.plant[0].lo = 1.5;
    b.plant[0].hi = 2.5;
    bench_begin(&b);
    unsigned cut = HOURS(cut_hours, step_s), at = 0;
    do {
        double pushed = at < cut ? 1.0 : 0.0;
        b.plant[0].load[0] = pushed - 2 - 1.0 * b.plant[0].t[0];
        b.plant[0].load[1] = 2 * pushed - 4 - 1.0 * (b.plant[0].t[1] - 0.5);
        bench_cycle(&b);
        at++;
        TEST_ASSERT_LESS_THAN(cut + HOURS(5, step_s), at);
    } while (at <= cut || b.plant[0].u < 1.5 + 1e-6);
    return (at - cut) * step_s / 3600;
}

/* Nothing winds up: how long it was cut makes no difference of more than two steps. */
static void after_a_day_at_its_limit_it_leaves_it_as_soon_as_after_six_hours(void)
{
    for (unsigned law = LAW_CONVENTIONAL; law <= LAW_CLF; law++)
        for (unsigned form = FORM_EULER; form <= FORM_JOINT; form++) {
            double soon =
                hours_at_the_limit((enum inferential_law)law, (enum inferential_form)form, 6);
            double late =
                hours_at_the_limit((enum inferential_law)law, (enum inferential_form)form, 30);
            printf("law %u, form %u: %.3f h at the limit after 6 h, %.3f h after 30 h\n", law, form,
                   soon, late);
            TEST_ASSERT_DOUBLE_WITHIN(2 * 30.0 / 3600 + 1e-9, soon, late);
        }
}

/* Loads that stand still and do not fit each other: T2 rises for ever. y1 and e2 rest where a reading is rounded; where Ts Ko is
 * large that is four times the rounding. */
static void a_temperature_that_rises_for_hours_leaves_no_offset(void)
{
    static const double steps[] = {10, 60, 300, 900};
    for (unsigned law = LAW_CONVENTIONAL; law <= LAW_CLF; law++)
        for (unsigned form = FORM_EULER; form <= FORM_JOINT; form++)
            for (unsigned i = 0; i < sizeof steps / sizeof steps[0]; i++) {
                if (form == FORM_EULER && steps[i] > 60)
                    continue;
                begin_vector((enum inferential_law)law, (enum inferential_form)form, steps[i]);
                bench_cycles(&b, HOURS(12, steps[i]));
                bench_step(&b);
                TEST_ASSERT_DOUBLE_WITHIN(ROUNDINGS, 0, deviation());
                if (law != LAW_CONVENTIONAL)
                    TEST_ASSERT_DOUBLE_WITHIN(ROUNDINGS, 0, bench_value(&b, "y2_1"));
            }
}

/* Deviations while a load is gone, with Ts Ko = 5: those of exp(A Ts) and nothing else, after the observers have settled. */
static void the_joint_form_has_the_poles_it_promises_at_any_step(void)
{
    const double step_s = 900, pole = exp(-2 * step_s / 3600);
    bench_plain(&b, LAW_CONVENTIONAL, FORM_JOINT, step_s);
    bench_begin(&b);
    b.plant[0].setpoint = 1;
    double y = -1;
    for (unsigned n = 0; n < 10; n++) {
        bench_step(&b);
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDINGS, y, deviation());
        bench_apply(&b);
        bench_go_on(&b);
        y *= pole;
    }
}

/* T stands still 0.001 spans below the setpoint, w = 0.05 1/h, a step a second: what is added to the states in a step is far below
 * 2^-24. Beside the same sums in double; a fraction of 2e-5 for gains in float and of fixed point. */
static void slow_gains_do_not_stall_at_a_step_a_second(void)
{
    for (unsigned law = LAW_CONVENTIONAL; law <= LAW_CLF; law++) {
        const double h = 1.0 / 3600, kc = 0.1, kc2 = 0.2, ko = 1, a1 = 1, a2 = 2, y = -0.008;
        bench_plain(&b, (enum inferential_law)law, FORM_EULER, 1);
        b.settings.kc[0] = b.settings.kc2[0] = b.settings.ko[0] = 0;
        b.settings.w[0] = 0.05f;
        bench_begin(&b);
        b.plant[0].setpoint = -y;
        double b1 = 0, b2 = 0, e2 = 0, u = 0, first = 0;
        for (unsigned n = 0; n <= HOURS(5, 1); n++) {
            double up = -(kc * y + b1) / a1,
                   ut = -kc2 * (e2 / a2 + (law == LAW_CLF ? a1 * y / (a2 * a2) : 0));
            u = law == LAW_CONVENTIONAL ? up : up + ut;
            first = n == 0 ? u : first;
            bench_step(&b);
            bench_apply(&b);
            e2 -= h * (a2 * up + b2);
            b1 -= h * ko * (b1 + a1 * u);
            b2 -= h * ko * (b2 + a2 * u);
        }
        TEST_ASSERT_TRUE(fabs(u - first) > 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(2e-5 * fabs(u) + 4 * 0x1p-24, u, b.plant[0].u - 2);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(euler_steps_of_ten_seconds_give_the_published_vectors);
    RUN_TEST(fine_euler_steps_give_the_published_courses_without_steps);
    RUN_TEST(the_limit_is_left_when_the_published_vector_says);
    RUN_TEST(after_a_day_at_its_limit_it_leaves_it_as_soon_as_after_six_hours);
    RUN_TEST(a_temperature_that_rises_for_hours_leaves_no_offset);
    RUN_TEST(the_joint_form_has_the_poles_it_promises_at_any_step);
    RUN_TEST(slow_gains_do_not_stall_at_a_step_a_second);
    return UNITY_END();
}
