/* design/loops.[ch], design/nyquist.[ch], design/trial.[ch]; built in float and in double.
 *
 * Contract, SIMC loops on every plant of host_sim/plants against tests/reference/loops_reference.py
 *   stable or not               as the eigenvalues of the sampled loops say, where 1 % of the gains does not decide
 *   log modulus                 within 0.1 dB of a fine grid up to 10 dB, 0.5 dB beyond, where peaks are narrow
 *   step responses              integral of |e| within 1 %, peaks and moves within 1e-3 of the step and of the move, settling
 *                               times within two samples, of an exact simulation; in double all to 1e-6
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "design/nyquist.h"
#include "design/trial.h"
#include "interact_plants.h"
#include "unity.h"

static struct known_plant known;
static struct loops loops;
static struct nyquist nyquist;
static struct trial trial;

void setUp(void) {}
void tearDown(void) {}

/* Signed gains and integral times of up to four loops. */
static void set_loops(const double *gain, const double *ti, double interval)
{
    memset(&loops, 0, sizeof loops);
    loops.pairs = known.pairs;
    loops.interval_s = (real_t)interval;
    loops.derivative_filter = 8;
    for (unsigned k = 0; k < known.pairs.n; k++)
        loops.tuning[k] = (struct tuning){.gain = (real_t)fabs(gain[k]),
                                          .ti_s = (real_t)ti[k],
                                          .action = gain[k] < 0 ? TUNING_DIRECT : TUNING_REVERSE};
}

static enum err follow(double times)
{
    TEST_ASSERT_EQUAL_INT(
        ERR_OK, nyquist_begin(&nyquist, &known.plant, &loops, (real_t)times, (real_t)INFINITY));
    enum err err;
    while ((err = nyquist_step(&nyquist)) == ERR_BUSY)
        ;
    return err;
}

static void loops_are_stable_where_their_eigenvalues_say_so(void)
{
    FILE *f = csv_open("reference/nyquist.csv");
    double v[13], worst = 0.0;
    unsigned stable = 0, unstable = 0, most = 0;
    while (csv_row(f, v, 13)) {
        char where[64];
        snprintf(where, sizeof where, "plant %.0f, gains times %g", v[0], v[2]);
        known_plant((unsigned)v[0], &known);
        set_loops(v + 3, v + 7, v[1]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, follow(v[2]), where);
        TEST_ASSERT_EQUAL_INT_MESSAGE((int)v[11], nyquist.stable, where);
        most = nyquist.points > most ? nyquist.points : most;
        unstable += v[11] == 0.0;
        if (v[11] == 0.0)
            continue;
        stable++;
        double bound = v[12] < 10.0 ? 0.1 : 0.5;
        worst = fmax(worst, fabs(v[12] - (double)nyquist.log_modulus_db));
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(bound, v[12], (double)nyquist.log_modulus_db, where);
    }
    fclose(f);
    printf("nyquist: %u stable, %u unstable, log modulus within %.3f dB, at most %u frequencies\n",
           stable, unstable, worst, most);
    TEST_ASSERT_GREATER_THAN_UINT(25, stable);
    TEST_ASSERT_GREATER_THAN_UINT(20, unstable);
}

/* One loop 1/(T s + 1) e^{-Ls} with integral action only in effect: L(s) = k e^{-Ls}/s with Ti = T, K = k T. Its gain
 * margin is pi/(2 k L). */
static void the_edge_of_stability_of_a_single_loop_is_where_theory_puts_it(void)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 1;
    known.plant.element[0][0] = (struct fopdt){REAL_C(2.0), REAL_C(20.0), REAL_C(60.0)};
    double gain = 60.0 / 2.0 / 20.0, ti = 60.0; /* k = 1/L */
    set_loops(&gain, &ti, 1e-3);
    double edge = 3.14159265358979 / 2.0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(0.99 * edge));
    TEST_ASSERT_TRUE(nyquist.stable);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(1.01 * edge));
    TEST_ASSERT_FALSE(nyquist.stable);
    gain = -gain; /* the wrong sign is never stable, however small */
    set_loops(&gain, &ti, 1e-3);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(0.01));
    TEST_ASSERT_FALSE(nyquist.stable);
}

