/* design/state_decoupler.[ch], state_zeros.[ch] and lti/state_model.[ch]; built in float and in double. eps is REAL_EPSILON.
 *
 * Contract
 *   references     36 plants of 2 outputs, tests/reference/state_decoupler_reference.py: indices; F, G, Tf to 256 eps of their
 *                  largest element times the condition of B*; zeros to their error; sampled matrices to 64 eps of the largest; radius
 *   K* = -M0       600 random plants, turned by random orthogonal matrices, d_i 0 to 2, up to 12 states, 4 loops: K* that the loop at
 *                  rest asks for is -M0 (in z: I - M0 summed), to 1e-9 in double in all; in float to 1e-5 cond(B*) in 95 %
 *   tolerance      an element of rounding's size is no index; one above the tolerance is
 *   refusals       each with its reason: b_star, output, index, zero, pole, integral_s, hold_s with its radius, sizes, no number
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "csv.h"
#include "design/state_decoupler.h"
#include "random_matrix.h"
#include "unity.h"

#define EPS ((double)REAL_EPSILON)
#define N   12

static struct state_model model, sampled;
static struct state_decoupler_config config;
static struct state_decoupler_goal goal;
static struct state_decoupler_work work;
static struct state_decoupler d;
static struct state_decoupler_refusal why;

static void set_size(struct matrix *a, unsigned rows, unsigned cols)
{
    memset(a, 0, sizeof *a);
    a->rows = (uint8_t)rows;
    a->cols = (uint8_t)cols;
}

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
    model.a.at[0][0] = model.a.at[0][1] = (real_t)-0.25;
    model.a.at[1][2] = (real_t)1;
    model.a.at[2][0] = model.a.at[2][1] = (real_t)0.5;
    model.a.at[3][3] = (real_t)-0.5;
    model.a.at[3][0] = model.a.at[0][3] = (real_t)0.5;
    model.b.at[0][0] = model.b.at[2][1] = (real_t)2;
    model.b.at[0][1] = (real_t)1;
    model.c.at[0][0] = model.c.at[1][1] = (real_t)1;
    model.e.at[0][0] = (real_t)0.5;
}

void setUp(void)
{
    take_plain_plant();
    state_decoupler_config_default(&config);
    memset(&goal, 0, sizeof goal);
    set_poles(-1);
}
void tearDown(void) {}

static enum err design(void)
{
    return state_decoupler_design(&model, &config, &goal, &work, &d, &why);
}

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
            a->at[i][j] = (real_t)at[i * wide + j];
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
                                      (double)a->at[i][j]);
}

static void assert_zeros(const double *wanted, unsigned n)
{
    bool taken[6] = {false};
    TEST_ASSERT_EQUAL_UINT8(n, d.zeros.n);
    for (unsigned k = 0; k < n; k++) {
        unsigned best = 0;
        double least = 1e9;
        for (unsigned l = 0; l < n; l++) {
            double far = hypot(wanted[2 * l] - (double)d.zeros.at[k].re,
                               wanted[2 * l + 1] - (double)d.zeros.at[k].im);
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

/* ---- K* = -M0 ---- */

static double real_a[N][N], real_b[N][4], real_c[4][N];

static void turn(struct random_source *r, unsigned n, unsigned loops)
{
    double v[N], size = 0;
    for (unsigned k = 0; k < n; k++) {
        v[k] = random_fraction(r);
        size += v[k] * v[k];
    }
    /* H = 1 - 2 v v'/v'v on both sides of A, on B's left and on C's right. */
    for (unsigned col = 0; col < n + loops; col++) {
        double sum = 0;
        for (unsigned k = 0; k < n; k++)
            sum += v[k] * (col < n ? real_a[k][col] : real_b[k][col - n]);
        for (unsigned k = 0; k < n; k++)
            *(col < n ? &real_a[k][col] : &real_b[k][col - n]) -= 2 * v[k] * sum / size;
    }
    for (unsigned row = 0; row < n + loops; row++) {
        double *at = row < n ? real_a[row] : real_c[row - n], sum = 0;
        for (unsigned k = 0; k < n; k++)
            sum += v[k] * at[k];
        for (unsigned k = 0; k < n; k++)
            at[k] -= 2 * v[k] * sum / size;
    }
}

