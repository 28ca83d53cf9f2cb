/* design/pole_placement.[ch]; built in float and in double. eps is REAL_EPSILON.
 *
 * Contract (200 random plants of up to 4 poles, 8 coefficients and 3 samples of delay that are accepted; the decoupled column of Kotyk)
 *   equations     A K P + B Q = M O to 256 eps (condition) of the largest coefficient on either side
 *   overshoot     of the sampled closed loop, simulated in double by its own equations, as asked for within 0.001 and what rounding does;
 *                 of Kotyk's column with the decoupler 10 % within 0.5 %, the other output still to rounding, inputs within 5 V
 *   at rest       Q(1) = R(1) to 32 eps of the sum of Q's magnitudes
 *   refusals      every field at both ends and NaN, a common zero, B(1) = 0, degrees
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "design/pole_placement.h"
#include "design/polynomial_decoupler.h"
#include "kotyk_model.h"
#include "random_matrix.h"
#include "unity.h"

#define EPS ((double)REAL_EPSILON)

static struct polynomial a, b;
static struct pole_placement_goal goal;
static struct pole_placement_work work;
static struct pole_placement result;
static struct pole_placement_refusal why;
static real_t period;

static void set(struct polynomial *to, unsigned n, const double *c)
{
    real_t r[POLYNOMIAL_MOST];
    for (unsigned k = 0; k < n; k++)
        r[k] = (real_t)c[k];
    polynomial_set(to, r, n);
}
#define SET(to, ...)                                                                               \
    set(to, sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[]){__VA_ARGS__})

void setUp(void)
{
    period = (real_t)120;
    pole_placement_goal_default(&goal);
    goal.settling_s = (real_t)1800;
    SET(&a, 1, -1.2, 0.35);
    SET(&b, 0, 0.06, 0.04);
}
void tearDown(void) {}

static enum err design(void)
{
    enum err err = pole_placement_design(&a, &b, period, &goal, &work, &result, &why);
    return err ? err : pole_placement_judge(&a, &b, &result);
}

static double at(const struct polynomial *p, unsigned k)
{
    return k < p->n ? (double)p->value[k] : 0;
}

/* Sum of p[k] x[t - k] from k = first on; x is 0 before its beginning. */
static double filtered(const struct polynomial *p, unsigned first, const double *x, unsigned t)
{
    double sum = 0;
    for (unsigned k = first; k < p->n && k <= t; k++)
        sum += (double)p->value[k] * x[t - k];
    return sum;
}

struct loop {
    double y[2000], u[2000], w[2000], du[2000];
};

/* K P u = R w - Q y at sample t. */
static void control(const struct pole_placement *c, struct loop *l, unsigned t)
{
    l->du[t] =
        filtered(&c->r, 0, l->w, t) - filtered(&c->q, 0, l->y, t) - filtered(&c->p, 1, l->du, t);
    l->u[t] = (t ? l->u[t - 1] : 0) + l->du[t];
}

static void assert_equations(void)
{
    double size = 0, worst = 0;
    for (unsigned k = 0; k < POLYNOMIAL_MOST; k++) {
        double left = 0, terms = 0;
        for (unsigned i = 0; i <= k; i++) {
            double ak = at(&a, k - i) - (k > i ? at(&a, k - i - 1) : 0);
            left += ak * at(&result.p, i) + at(&b, k - i) * at(&result.q, i);
            terms += fabs(ak * at(&result.p, i)) + fabs(at(&b, k - i) * at(&result.q, i));
        }
        size = fmax(size, fmax(terms, fabs(at(&result.poles, k))));
        worst = fmax(worst, fabs(left - at(&result.poles, k)));
    }
    double bound = 256 * EPS * (double)result.condition * size;
    TEST_ASSERT_TRUE(worst <= bound);
    TEST_ASSERT_TRUE((double)result.residual <= bound);
    TEST_ASSERT_DOUBLE_WITHIN(32 * EPS * (double)polynomial_size(&result.q),
                              (double)polynomial_value(&result.r, (real_t)1),
                              (double)polynomial_value(&result.q, (real_t)1));
}