/* Ticks of 0.05 s on a plant with a time constant of ten hours: exp(-h/T) is 1 in float, nearly. */
static void fast_sampling_of_a_slow_plant_loses_nothing(void)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 1;
    known.plant.element[0][0] = (struct fopdt){REAL_C(2.0), REAL_C(100.0), REAL_C(36000.0)};
    double gain = 36000.0 / 2.0 / 100.0, ti = 36000.0, edge = 3.14159265358979 / 2.0; /* as above */
    set_loops(&gain, &ti, 0.05);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(0.99 * edge));
    TEST_ASSERT_TRUE(nyquist.stable);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(1.01 * edge));
    TEST_ASSERT_FALSE(nyquist.stable);
}

/* A loop with Skogestad's settings, in seconds and in milliseconds. */
static void a_curve_is_the_same_in_another_unit_of_time(void)
{
    double gain = 20.0 / 2.0 / 6.0, db = 0.0;
    uint16_t points = 0;
    for (unsigned k = 0; k < 2; k++) {
        double unit = k ? 1e-3 : 1.0, ti = 20.0 * unit;
        memset(&known, 0, sizeof known);
        known.plant.outputs = known.plant.inputs = known.pairs.n = 1;
        known.plant.element[0][0] =
            (struct fopdt){REAL_C(2.0), (real_t)(3.0 * unit), (real_t)(20.0 * unit)};
        set_loops(&gain, &ti, unit);
        TEST_ASSERT_EQUAL_INT(ERR_OK, follow(1.0));
        TEST_ASSERT_TRUE(nyquist.stable);
        if (k) {
            TEST_ASSERT_UINT16_WITHIN(2, points, nyquist.points);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, db, (double)nyquist.log_modulus_db);
        }
        points = nyquist.points;
        db = (double)nyquist.log_modulus_db;
    }
}

static void loops_on_a_negative_niederlinski_index_are_unstable_however_slow(void)
{
    known_plant(PLANT_WOOD_BERRY, &known);
    known.pairs = (struct pairs){2, {0, 1}, {1, 0}};
    double gain[2] = {-0.01, 0.01}, ti[2] = {1260.0, 654.0};
    set_loops(gain, ti, 60.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(1.0));
    TEST_ASSERT_FALSE(nyquist.stable);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(0.01));
    TEST_ASSERT_FALSE(nyquist.stable);
}

static void a_limit_ends_the_search_early(void)
{
    known_plant(PLANT_WOOD_BERRY, &known);
    double gain[2] = {5.0, -2.0}, ti[2] = {1002.0, 864.0};
    set_loops(gain, ti, 60.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(0.5));
    unsigned points = nyquist.points;
    TEST_ASSERT_TRUE(nyquist.log_modulus_db > REAL_C(1.0));
    TEST_ASSERT_EQUAL_INT(ERR_OK, nyquist_begin(&nyquist, &known.plant, &loops, REAL_C(0.5), 1));
    enum err err;
    while ((err = nyquist_step(&nyquist)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_FALSE(nyquist.stable);
    TEST_ASSERT_LESS_THAN_UINT(points, nyquist.points);
    TEST_ASSERT_EQUAL_INT(ERR_STATE, nyquist_step(&nyquist));
}

static void sixteen_loops_are_followed(void)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 16;
    double gain[16], ti[16];
    memset(&loops, 0, sizeof loops);
    for (unsigned i = 0; i < 16; i++) {
        known.pairs.output[i] = known.pairs.input[i] = (uint8_t)i;
        gain[i] = 1.5 * (1 + i) / 3.0;
        ti[i] = 20.0 * (1 + i);
        for (unsigned j = 0; j < 16; j++)
            known.plant.element[i][j] = (struct fopdt){
                i == j ? 1 : REAL_C(0.1), (real_t)(3 + (i + j) % 3), (real_t)(20 * (1 + i))};
    }
    set_loops(gain, ti, 1.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(1.0));
    TEST_ASSERT_TRUE(nyquist.stable);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(10.0));
    TEST_ASSERT_FALSE(nyquist.stable);
}

