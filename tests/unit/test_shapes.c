/* Elements of more than one lag in interact/plant.[ch], design/modes.[ch], design/first_order.[ch], design/loops.[ch],
 * design/nyquist.[ch] and design/trial.[ch]; built in float and in double.
 *
 * Contract, against tests/reference/shapes_reference.py, which uses matrix exponentials
 *   responses                   within 1e-9 in double and 2e-4 in float of the largest size, and 3e-4 where lags are nearly equal
 *   stable or not               as the eigenvalues of the sampled loops say, where 1 % of the gains does not decide
 *   log modulus                 within 0.1 dB up to 10 dB, 0.5 dB beyond
 *   step responses              integral of |e| and peak within 1e-4 in double, 1 % in float
 *   one lag                     numbers to the last bit as without the array of shapes: design/loops.h
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "csv.h"
#include "design/detune.h"
#include "design/first_order.h"
#include "design/modes.h"
#include "design/trial.h"
#include "unity.h"

static struct interact_plant plant;
static struct loops loops;
static struct loops_sampled sampled;
static struct nyquist nyquist;
static struct trial trial;
static struct detune detune;
static struct interact_refusal reason;

void setUp(void)
{
    memset(&plant, 0, sizeof plant);
    memset(&loops, 0, sizeof loops);
    plant.outputs = plant.inputs = 1;
    loops.pairs.n = 1;
    loops.pairs.output[1] = loops.pairs.input[1] = 1;
    loops.derivative_filter = 8;
    loops.interval_s = 1;
    loops.tuning[0] = loops.tuning[1] = (struct tuning){.gain = 1, .ti_s = 1};
}
void tearDown(void) {}

/* gain, dead time, time constant, square, zero */
static void set_element(unsigned i, unsigned j, const double *v)
{
    plant.element[i][j] = (struct fopdt){(real_t)v[0], (real_t)v[1], (real_t)v[2]};
    plant.shape[i][j] = (struct interact_shape){(real_t)v[3], (real_t)v[4]};
}

static void responses_are_those_of_the_exact_element(void)
{
    FILE *f = csv_open("reference/shapes.csv");
    double v[12], worst = 0.0;
    unsigned rows = 0;
    while (csv_row(f, v, 12)) {
        char where[96];
        snprintf(where, sizeof where, "T %g, square %g, zero %g, omega %g", v[2], v[3], v[4], v[6]);
        set_element(0, 0, v);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, interact_check(&plant, &reason), where);
        loops.interval_s = (real_t)v[5];
        loops_sample(&plant, &loops, NYQUIST_DELAY, 0, &sampled);
        struct cplx open[MATRIX_MAX][MATRIX_MAX];
        loops_open(&loops, &sampled, (real_t)v[6], open);
        struct cplx c =
            loops_controller(&loops, 0, (real_t)v[5], loops_z_less_1((real_t)(v[6] * v[5])));
        struct cplx g = cplx_div(open[0][0], c);
        bool equal = fabs(1.0 - 4.0 * v[3] / (v[2] * v[2])) < 3e-4;
        double part = sizeof(real_t) == 8 ? 1e-9 : 2e-4;
        part = equal ? 3e-4 : part;
        double size = fabs(v[0]), miss = hypot((double)g.re - v[7], (double)g.im - v[8]) / size;
        worst = fmax(worst, equal ? 0.0 : miss);
        TEST_ASSERT_TRUE_MESSAGE(miss < part, where);
        struct cmatrix exact;
        interact_response(&plant, NULL, (real_t)v[6], &exact);
        miss = hypot((double)exact.value[0][0].re - v[9], (double)exact.value[0][0].im - v[10]);
        TEST_ASSERT_TRUE_MESSAGE(miss / size < (sizeof(real_t) == 8 ? 1e-9 : 1e-5), where);
        struct modes modes;
        modes_of(&plant.element[0][0], &plant.shape[0][0], &modes);
        part = equal ? 1e-3 : sizeof(real_t) == 8 ? 1e-6 : 1e-3;
        if (v[2] > 0.0)
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(part * v[11], v[11],
                                              (double)modes_noise(&modes, (real_t)v[5]), where);
        rows++;
    }
    fclose(f);
    printf("shapes: %u responses within %.2g of the gain\n", rows, worst);
    TEST_ASSERT_EQUAL_UINT(195, rows);
}