static double simulated_overshoot(double loose)
{
    static struct loop l;
    double peak = 0;
    memset(&l, 0, sizeof l);
    for (unsigned t = 0; t < 600; t++) {
        l.w[t] = 1;
        l.y[t] = filtered(&b, 1, l.u, t) - filtered(&a, 1, l.y, t);
        control(&result, &l, t);
        peak = fmax(peak, l.y[t]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(loose, 1, l.y[599]);
    return peak - 1;
}

/* ---- what comes out ---- */

static void a_step_overshoots_by_what_was_asked_for(void)
{
    for (unsigned k = 0; k <= 6; k++) {
        goal.overshoot = (real_t)(0.05 * k);
        TEST_ASSERT_EQUAL(ERR_OK, design());
        assert_equations();
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.05 * k, simulated_overshoot(1e-3));
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.05 * k, (double)result.overshoot);
    }
}

static void after_the_settling_time_two_per_cent_are_left_at_most(void)
{
    static struct loop l;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    memset(&l, 0, sizeof l);
    for (unsigned t = 0; t < 200; t++) {
        l.w[t] = 1;
        l.y[t] = filtered(&b, 1, l.u, t) - filtered(&a, 1, l.y, t);
        control(&result, &l, t);
        if (t >= 15 + 3)
            TEST_ASSERT_DOUBLE_WITHIN(0.03, 1, l.y[t]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.02, pow((double)result.radius, 15));
    double most = 0;
    for (unsigned t = 0; t < 200; t++)
        most = fmax(most, fabs(l.u[t]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * most, most, (double)result.input_peak);
}

/* Gain from a measurement that alternates to u. */
static double noise_gain(void)
{
    return fabs((double)polynomial_value(&result.q, (real_t)-1) /
                (2 * (double)polynomial_value(&result.p, (real_t)-1)));
}

static void an_observer_changes_what_a_setpoint_does_by_nothing(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, design());
    real_t angle = result.angle;
    double noise = noise_gain();
    goal.observer = (real_t)0.7;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    assert_equations();
    TEST_ASSERT_TRUE(angle == result.angle);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.1, simulated_overshoot(1e-3));
    TEST_ASSERT_TRUE(noise_gain() < 0.5 * noise);
    TEST_ASSERT_TRUE((double)result.sensitivity > 1);
}

static void plants_of_every_degree_are_placed(void)
{
    struct random_source r = {17};
    unsigned made = 0;
    for (unsigned draw = 0; draw < 400 && made < 200; draw++) {
        double den[5] = {1}, num[12] = {0};
        unsigned poles = 1 + random_below(&r, 4), zeros = random_below(&r, 8);
        unsigned delay = 1 + random_below(&r, 4);
        for (unsigned k = 0; k < poles; k++) {
            double pole = 0.45 + 0.5 * random_fraction(&r);
            for (unsigned i = k + 1; i > 0; i--)
                den[i] -= pole * den[i - 1];
        }
        for (unsigned k = 0; k <= zeros; k++)
            num[delay + k] = 0.3 * (random_fraction(&r) + 1.2);
        set(&a, poles + 1, den);
        set(&b, delay + zeros + 1, num);
        goal.observer = (real_t)(0.1 * random_below(&r, 8));
        goal.settling_s = (real_t)(120 * (10 + random_below(&r, 40)));
        enum err err = design();
        if (err)
            continue;
        assert_equations();
        made++;
        /* Error of M O, and of coefficients by their own rounding, over M O at rest, where a step ends. */
        double wrong = (double)result.residual +
                       4 * EPS * (double)(polynomial_size(&result.q) + polynomial_size(&result.p));
        double loose = 1e-3 + 16 * wrong / (double)polynomial_value(&result.poles, (real_t)1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1, (double)result.overshoot);
        if (loose < 0.02)
            TEST_ASSERT_DOUBLE_WITHIN(loose, 0.1, simulated_overshoot(loose));
    }
    TEST_ASSERT_TRUE(made >= 100);
}