/* Chains of integrators with feedback, and stable states of their own, in turned coordinates. */
static unsigned draw_plant(struct random_source *r, bool in_z)
{
    unsigned loops = 1 + random_below(r, 4), chain = 0, at = 0;
    uint8_t index[4];
    for (unsigned i = 0; i < loops; i++) {
        index[i] = (uint8_t)random_below(r, 3);
        chain += index[i] + 1u;
    }
    unsigned n = chain + random_below(r, N - chain + 1);
    memset(real_a, 0, sizeof real_a);
    memset(real_b, 0, sizeof real_b);
    memset(real_c, 0, sizeof real_c);
    for (unsigned i = 0; i < loops; i++) {
        real_c[i][at] = 1;
        for (unsigned k = 0; k < index[i]; k++)
            real_a[at + k][at + k + 1] = 1;
        at += index[i];
        for (unsigned k = 0; k < n; k++)
            real_a[at][k] = random_fraction(r);
        for (unsigned k = 0; k < loops; k++)
            real_b[at][k] = random_fraction(r);
        at++;
    }
    for (unsigned i = chain; i < n; i++) {
        for (unsigned k = 0; k < n; k++)
            real_a[i][k] = k < chain || k > i ? 0.5 * random_fraction(r) : 0;
        real_a[i][i] = in_z ? 0.75 * random_fraction(r) : -1.25 + 0.75 * random_fraction(r);
    }
    for (unsigned k = 0; k < 3; k++)
        turn(r, n, loops);
    memset(&model, 0, sizeof model);
    model.period_s = (real_t)(in_z ? 1 : 0);
    set_size(&model.a, n, n);
    set_size(&model.b, n, loops);
    set_size(&model.c, loops, n);
    for (unsigned i = 0; i < n; i++) {
        for (unsigned k = 0; k < n; k++)
            model.a.at[i][k] = (real_t)real_a[i][k];
        for (unsigned k = 0; k < loops; k++) {
            model.b.at[i][k] = (real_t)real_b[i][k];
            model.c.at[k][i] = (real_t)real_c[k][i];
        }
    }
    for (unsigned i = 0; i < loops; i++)
        for (unsigned k = 0; k < 3; k++)
            goal.pole[i][k] = cplx(
                (real_t)(in_z ? 0.4 + 0.4 * random_fraction(r) : -1.75 + 1.25 * random_fraction(r)),
                (real_t)0);
    for (unsigned i = 0; i < loops; i++)
        if (index[i] && random_below(r, 3) == 0) {
            goal.pole[i][0].im = (real_t)0.5;
            goal.pole[i][1] = cplx_conj(goal.pole[i][0]);
        }
    return index[0] | (unsigned)index[1] << 2 | (unsigned)index[2] << 4 | (unsigned)index[3] << 6;
}

/* x <- a^-1 x, a destroyed; Gauss with pivots. */
static void solve(double a[N][N], unsigned n, double x[N][4], unsigned cols)
{
    for (unsigned k = 0; k < n; k++) {
        unsigned p = k;
        for (unsigned i = k + 1; i < n; i++)
            if (fabs(a[i][k]) > fabs(a[p][k]))
                p = i;
        for (unsigned j = 0; j < n; j++) {
            double swap = a[k][j];
            a[k][j] = a[p][j];
            a[p][j] = swap;
        }
        for (unsigned j = 0; j < cols; j++) {
            double swap = x[k][j];
            x[k][j] = x[p][j];
            x[p][j] = swap;
        }
        for (unsigned i = 0; i < n; i++) {
            double by = i == k ? 0 : a[i][k] / a[k][k];
            for (unsigned j = k; j < n; j++)
                a[i][j] -= by * a[k][j];
            for (unsigned j = 0; j < cols; j++)
                x[i][j] -= by * x[k][j];
        }
    }
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < cols; j++)
            x[i][j] /= a[i][i];
}