static void decoupled_loops_are_seen_with_their_decoupler(void)
{
    /* K = [1 0.8; 0.8 1], D = [1 -0.8; -0.8 1]: loops of gain 0.36 that do not see each other */
    static struct matrix d;
    d = (struct matrix){2, 2, {{1, REAL_C(-0.8)}, {REAL_C(-0.8), 1}}};
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 2;
    known.pairs.output[1] = known.pairs.input[1] = 1;
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            known.plant.element[i][j] =
                (struct fopdt){i == j ? 1 : REAL_C(0.8), REAL_C(20.0), REAL_C(60.0)};
    double gain[2] = {3.0 / 0.36, 3.0 / 0.36}, ti[2] = {60, 60};
    set_loops(gain, ti, 1e-2);
    loops.decoupler = &d;
    double edge = 3.14159265358979 / 2.0; /* of each loop on its own, as above */
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(0.98 * edge));
    TEST_ASSERT_TRUE(nyquist.stable);
    TEST_ASSERT_EQUAL_INT(ERR_OK, follow(1.02 * edge));
    TEST_ASSERT_FALSE(nyquist.stable);
    struct trial_config c = {.size = REAL_C(0.01), .setpoint_weight = 1};
    TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&trial, &known.plant, &loops, &c));
    enum err err;
    while ((err = trial_step(&trial)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, (double)trial.loop[1].peak); /* the other never moves */
}

static void steps_are_those_of_an_exact_simulation(void)
{
#ifdef REFLUX_REAL_DOUBLE
    const double part = 1e-6, samples = 1e-3;
#else
    const double part = 1e-2, samples = 2.01;
#endif
    FILE *f = csv_open("reference/trial.csv");
    double v[29];
    unsigned rows = 0;
    while (csv_row(f, v, 29)) {
        char where[64];
        snprintf(where, sizeof where, "plant %.0f, loop %.0f, load %.0f", v[0], v[2], v[3]);
        known_plant((unsigned)v[0], &known);
        set_loops(v + 5, v + 9, v[1]);
        struct trial_config c = {.loop = (uint8_t)v[2],
                                 .load = v[3] != 0.0,
                                 .size = REAL_C(0.01),
                                 .duration_s = (real_t)v[4],
                                 .setpoint_weight = REAL_C(0.7)};
        TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&trial, &known.plant, &loops, &c));
        enum err err;
        while ((err = trial_step(&trial)) == ERR_BUSY)
            ;
        TEST_ASSERT_EQUAL_INT(ERR_OK, err);
        TEST_ASSERT_TRUE(trial.bounded);
        TEST_ASSERT_FALSE(trial.coarse);
        TEST_ASSERT_EQUAL_UINT32(1600, trial.sample);
        for (unsigned k = 0; k < known.pairs.n; k++) {
            const struct trial_loop *r = &trial.loop[k];
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(part * v[13 + k] + 1e-5, v[13 + k], (double)r->iae,
                                              where);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.1 * part, v[17 + k], (double)r->peak, where);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(samples * v[1], v[21 + k], (double)r->settled_s,
                                              where);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.1 * part * v[25 + k] + 1e-9, v[25 + k],
                                              (double)r->moved, where);
        }
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_UINT(40, rows);
}

/* One loop on 1/(60 s + 1), dead time 10 s, K = 2, Ti = 60 s, from a step downwards. */
static void run_one_loop(real_t mark_s)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 1;
    known.plant.element[0][0] = (struct fopdt){1, 10, 60};
    double gain = 2, ti = 60;
    set_loops(&gain, &ti, 1.0);
    struct trial_config c = {
        .size = REAL_C(-0.01), .duration_s = 600, .setpoint_weight = 1, .mark_s = mark_s};
    TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&trial, &known.plant, &loops, &c));
    while (trial_step(&trial) == ERR_BUSY)
        ;
}

static void a_mark_remembers_how_far_a_step_had_come(void)
{
    run_one_loop(0);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)trial.mark.iae);
    run_one_loop(8); /* in the dead time: nothing has moved but the input */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.08, (double)trial.mark.iae);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.01, (double)trial.mark.left);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.02 * (1 + 7.0 / 60), (double)trial.mark.moved[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -0.02 * (1 + 7.0 / 60), (double)trial.mark.input[0]);
    run_one_loop(40);
    double then = (double)trial.mark.iae;
    TEST_ASSERT_TRUE(then > 0.1 && then < (double)trial.loop[0].iae);
    TEST_ASSERT_TRUE(trial.mark.left > REAL_C(0.002) && trial.mark.left < REAL_C(0.009));
    run_one_loop(600); /* the end */
    TEST_ASSERT_EQUAL_FLOAT((float)trial.loop[0].iae, (float)trial.mark.iae);
    TEST_ASSERT_EQUAL_FLOAT((float)trial.loop[0].moved, (float)trial.mark.moved[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, (double)trial.mark.left);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -0.01, (double)trial.mark.input[0]);
}