/* Row of shape_loops.csv: v[2] on the elements, v[22] the interval, then gains and integral times. */
static void set_plant(const double *v)
{
    plant.outputs = plant.inputs = loops.pairs.n = 2;
    for (unsigned k = 0; k < 4; k++)
        set_element(k / 2, k % 2, v + 2 + 5 * k);
    loops.interval_s = (real_t)v[22];
    for (unsigned k = 0; k < 2; k++)
        loops.tuning[k] = (struct tuning){.gain = (real_t)fabs(v[23 + k]),
                                          .ti_s = (real_t)v[25 + k],
                                          .action = v[23 + k] < 0 ? TUNING_DIRECT : TUNING_REVERSE};
}

static void step_the_loops(const double *v, const char *where)
{
    const double part = sizeof(real_t) == 8 ? 1e-4 : 1e-2;
    struct trial_config c = {.loop = (uint8_t)v[29],
                             .load = v[30] != 0.0,
                             .size = REAL_C(0.01),
                             .duration_s = (real_t)v[31],
                             .setpoint_weight = 1};
    TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&trial, &plant, &loops, &c));
    enum err err;
    while ((err = trial_step(&trial)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(800, trial.sample, where);
    for (unsigned k = 0; k < 2; k++) {
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(part * v[32 + k] + 1e-5, v[32 + k],
                                          (double)trial.loop[k].iae, where);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(part * v[34 + k] + 1e-4, v[34 + k],
                                          (double)trial.loop[k].peak, where);
    }
}

static void loops_on_such_elements_are_judged_as_their_eigenvalues_judge(void)
{
    FILE *f = csv_open("reference/shape_loops.csv");
    double v[36], worst = 0.0;
    unsigned stable = 0, unstable = 0;
    while (csv_row(f, v, 36)) {
        char where[64];
        snprintf(where, sizeof where, "plant %.0f, gains times %g", v[0], v[1]);
        set_plant(v);
        TEST_ASSERT_EQUAL_INT(ERR_OK, nyquist_begin(&nyquist, &plant, &loops, 1, (real_t)INFINITY));
        enum err err;
        while ((err = nyquist_step(&nyquist)) == ERR_BUSY)
            ;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, err, where);
        TEST_ASSERT_EQUAL_INT_MESSAGE((int)v[27], nyquist.stable, where);
        unstable += v[27] == 0.0;
        if (v[27] == 0.0)
            continue;
        stable++;
        worst = fmax(worst, fabs(v[28] - (double)nyquist.log_modulus_db));
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(v[28] < 10.0 ? 0.1 : 0.5, v[28],
                                          (double)nyquist.log_modulus_db, where);
        step_the_loops(v, where);
    }
    fclose(f);
    printf("shapes: %u stable, %u unstable, log modulus within %.3f dB\n", stable, unstable, worst);
    TEST_ASSERT_GREATER_THAN_UINT(15, stable);
    TEST_ASSERT_GREATER_THAN_UINT(15, unstable);
}

/* The loop is slow and thin at the resonance only: 1/(2 damping) times the integral gain. */
static void a_narrow_resonance_is_not_stepped_over(void)
{
    double v[5] = {1, 0, 2, 400, 0}; /* damping 0.05, 0.05 rad/s */
    set_element(0, 0, v);
    loops.interval_s = REAL_C(0.1);
    unsigned wrong = 0;
    for (unsigned k = 0; k < 200; k++) {
        /* pure integral action in effect: unstable from gain/ti = T/square = 0.005 on */
        double ki = 0.005 * (k % 2 ? 1.03 : 0.97), ti = 0.2 * (1 + 0.01 * k);
        loops.tuning[0] = (struct tuning){.gain = (real_t)(ki * ti), .ti_s = (real_t)ti};
        TEST_ASSERT_EQUAL_INT(ERR_OK, nyquist_begin(&nyquist, &plant, &loops, 1, (real_t)INFINITY));
        while (nyquist_step(&nyquist) == ERR_BUSY)
            ;
        wrong += nyquist.stable != (k % 2 == 0);
    }
    TEST_ASSERT_EQUAL_UINT(0, wrong);
}