/* K* from C (1 - A - B F)^-1 B B*^-1 K* = I, or with -A - B F; the largest difference from -M0 over the largest element of either. */
static double k_star_error(const struct state_model *m, bool in_z)
{
    unsigned n = d.states, loops = d.loops;
    double left[N][N] = {{0}}, right[N][4] = {{0}}, gain[N][N] = {{0}}, k_star[N][4] = {{0}};
    for (unsigned i = 0; i < n; i++) {
        for (unsigned j = 0; j < n; j++) {
            left[i][j] = (in_z && i == j ? 1.0 : 0.0) - (double)m->a.at[i][j];
            for (unsigned k = 0; k < loops; k++)
                left[i][j] -= (double)m->b.at[i][k] * (double)d.f.at[k][j];
        }
        for (unsigned k = 0; k < loops; k++)
            right[i][k] = (double)m->b.at[i][k];
    }
    solve(left, n, right, loops);
    for (unsigned i = 0; i < loops; i++)
        for (unsigned j = 0; j < loops; j++)
            for (unsigned k = 0; k < n; k++)
                gain[i][j] += (double)m->c.at[i][k] * right[k][j];
    for (unsigned i = 0; i < loops; i++)
        k_star[i][i] = 1;
    solve(gain, loops, k_star, loops); /* gain^-1 = B*^-1 K* */
    double worst = 0, most = 0;
    for (unsigned i = 0; i < loops; i++)
        for (unsigned j = 0; j < loops; j++) {
            double found = 0;
            for (unsigned k = 0; k < loops; k++)
                found += (double)d.b_star.at[i][k] * k_star[k][j];
            double wanted = 0;
            if (i == j) {
                wanted = in_z ? 1 : 0;
                for (unsigned k = 0; k <= (in_z ? (unsigned)d.index[i] : 0u); k++)
                    wanted -= (double)d.m[i][k];
            }
            worst = fmax(worst, fabs(found - wanted));
            most = fmax(most, fabs(wanted));
        }
    return worst / most;
}

static void judge_all(uint64_t seed, bool in_z)
{
    struct random_source r = {seed};
    unsigned within = 0, judged = 0, refused = 0;
    double worst = 0;
    while (judged < 600) {
        memset(&goal, 0, sizeof goal);
        unsigned index = draw_plant(&r, in_z);
        enum err err = design();
        if (err) { /* B* was drawn singular, or nearly */
            TEST_ASSERT_EQUAL(ERR_SINGULAR, err);
            TEST_ASSERT_EQUAL_STRING("b_star", why.field);
            refused++;
            TEST_ASSERT_TRUE(refused < 60);
            continue;
        }
        for (unsigned i = 0; i < d.loops; i++)
            TEST_ASSERT_EQUAL_UINT8(index >> 2 * i & 3, d.index[i]);
        double error = k_star_error(&model, in_z);
        double bound = EPS > 1e-10 ? 1e-5 * (double)d.condition : 1e-9;
        within += error <= bound;
        worst = fmax(worst, EPS > 1e-10 ? error / (double)d.condition : error);
        judged++;
    }
    printf("K* against -M0, %s, seed %u: %u of %u within, worst %.2e%s; %u refused\n",
           in_z ? "in z" : "continuous", (unsigned)seed, within, judged, worst,
           EPS > 1e-10 ? " cond(B*)" : "", refused);
    TEST_ASSERT_TRUE(within * 100 >= judged * (EPS > 1e-10 ? 95u : 100u));
}

static void the_gain_that_leaves_no_offset_is_minus_the_leading_pole_assignments(void)
{
    judge_all(1989, false);
}

static void in_discrete_time_it_is_one_less_all_of_them(void)
{
    judge_all(1990, true);
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
    model.a.at[0][3] = 0;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(3, d.needed_count);
    TEST_ASSERT_EQUAL_HEX16(0x7, d.needed);
    model.a.at[0][3] = (real_t)1e-9;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(3, d.needed_count);
    model.a.at[0][3] = (real_t)1e-3;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(4, d.needed_count);
}