static real_t error_of_the_other(double gain, double raise)
{
    double gains[2] = {gain, 0.3}, ti[2] = {600, 600};
    set_loops(gains, ti, 10.0);
    struct trial_config c = {
        .size = REAL_C(0.01), .duration_s = 3000, .setpoint_weight = 1, .raise = (real_t)raise};
    TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&trial, &known.plant, &loops, &c));
    while (trial_step(&trial) == ERR_BUSY)
        ;
    return trial.loop[1].iae;
}

static void a_raised_gain_is_that_of_the_stepped_loop_alone(void)
{
    known_plant(PLANT_WOOD_BERRY, &known);
    TEST_ASSERT_EQUAL_FLOAT((float)error_of_the_other(0.75, 0),
                            (float)error_of_the_other(0.5, 1.5));
    TEST_ASSERT_TRUE(error_of_the_other(0.5, 0) < error_of_the_other(0.5, 1.5));
    struct trial_config c = {.size = REAL_C(0.01), .setpoint_weight = 1, .raise = 11};
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, trial_begin(&trial, &known.plant, &loops, &c));
}

static void an_unstable_trial_is_cut_off(void)
{
    known_plant(PLANT_FURNACE, &known);
    double gain[4] = {3000, 3000, 3000, 3000}, ti[4] = {30, 30, 30, 30};
    set_loops(gain, ti, 10.0);
    struct trial_config c = {.size = REAL_C(-0.01), .duration_s = 1000, .setpoint_weight = 1};
    TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&trial, &known.plant, &loops, &c));
    enum err err;
    while ((err = trial_step(&trial)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_FALSE(trial.bounded);
    TEST_ASSERT_EQUAL_FLOAT(1000.0f, (float)trial.loop[0].settled_s);
    TEST_ASSERT_EQUAL_INT(ERR_STATE, trial_step(&trial));
}

static void a_long_dead_time_lengthens_the_samples_and_is_said(void)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 1;
    known.plant.element[0][0] = (struct fopdt){1, 10000, 10};
    double gain = 0.0005, ti = 10;
    set_loops(&gain, &ti, 1.0);
    struct trial_config c = {.size = 1, .setpoint_weight = 1};
    TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&trial, &known.plant, &loops, &c));
    TEST_ASSERT_TRUE(trial.step_s > REAL_C(39.0));
    TEST_ASSERT_TRUE(trial.coarse);
    enum err err;
    while ((err = trial_step(&trial)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_TRUE(trial.bounded);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0, (double)trial.y[0]);
}

/* Against a slow sinusoid, where the sampled law is the continuous one: -3 (1 + 1/(50 s) + 12 s/(1 + 12 s/8)). */
static void the_controllers_response_is_that_of_the_ideal_form(void)
{
    double gain = -3.0, ti = 50.0, h = 1e-3, w = 0.05, x = w * 12, y = x / 8;
    double re = 1 + x * y / (1 + y * y), im = -1 / (w * ti) + x / (1 + y * y);
    known.pairs.n = 1;
    set_loops(&gain, &ti, h);
    loops.tuning[0].td_s = 12;
    struct cplx c = loops_controller(&loops, 0, (real_t)h, loops_z_less_1((real_t)(w * h)));
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, -3 * re, (double)c.re);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, -3 * im, (double)c.im);
}