static void expect_reduced(double lag, double dead, const double *v)
{
    set_element(0, 0, v);
    struct fopdt m = first_order_of(&plant.element[0][0], &plant.shape[0][0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * (1 + lag), lag, (double)m.time_constant_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * (1 + dead), dead, (double)m.dead_time_s);
}

static void elements_are_reduced_by_skogestads_rules(void)
{
    expect_reduced(40, 3, (double[5]){1, 3, 40, 0, 0});
    expect_reduced(1.1, 0.1, (double[5]){1, 0, 1.2, 0.2, 0}); /* his example E1: lags 1 and 0.2 */
    expect_reduced(27.5, 5.5, (double[5]){1, 3, 30, 125, 0}); /* lags 25 and 5 */
    expect_reduced(27.5, 15.5, (double[5]){1, 3, 30, 125, -10}); /* inverse response */
    expect_reduced(5 - 2, 4, (double[5]){1, 4, 5, 0, 2});        /* T3 */
    expect_reduced(0.1 * 5, 1, (double[5]){1, 1, 5, 0, 5}); /* T1: nothing is left of the lag */
    expect_reduced(12 - 400 / 12.0 < 0 ? 1.2 : 0, 2 + 400 / 12.0, (double[5]){1, 2, 12, 400, 0});
    double v[5] = {2, 1, 50, 400, 120}; /* lags 40 and 10, zero 120: gain 2 times 120/40 */
    set_element(0, 0, v);
    struct fopdt m = first_order_of(&plant.element[0][0], &plant.shape[0][0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 6, (double)m.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 10, (double)m.time_constant_s);
}

/* Damping falls through 1: neither lag nor dead time jumps where the lags meet. */
static void the_reduction_is_continuous_where_lags_become_equal(void)
{
    double before[5] = {1, 2, 20, 99.9, 0}, after[5] = {1, 2, 20, 100.1, 0};
    set_element(0, 0, before);
    struct fopdt a = first_order_of(&plant.element[0][0], &plant.shape[0][0]);
    set_element(0, 0, after);
    struct fopdt b = first_order_of(&plant.element[0][0], &plant.shape[0][0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, (double)a.time_constant_s, (double)b.time_constant_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, (double)a.dead_time_s, (double)b.dead_time_s);
}

/* Every kind of element gets settings that keep the gain margin asked for. */
static void such_elements_get_settings_that_are_stable(void)
{
    const double elements[][5] = {{1, 2, 30, 125, 0},   {1, 2, 2, 400, 0},    {-2, 2, 12, 400, -6},
                                  {1, 2, 40, 300, -15}, {1, 2, 50, 400, 120}, {1, 2, 20, 0, 8},
                                  {1, 2, 20, 0, -15},   {1, 0, 20, 100, 0}};
    struct detune_config c;
    detune_config_default(&c);
    real_t noise = REAL_C(0.001);
    c.noise_sd = &noise;
    for (unsigned k = 0; k < sizeof elements / sizeof elements[0]; k++) {
        char where[32];
        snprintf(where, sizeof where, "element %u", k);
        set_element(0, 0, elements[k]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(
            ERR_OK, detune_begin(&detune, &plant, &loops.pairs, 1, NULL, &c, &reason), where);
        enum err err;
        while ((err = detune_step(&detune)) == ERR_BUSY)
            ;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, err, where);
        TEST_ASSERT_EQUAL_INT(
            ERR_OK, nyquist_begin(&nyquist, &plant, &detune.loops, REAL_C(1.6), (real_t)INFINITY));
        while (nyquist_step(&nyquist) == ERR_BUSY)
            ;
        TEST_ASSERT_TRUE_MESSAGE(nyquist.stable, where);
    }
}

static void expect_refused(const char *field, double lag, double square, double zero)
{
    double v[5] = {1, 1, lag, square, zero};
    set_element(0, 0, v);
    TEST_ASSERT_NOT_EQUAL(ERR_OK, interact_check(&plant, &reason));
    TEST_ASSERT_EQUAL_STRING(field, reason.field);
}

static void shapes_that_make_no_sense_are_refused_by_name(void)
{
    expect_refused("square_s2", 10, -1, 0);
    expect_refused("square_s2", 1e6, 1.1e12, 0);
    expect_refused("square_s2", 10, (double)NAN, 0);
    expect_refused("square_s2", 0, 1, 0);      /* undamped */
    expect_refused("square_s2", 0.19, 100, 0); /* damping 0.0095 */
    expect_refused("zero_s", 10, 1, 1.1e6);
    expect_refused("zero_s", 10, 1, -1.1e6);
    expect_refused("zero_s", 10, 1, (double)NAN);
    expect_refused("zero_s", 0, 0, 1); /* more zeros than poles */
    double v[5] = {1, 1, 1e6, 2.5e11, -1e6};
    set_element(0, 0, v);
    TEST_ASSERT_EQUAL_INT(ERR_OK, interact_check(&plant, NULL));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(responses_are_those_of_the_exact_element);
    RUN_TEST(loops_on_such_elements_are_judged_as_their_eigenvalues_judge);
    RUN_TEST(a_narrow_resonance_is_not_stepped_over);
    RUN_TEST(elements_are_reduced_by_skogestads_rules);
    RUN_TEST(the_reduction_is_continuous_where_lags_become_equal);
    RUN_TEST(such_elements_get_settings_that_are_stable);
    RUN_TEST(shapes_that_make_no_sense_are_refused_by_name);
    return UNITY_END();
}