static void what_is_small_against_its_directions_is_no_way_to_move_an_output(void)
{
    model.b.at[1][0] = (real_t)1e-3; /* cosine 5e-4 */
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(1, d.index[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 5e-4, (double)d.neglected);
    model.b.at[1][0] = (real_t)1e-2;
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
    model.b.at[0][0] = model.c.at[0][0] = (real_t)1;
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
    model.b.at[2][0] = (real_t)4;
    model.b.at[2][1] = (real_t)2;
    assert_refused(ERR_SINGULAR, "b_star", STATE_LOOP_NONE);
    model.b.at[2][1] = (real_t)2.0001;
    assert_refused(ERR_SINGULAR, "b_star", STATE_LOOP_NONE);
    config.condition_hi = (real_t)1e6;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_TRUE((double)d.condition > 1e4);
}

static void an_output_that_nothing_moves_is_refused(void)
{
    for (unsigned k = 0; k < 4; k++)
        model.c.at[1][k] = 0;
    assert_refused(ERR_SINGULAR, "output", 1);
    model.c.at[1][3] = (real_t)1;
    model.a.at[3][0] = 0;
    assert_refused(ERR_SINGULAR, "output", 1);
}

static void an_input_five_integrators_away_is_refused(void)
{
    memset(&model, 0, sizeof model);
    set_size(&model.a, 5, 5);
    set_size(&model.b, 5, 1);
    set_size(&model.c, 1, 5);
    for (unsigned k = 0; k < 4; k++)
        model.a.at[k][k + 1] = (real_t)1;
    model.b.at[4][0] = model.c.at[0][0] = (real_t)1;
    assert_refused(ERR_RANGE, "index", 0);
    model.b.at[3][0] = (real_t)1;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    TEST_ASSERT_EQUAL_UINT8(3, d.index[0]);
}

static void outputs_that_are_one_are_refused(void)
{
    for (unsigned k = 0; k < 4; k++)
        model.c.at[1][k] = model.c.at[0][k];
    assert_refused(ERR_SINGULAR, "b_star", STATE_LOOP_NONE);
}

static void a_zero_that_is_not_stable_is_refused_and_told(void)
{
    model.a.at[3][3] = (real_t)0.25;
    assert_refused(ERR_RANGE, "zero", STATE_LOOP_NONE);
    TEST_ASSERT_EQUAL_UINT8(1, d.zeros.n);
    TEST_ASSERT_DOUBLE_WITHIN(8 * EPS, 0.25, (double)d.zeros.at[0].re);
    model.a.at[3][3] = 0; /* neither does one at the limit die out */
    assert_refused(ERR_RANGE, "zero", STATE_LOOP_NONE);
    model.period_s = (real_t)1;
    set_poles(0.5);
    model.a.at[3][3] = (real_t)-1.25;
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
    model.a.at[1][1] = (real_t)NAN;
    assert_refused(ERR_NOT_FINITE, "a", STATE_LOOP_NONE);
    take_plain_plant();
    model.e.at[1][0] = (real_t)INFINITY;
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
    TEST_ASSERT_EQUAL(ERR_RANGE, state_model_sample(&model, (real_t)0, &sampling, &sampled));
    TEST_ASSERT_EQUAL(ERR_RANGE, state_model_sample(&model, (real_t)NAN, &sampling, &sampled));
    model.a.at[3][3] = (real_t)1; /* e^100 is more than a matrix holds */
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
        model.a.at[k][k] = (real_t)-1;
    model.b.at[0][0] = model.c.at[0][0] = (real_t)1;
    goal.hold_s = (real_t)0.1;
    TEST_ASSERT_EQUAL(ERR_OK, design());
    goal.integral_s[0] = (real_t)1;
    assert_refused(ERR_FULL, "states", STATE_LOOP_NONE);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_reference_is_met);
    RUN_TEST(the_gain_that_leaves_no_offset_is_minus_the_leading_pole_assignments);
    RUN_TEST(in_discrete_time_it_is_one_less_all_of_them);
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