/* u(k) of the sampled law for an impulse, summed over z^-k. */
static void the_controllers_response_is_that_of_the_sampled_law(void)
{
    double gain = 2.0, ti = 20.0, h = 5.0, td = 6.0, tf = td / 8, w = 0.3;
    known.pairs.n = 1;
    set_loops(&gain, &ti, h);
    loops.tuning[0].td_s = (real_t)td;
    double re = 0, im = 0, integral = 0, d = 0, last = 0;
    for (int k = 0; k < 400; k++) {
        double e = k == 0 ? 1 : 0;
        d = tf / (tf + h) * d + gain * td / (tf + h) * (e - last);
        integral += gain * h / ti * e;
        re += (gain * e + d) * cos(w * h * k);
        im -= (gain * e + d) * sin(w * h * k);
        last = e;
    }
    /* a constant from k = 1 on: its sum is 1/(z - 1) */
    double zr = cos(w * h) - 1, zi = sin(w * h), size = zr * zr + zi * zi;
    re += integral * zr / size;
    im -= integral * zi / size;
    struct cplx c = loops_controller(&loops, 0, (real_t)h, loops_z_less_1((real_t)(w * h)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, re, (double)c.re);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, im, (double)c.im);
}

static void loops_that_make_no_sense_are_refused_by_name(void)
{
    static struct matrix d;
    struct interact_refusal reason;
    known_plant(PLANT_WOOD_BERRY, &known);
    double gain[2] = {1, -1}, ti[2] = {100, 100};
    set_loops(gain, ti, 60.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, loops_check(&known.plant, &loops, NULL));
    loops.tuning[1].ti_s = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, loops_check(&known.plant, &loops, &reason));
    TEST_ASSERT_EQUAL_STRING("ti_s", reason.field);
    TEST_ASSERT_EQUAL_UINT8(1, reason.output);
    set_loops(gain, ti, 60.0);
    loops.tuning[0].gain = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, loops_check(&known.plant, &loops, &reason));
    TEST_ASSERT_EQUAL_STRING("gain", reason.field);
    set_loops(gain, ti, (double)NAN);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, loops_check(&known.plant, &loops, &reason));
    TEST_ASSERT_EQUAL_STRING("interval_s", reason.field);
    set_loops(gain, ti, 60.0);
    loops.pairs.output[1] = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, loops_check(&known.plant, &loops, &reason));
    set_loops(gain, ti, 60.0);
    d = (struct matrix){3, 3, {{1}}};
    loops.decoupler = &d;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, loops_check(&known.plant, &loops, &reason));
    TEST_ASSERT_EQUAL_STRING("decoupler", reason.field);
    d = (struct matrix){2, 2, {{1, (real_t)NAN}, {0, 1}}};
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, loops_check(&known.plant, &loops, &reason));
    set_loops(gain, ti, 60.0);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, nyquist_begin(&nyquist, &known.plant, &loops, (real_t)NAN, 1));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, nyquist_begin(&nyquist, &known.plant, &loops, 1, (real_t)NAN));
    struct trial_config c = {.size = (real_t)NAN, .setpoint_weight = 1};
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, trial_begin(&trial, &known.plant, &loops, &c));
    c.size = 1;
    c.loop = 2;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, trial_begin(&trial, &known.plant, &loops, &c));
    c.loop = 1;
    loops.tuning[0].td_s = 1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, trial_begin(&trial, &known.plant, &loops, &c));
    known.plant.element[0][0].gain = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, nyquist_begin(&nyquist, &known.plant, &loops, 1, 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(loops_are_stable_where_their_eigenvalues_say_so);
    RUN_TEST(the_edge_of_stability_of_a_single_loop_is_where_theory_puts_it);
    RUN_TEST(fast_sampling_of_a_slow_plant_loses_nothing);
    RUN_TEST(a_curve_is_the_same_in_another_unit_of_time);
    RUN_TEST(loops_on_a_negative_niederlinski_index_are_unstable_however_slow);
    RUN_TEST(a_limit_ends_the_search_early);
    RUN_TEST(sixteen_loops_are_followed);
    RUN_TEST(decoupled_loops_are_seen_with_their_decoupler);
    RUN_TEST(steps_are_those_of_an_exact_simulation);
    RUN_TEST(a_mark_remembers_how_far_a_step_had_come);
    RUN_TEST(a_raised_gain_is_that_of_the_stepped_loop_alone);
    RUN_TEST(an_unstable_trial_is_cut_off);
    RUN_TEST(a_long_dead_time_lengthens_the_samples_and_is_said);
    RUN_TEST(the_controllers_response_is_that_of_the_ideal_form);
    RUN_TEST(the_controllers_response_is_that_of_the_sampled_law);
    RUN_TEST(loops_that_make_no_sense_are_refused_by_name);
    return UNITY_END();
}