/* ---- Kotyk's column ---- */

static struct pole_placement controller[2];
static struct polynomial_decoupler decoupler;
static struct loop loops[2];

static void design_kotyk(real_t settling_s)
{
    static struct polynomial_decoupler_work decoupling;
    struct polynomial_decoupler_config config;
    struct difference_model model = kotyk_column();
    polynomial_decoupler_config_default(&config);
    goal.settling_s = settling_s;
    TEST_ASSERT_EQUAL(ERR_OK,
                      polynomial_decoupler_design(&model, &config, &decoupling, &decoupler, NULL));
    for (unsigned i = 0; i < 2; i++) {
        real_t den[3] = {(real_t)1, model.a[i][0], model.a[i][1]};
        polynomial_set(&a, den, 3);
        b = decoupler.h[i];
        TEST_ASSERT_EQUAL(ERR_OK, design());
        assert_equations();
        controller[i] = result;
    }
}

/* Setpoint of loop k by 0.3 V; *own and *cross: the largest of both outputs, *input: the largest of both inputs, V. The plant is that of
 * the paper, in double. */
static void simulate_kotyk(unsigned k, double *own, double *cross, double *input)
{
    static double mv[2][400];
    struct difference_model model = kotyk_column();
    memset(loops, 0, sizeof loops);
    memset(mv, 0, sizeof mv);
    *own = *cross = *input = 0;
    for (unsigned t = 0; t < 300; t++) {
        for (unsigned i = 0; i < 2; i++) {
            double y = 0;
            for (unsigned l = 0; l < 2 && t >= l + 1; l++)
                y += (double)model.b[i][0][l] * mv[0][t - l - 1] +
                     (double)model.b[i][1][l] * mv[1][t - l - 1] -
                     (double)model.a[i][l] * loops[i].y[t - l - 1];
            loops[i].y[t] = y;
            loops[i].w[t] = i == k ? 0.3 : 0;
            control(&controller[i], &loops[i], t);
        }
        for (unsigned i = 0; i < 2; i++) {
            mv[i][t] = filtered(&decoupler.g.value[i][0], 0, loops[0].u, t) +
                       filtered(&decoupler.g.value[i][1], 0, loops[1].u, t);
            *input = fmax(*input, fabs(mv[i][t]));
        }
        *own = fmax(*own, loops[k].y[t]);
        *cross = fmax(*cross, fabs(loops[1 - k].y[t]));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.3, loops[k].y[299]);
}

static void kotyks_column_decoupled_overshoots_by_a_tenth_and_moves_no_other_output(void)
{
    design_kotyk((real_t)3600);
    for (unsigned k = 0; k < 2; k++) {
        double own, cross, input;
        simulate_kotyk(k, &own, &cross, &input);
        printf(
            "y%u: overshoot %.3f %%, other output %.1e V, inputs up to %.2f V, sensitivity %.2f, "
            "condition %.0f\n",
            k + 1, 100 * (own / 0.3 - 1), cross, input, (double)controller[k].sensitivity,
            (double)controller[k].condition);
        TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.1, own / 0.3 - 1);
        /* Inputs of 5 V, elements of G up to 1.5, gains at rest up to 0.25. */
        TEST_ASSERT_TRUE(cross <= 64 * EPS * 5 * 1.5 * 0.25);
        TEST_ASSERT_TRUE(input <= 5);
    }
}

/* ---- refusals ---- */

static void assert_refused(enum err err, const char *field)
{
    TEST_ASSERT_EQUAL(err, design());
    TEST_ASSERT_EQUAL_STRING(field, why.field);
    TEST_ASSERT_TRUE(strlen(why.wanted) > 0);
    TEST_ASSERT_EQUAL(err, pole_placement_design(&a, &b, period, &goal, &work, &result, NULL));
}

static void fields_out_of_range_are_refused_with_their_names(void)
{
    static const struct {
        const char *name;
        unsigned field;
        double lo, hi;
    } rule[] = {{"period_s", 0, 0, 2e6},
                {"overshoot", 1, -0.01, 0.51},
                {"settling_s", 2, 239, 24001},
                {"observer", 3, -0.01, 0.96},
                {"condition_hi", 4, 9, 1.1e6}};
    for (unsigned k = 0; k < sizeof rule / sizeof rule[0]; k++)
        for (unsigned end = 0; end < 3; end++) {
            setUp();
            real_t *field[] = {&period, &goal.overshoot, &goal.settling_s, &goal.observer,
                               &goal.condition_hi};
            *field[rule[k].field] = (real_t)(end == 0 ? rule[k].lo : end == 1 ? rule[k].hi : NAN);
            assert_refused(ERR_RANGE, rule[k].name);
        }
}

static void polynomials_that_are_no_plant_are_refused(void)
{
    SET(&a, 2, 1);
    assert_refused(ERR_RANGE, "a");
    SET(&a, 1, NAN);
    assert_refused(ERR_RANGE, "a");
    SET(&a, 1, -0.5);
    SET(&b, 0.1, 0.2);
    assert_refused(ERR_RANGE, "b");
    SET(&b, 0, 0, 0);
    assert_refused(ERR_SINGULAR, "b");
    SET(&b, 0, 0.1, -0.1);
    assert_refused(ERR_SINGULAR, "b");
    SET(&a, 1);
    SET(&b, 0, 1);
    assert_refused(ERR_RANGE, "a");
}

static void a_zero_that_is_a_pole_as_well_is_refused(void)
{
    SET(&a, 1, -1.3, 0.4); /* 0.8 and 0.5 */
    SET(&b, 0, 0.1, -0.08);
    assert_refused(ERR_SINGULAR, "a");
    SET(&b, 0, 0.1, -0.080002);
    assert_refused(ERR_SINGULAR, "a");
    SET(&b, 0, 0.1, -0.03);
    TEST_ASSERT_EQUAL(ERR_OK, design());
}

static void more_equations_than_there_is_room_for_are_refused(void)
{
    double num[20] = {0};
    num[14] = 1;
    set(&b, 15, num);
    TEST_ASSERT_EQUAL(ERR_OK, design());
    num[15] = 0.5;
    set(&b, 16, num);
    assert_refused(ERR_FULL, "b");
}

static void an_overshoot_that_no_poles_give_is_refused(void)
{
    SET(&b, 0, 0.3, -0.28); /* a zero of 0.93 makes more of any */
    assert_refused(ERR_RANGE, "overshoot");
    SET(&b, 0, 0.06, 0.04);
    goal.settling_s = (real_t)240;
    goal.overshoot = (real_t)0.5;
    assert_refused(ERR_RANGE, "overshoot");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_step_overshoots_by_what_was_asked_for);
    RUN_TEST(after_the_settling_time_two_per_cent_are_left_at_most);
    RUN_TEST(an_observer_changes_what_a_setpoint_does_by_nothing);
    RUN_TEST(plants_of_every_degree_are_placed);
    RUN_TEST(kotyks_column_decoupled_overshoots_by_a_tenth_and_moves_no_other_output);
    RUN_TEST(fields_out_of_range_are_refused_with_their_names);
    RUN_TEST(polynomials_that_are_no_plant_are_refused);
    RUN_TEST(a_zero_that_is_a_pole_as_well_is_refused);
    RUN_TEST(more_equations_than_there_is_room_for_are_refused);
    RUN_TEST(an_overshoot_that_no_poles_give_is_refused);
    return UNITY_END();
}
