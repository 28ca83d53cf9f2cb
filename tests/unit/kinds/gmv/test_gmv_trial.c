/* The trial of a closed loop against the loop itself: the law of the self-tuner (kinds/gmv/gmv.h) on a plant in double whose gains are
 * those of the model, half of them, and twice.
 *
 * Contract: the decay per step within 0.006. Both are read from the largest size in windows of 128 steps, of which the loop in
 * fixed point has two before it is at rest; they differ by up to a factor of two with the phase of an oscillation:
 * 2^(1/128) = 1.0054. Of what is gone within a window no more is asked than that the trial finds so, too. */
#include <math.h>
#include <stdio.h>

#include "gmv_bench.h"
#include "kinds/gmv/gmv_trial_state.h"
#include "unity.h"

#define DECAY_WITHIN 0.006
#define GONE_IN_ONE  0.914 /* 1e-5 after 128 steps */

static struct gmv_bench b;
static struct gmv_trial trial;
static const double none[GMV_LOOPS] = {0, 0};

void setUp(void)
{
    memset(&b, 0, sizeof b);
}

void tearDown(void) {}

#define PIECES_MOST 2000u

static struct gmv_trial_pi pi[GMV_LOOPS];

static void run_trial(uint8_t acting, float margin)
{
    unsigned pieces = 1;
    gmv_trial_take(&trial, b.gmv, acting, margin, pi);
    while (gmv_trial_piece(&trial))
        TEST_ASSERT_TRUE(pieces++ < PIECES_MOST);
}

/* Returns the decay of the loop itself with the plant's gains times `factor`, from the same upset. */
static double real_decay(const struct gmv_bench *from, double factor)
{
    struct gmv_bench run = *from;
    double size[5] = {0};
    for (unsigned i = 0; i < GMV_LOOPS; i++)
        for (unsigned j = 0; j < GMV_LOOPS; j++)
            run.plant.b[i][j] *= factor;
    gmv_bench_begin(&run, 0);
    gmv_bench_step(&run, none, none, false);
    run.plant.y[0] = 0.5;
    run.plant.y[1] = run.config.shape.loops == 2 ? -0.35 : 0;
    for (unsigned t = 0; t < 640; t++) {
        gmv_bench_step(&run, none, none, false);
        for (unsigned i = 0; i < run.config.shape.loops; i++)
            size[t / 128] = fmax(size[t / 128], fabs(run.plant.y[i]));
    }
    unsigned last = 4;
    while (last > 1 && size[last] < 1e-5 * size[0])
        last--;
    return last == 1 ? pow(size[1] / size[0], 1.0 / 128)
                     : pow(size[last] / size[1], 1.0 / (128 * (last - 1)));
}

static void agrees(const char *what)
{
    static const double factor[GMV_TRIAL_GAINS] = {1, 0.5, 2};
    gmv_bench_begin(&b, 0);
    run_trial(b.acting, 2);
    for (unsigned k = 0; k < GMV_TRIAL_GAINS; k++) {
        double is = real_decay(&b, factor[k]), told = (double)gmv_trial_decay(&trial, k);
        printf("%s, gains times %.1f: decay %.4f, trial %.4f\n", what, factor[k], is, told);
        if (is < GONE_IN_ONE)
            TEST_ASSERT_TRUE_MESSAGE(told < GONE_IN_ONE + DECAY_WITHIN, what);
        else if (is > 0.9995) /* it swings between limits that the trial has not */
            TEST_ASSERT_TRUE_MESSAGE(told > 1, what);
        else
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(DECAY_WITHIN, is, told, what);
    }
}

static void one_loop(enum gmv_form form, double a, double g, double lambda)
{
    b.config = gmv_plain_config(1);
    b.config.shape.form = (uint8_t)form;
    b.config.shape.bias = GMV_BIAS_NONE;
    b.config.lambda[0] = (float)lambda;
    b.config.theta[0][0] = (float)a;
    b.config.theta[0][1] = (float)g;
    b.plant = (struct gmv_plant){.a = {a}, .b = {{g}}, .k = {{1}}};
}

static void it_decays_as_the_loop_itself_does(void)
{
    one_loop(GMV_INCREMENTAL, 0.9, 0.05, 2);
    agrees("incremental");
    one_loop(GMV_INCREMENTAL, 0.98, -0.05, -4);
    agrees("incremental, negative gain");
    one_loop(GMV_POSITIONAL, 0.95, 0.05, 2);
    agrees("positional");
    one_loop(GMV_POSITIONAL, 0.95, 0.05, 0.5);
    b.config.shape.weight = GMV_WEIGHT_SCALAR;
    agrees("positional, scalar");
    one_loop(GMV_INCREMENTAL, 0.95, 0.05, 1);
    b.config.tau_p_s[0] = 90;
    b.config.theta[0][0] = (float)((0.95 - exp(-30.0 / 90)) / (1 - exp(-30.0 / 90)));
    b.config.theta[0][1] = (float)(0.05 / (1 - exp(-30.0 / 90)));
    agrees("incremental, P of 90 s");
    b.config.shape.bias = GMV_BIAS_ERROR;
    agrees("incremental, P of 90 s, with the prediction error");
}

static void a_longer_horizon_is_tried_as_it_is(void)
{
    for (unsigned form = 0; form < 2; form++) { /* y(t+2) = a^2 y + g u(t) + a g u(t-1) */
        one_loop((enum gmv_form)form, 0.9, 0.1, 3);
        b.config.shape.nb = 2;
        b.config.shape.delay[0][0] = 2;
        b.plant.k[0][0] = 2;
        b.config.theta[0][0] = 0.81f;
        b.config.theta[0][1] = 0.1f;
        b.config.theta[0][2] = 0.09f;
        agrees(form ? "incremental, two steps" : "positional, two steps");
        b.config.shape.weight = GMV_WEIGHT_SCALAR;
        agrees(form ? "incremental, two steps, scalar" : "positional, two steps, scalar");
        if (form) {
            b.config.shape.bias = GMV_BIAS_ERROR;
            agrees("incremental, two steps, scalar, with the prediction error");
        }
    }
}

static void a_law_made_of_a_model_is_tried_with_that_model(void)
{
    for (unsigned k = 1; k <= 4; k++) {
        one_loop(GMV_POSITIONAL, 0.9, 0.1, 3);
        b.config.shape.way = GMV_EXPLICIT;
        b.config.shape.delay[0][0] = (uint8_t)k;
        b.plant.k[0][0] = k;
        agrees("explicit");
    }
}

static void two_loops_are_tried_together(void)
{
    b.config = gmv_plain_config(2);
    b.config.lambda[0] = -2;
    b.config.lambda[1] = 3;
    static const float theta[2][3] = {{0.95f, -0.05f, 0.03f},
                                      {0.9f, 0.1f, -0.06f}}; /* own MV first */
    memcpy(b.config.theta[0], theta[0], sizeof theta[0]);
    memcpy(b.config.theta[1], theta[1], sizeof theta[1]);
    b.plant = (struct gmv_plant){
        .a = {0.95, 0.9}, .b = {{-0.05, 0.03}, {-0.06, 0.1}}, .k = {{1, 1}, {1, 1}}};
    agrees("two loops");
    /* Each by itself would pull against the other. */
    b.config.lambda[0] = b.config.lambda[1] = 0.1f;
    static const float alike[2][3] = {{0.9f, 0.1f, 0.12f}, {0.9f, 0.1f, -0.12f}};
    memcpy(b.config.theta[0], alike[0], sizeof alike[0]);
    memcpy(b.config.theta[1], alike[1], sizeof alike[1]);
    b.plant = (struct gmv_plant){
        .a = {0.9, 0.9}, .b = {{0.1, 0.12}, {-0.12, 0.1}}, .k = {{1, 1}, {1, 1}}};
    agrees("two loops, strongly coupled");
}

static void an_mv_that_is_later_at_the_other_pv_is_tried_so(void)
{
    b.config = gmv_plain_config(2);
    b.plant = (struct gmv_plant){
        .a = {0.97, 0.97}, .b = {{0.1, 0.06}, {0.06, 0.1}}, .k = {{1, 3}, {3, 1}}};
    for (unsigned i = 0; i < 2; i++) {
        static const float theta[3] = {0.97f, 0.1f, 0.06f}; /* own MV first */
        memcpy(b.config.theta[i], theta, sizeof theta);
        b.config.lambda[i] = 1;
        b.config.shape.delay[i][1 - i] = 3;
    }
    agrees("two loops, each MV later at the other PV");
}

/* The equations are {1, 2} and {-0.504, 1.5}, or the loops the other way round: of rows that are divided by their largest elements
 * the determinant is 0.836. */
static void where_the_law_takes_loops_one_by_one_the_trial_does(void)
{
    static const float own[2] = {0.5f, 0.75f}, cross[2] = {2, -0.504f};
    for (unsigned alone = 0; alone < 2; alone++)
        for (unsigned first = 0; first < 2; first++) {
            b.config = gmv_plain_config(2);
            b.config.determinant = alone ? 0.85f : 0.82f;
            memset(&b.plant, 0, sizeof b.plant);
            for (unsigned i = 0; i < 2; i++) {
                unsigned k = i ^ first;
                b.config.lambda[i] = own[k];
                b.config.theta[i][0] = 0.95f;
                b.config.theta[i][1] = own[k]; /* own MV first */
                b.config.theta[i][2] = cross[k];
                b.plant.a[i] = 0.95;
                b.plant.b[i][i] = (double)own[k];
                b.plant.b[i][1 - i] = (double)cross[k];
                b.plant.k[i][0] = b.plant.k[i][1] = 1;
            }
            agrees(alone ? "two loops, one by one" : "two loops, together");
        }
}

static void loops_whose_mvs_do_nothing_are_left_to_themselves(void)
{
    static const float theta[2][3] = {{0.95f, 0, 0}, {0.95f, 0, 0}};
    b.config = gmv_plain_config(2);
    b.config.shape.form = GMV_POSITIONAL;
    b.config.shape.bias = GMV_BIAS_NONE;
    memcpy(b.config.theta[0], theta[0], sizeof theta[0]);
    memcpy(b.config.theta[1], theta[1], sizeof theta[1]);
    gmv_bench_begin(&b, 0);
    run_trial(3, 2);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.95f, gmv_trial_worst(&trial));
}

/* Its own MV does nothing for loop 1, and much for loop 2: it stays where it is. */
static void an_mv_that_does_nothing_for_its_own_loop_does_not_move(void)
{
    static const float theta[2][3] = {{0.95f, 0, 0}, {0.9f, 0.1f, 0.1f}}; /* own MV first */
    b.config = gmv_plain_config(2);
    b.config.shape.form = GMV_POSITIONAL;
    b.config.shape.bias = GMV_BIAS_NONE;
    memcpy(b.config.theta[0], theta[0], sizeof theta[0]);
    memcpy(b.config.theta[1], theta[1], sizeof theta[1]);
    b.config.lambda[1] = 0.3f;
    gmv_bench_begin(&b, 0);
    run_trial(3, 2);
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 0.95f, gmv_trial_worst(&trial));
}

static void a_loop_that_does_not_act_is_left_out(void)
{
    one_loop(GMV_INCREMENTAL, 0.9, 0.05, 2);
    gmv_bench_begin(&b, 0);
    run_trial(1, 2);
    float alone = gmv_trial_decay(&trial, 0);
    b.config = gmv_plain_config(2);
    static const float theta[2][3] = {{0.9f, 0.05f, 0.03f}, {0, 0, 0}};
    memcpy(b.config.theta[0], theta[0], sizeof theta[0]);
    b.config.lambda[0] = 2;
    gmv_bench_begin(&b, 0);
    run_trial(1, 2);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, alone, gmv_trial_decay(&trial, 0));
}

/* y(t+1) = a y + g u with lambda 0: with the plant's gain r times the model's, y multiplies by 1 - r in each step beside
 * what a does; from r = 2 on it grows. */
static void a_loop_that_cannot_bear_its_margin_grows(void)
{
    one_loop(GMV_INCREMENTAL, 0.5, 0.2, 0);
    gmv_bench_begin(&b, 0);
    run_trial(1, 3);
    TEST_ASSERT_TRUE(gmv_trial_decay(&trial, 0) < GONE_IN_ONE);
    TEST_ASSERT_TRUE(gmv_trial_decay(&trial, 2) > 1);
    TEST_ASSERT_EQUAL_FLOAT(gmv_trial_decay(&trial, 2), gmv_trial_worst(&trial));
}

/* A tick may clear the state during a piece. */
static void a_trial_of_nothing_ends(void)
{
    memset(&trial, 0, sizeof trial);
    unsigned pieces = 1;
    while (gmv_trial_piece(&trial))
        TEST_ASSERT_TRUE(pieces++ < PIECES_MOST);
}

/* ---- against the PI ---- */

/* Half of a trial's run; signals are so much of it, within the range of the fixed build. */
#define HALF 320u
#define SIZE 0.1

struct sums {
    double setpoint, load, noise, moves;
};

/* The plant goes on under u, with the load if there is one: what is measured next. */
static double plant_goes_on(double u, double load)
{
    static const double no_noise[GMV_LOOPS] = {0};
    memmove(&b.plant.u[0][1], &b.plant.u[0][0], (BENCH_DEPTH - 1u) * sizeof(double));
    b.plant.u[0][0] = u + load;
    gmv_plant_step(&b.plant, 1, no_noise);
    return b.plant.y[0];
}

static double law_moves(double w, double y)
{
    struct gmv_sample s = gmv_bench_sample(&b, &w);
    s.y[0] = num_from_float((float)y);
    gmv_take(b.gmv, &s);
    (void)gmv_solve(b.gmv, &s, 1, &b.range, b.u);
    applied_history_append(gmv_history_of(&b, 0), b.u[0]);
    return (double)num_to_float(b.u[0]);
}

static double pi_moves(double w, double y, bool first)
{
    static double error, u;
    double before = first ? 0 : error;
    u = (first ? 0 : u) + (double)pi[0].gain * (w - y - before) + (double)pi[0].integral * before;
    error = w - y;
    return u;
}

/* A setpoint and a load, or a sample of noise, as the trial has them. */
static struct sums control(bool law, double *load)
{
    struct sums sums = {0};
    for (unsigned noise = 0; noise < 2; noise++) {
        double u = 0, y = 0, w = noise ? 0 : SIZE, added = 0;
        gmv_bench_begin(&b, 0);
        b.plant.y[0] = 0;
        (void)law_moves(0, 0);
        for (unsigned t = 0; t < 2 * HALF; t++) {
            double measured = noise && t == 0 ? y + SIZE : y;
            if (!noise && t == HALF && law)
                *load = -u;
            added = !noise && t >= HALF ? *load : 0;
            double next = law ? law_moves(w, measured) : pi_moves(w, measured, t == 0);
            *(noise      ? &sums.noise
              : t < HALF ? &sums.setpoint
                         : &sums.load) += noise ? y * y : fabs(w - y);
            sums.moves += noise ? (next - u) * (next - u) : 0;
            u = next;
            y = plant_goes_on(u, added);
        }
    }
    return sums;
}

static const float unknown[GMV_LOOPS] = {0, 0};

static void law_and_pi_agree_with_the_trial(const char *what)
{
    float error_more, moves;
    double load = 0;
    gmv_bench_begin(&b, 0);
    run_trial(1, 1.25f);
    struct sums law = control(true, &load), loop = control(false, &load);
    double ratio = fmax(law.setpoint / loop.setpoint, law.load / loop.load);
    double told = (double)gmv_trial_ratio(&trial, unknown);
    gmv_trial_noise(&trial, 0, &error_more, &moves);
    printf("%s: errors %.3f times the PI's, trial %.3f; moves after noise %.2f, %.2f\n", what,
           ratio, told, law.moves / (SIZE * SIZE), (double)moves);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01 * ratio, ratio, told, what);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01 * law.moves / (SIZE * SIZE), law.moves / (SIZE * SIZE),
                                      (double)moves, what);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01, (law.noise - loop.noise) / (SIZE * SIZE),
                                      (double)error_more, what);
}

static void errors_of_law_and_pi_are_those_of_the_loops_themselves(void)
{
    one_loop(GMV_INCREMENTAL, 0.9, 0.05, 0.05);
    pi[0] = (struct gmv_trial_pi){.gain = 4, .integral = 0.4f};
    law_and_pi_agree_with_the_trial("a law that is faster");
    TEST_ASSERT_TRUE(gmv_trial_ratio(&trial, unknown) < 1);
    one_loop(GMV_INCREMENTAL, 0.9, 0.05, 2);
    law_and_pi_agree_with_the_trial("a law that is slower");
    TEST_ASSERT_TRUE(gmv_trial_ratio(&trial, unknown) > 1);
    one_loop(GMV_INCREMENTAL, 0.9, -0.1, -0.3); /* y(t+2) = a^2 y + g u(t) + a g u(t-1) */
    b.config.shape.nb = 2;
    b.config.shape.delay[0][0] = 2;
    b.plant.k[0][0] = 2;
    b.config.theta[0][0] = 0.81f;
    b.config.theta[0][1] = -0.1f;
    b.config.theta[0][2] = -0.09f;
    pi[0] = (struct gmv_trial_pi){.gain = -2, .integral = -0.2f};
    law_and_pi_agree_with_the_trial("a delay of two steps");
}

static void a_setpoint_that_weighs_as_the_pv_does_is_tried_so(void)
{
    one_loop(GMV_INCREMENTAL, 0.95, 0.05, 0.5);
    b.config.tau_p_s[0] = 90;
    b.config.tau_r_s[0] = -1;
    b.config.theta[0][0] = (float)((0.95 - exp(-30.0 / 90)) / (1 - exp(-30.0 / 90)));
    b.config.theta[0][1] = (float)(0.05 / (1 - exp(-30.0 / 90)));
    pi[0] = (struct gmv_trial_pi){.gain = 4, .integral = 0.4f};
    law_and_pi_agree_with_the_trial("R is P");
    float weighed = gmv_trial_ratio(&trial, unknown);
    b.config.tau_r_s[0] = 0;
    law_and_pi_agree_with_the_trial("R is 1");
    TEST_ASSERT_TRUE(weighed < 0.95f * gmv_trial_ratio(&trial, unknown));
}

/* A PI that does worse on the model than it ever did says that the model is wrong. */
static void a_better_answer_of_the_pi_itself_counts_in_place_of_that_on_the_model(void)
{
    one_loop(GMV_INCREMENTAL, 0.9, 0.05, 2);
    pi[0] = (struct gmv_trial_pi){.gain = 0.5f, .integral = 0.05f};
    gmv_bench_begin(&b, 0);
    run_trial(1, 1.25f);
    float answer[GMV_LOOPS] = {trial.sums[1][0].setpoint * 1.1f, 0};
    TEST_ASSERT_EQUAL_FLOAT(gmv_trial_ratio(&trial, unknown), gmv_trial_ratio(&trial, answer));
    answer[0] = trial.sums[0][0].setpoint / 2;
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 2, gmv_trial_ratio(&trial, answer));
}

/* Its errors grow by 1.7 a step: without a limit they would be no numbers long before the trial ends. */
static void a_law_is_better_than_a_pi_that_the_model_is_unstable_with(void)
{
    float error_more = 0, moves = 0;
    one_loop(GMV_INCREMENTAL, 0.9, 0.05, 0.05);
    pi[0] = (struct gmv_trial_pi){.gain = 60, .integral = 20};
    gmv_bench_begin(&b, 0);
    run_trial(1, 1.25f);
    TEST_ASSERT_TRUE(gmv_trial_ratio(&trial, unknown) < 0.01f);
    gmv_trial_noise(&trial, 0, &error_more, &moves);
    TEST_ASSERT_TRUE(error_more < 0);
    TEST_ASSERT_TRUE(moves < 1e6f);
}

static void a_second_trial_has_its_lambda_times_more_and_nothing_else(void)
{
    one_loop(GMV_INCREMENTAL, 0.9, 0.05, 0.5);
    pi[0] = (struct gmv_trial_pi){.gain = 4, .integral = 0.4f};
    gmv_bench_begin(&b, 0);
    run_trial(1, 1.25f);
    gmv_trial_again(&trial, 4);
    while (gmv_trial_piece(&trial)) {
    }
    struct gmv_trial_sums again = trial.sums[0][0];
    float decay = gmv_trial_worst(&trial);
    b.config.lambda[0] *= 4;
    gmv_bench_begin(&b, 0);
    run_trial(1, 1.25f);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, gmv_trial_worst(&trial), decay);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f * again.setpoint, trial.sums[0][0].setpoint, again.setpoint);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f * again.load, trial.sums[0][0].load, again.load);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f * again.moves, trial.sums[0][0].moves, again.moves);
}

static void no_number_among_the_parameters_is_no_decay(void)
{
    one_loop(GMV_INCREMENTAL, 0.9, 0.05, 2);
    gmv_bench_begin(&b, 0);
    gmv_use(b.gmv, 0, 0, num_from_float(100));
    gmv_use(b.gmv, 0, 1, num_from_float(-100));
    run_trial(1, 2);
    TEST_ASSERT_TRUE(gmv_trial_worst(&trial) > 1);
#ifndef REFLUX_FIXED_POINT
    gmv_use(b.gmv, 0, 0, NAN);
    run_trial(1, 2);
    TEST_ASSERT_TRUE(gmv_trial_worst(&trial) > 1);
#endif
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_decays_as_the_loop_itself_does);
    RUN_TEST(a_longer_horizon_is_tried_as_it_is);
    RUN_TEST(a_law_made_of_a_model_is_tried_with_that_model);
    RUN_TEST(two_loops_are_tried_together);
    RUN_TEST(an_mv_that_is_later_at_the_other_pv_is_tried_so);
    RUN_TEST(where_the_law_takes_loops_one_by_one_the_trial_does);
    RUN_TEST(loops_whose_mvs_do_nothing_are_left_to_themselves);
    RUN_TEST(an_mv_that_does_nothing_for_its_own_loop_does_not_move);
    RUN_TEST(a_loop_that_does_not_act_is_left_out);
    RUN_TEST(a_loop_that_cannot_bear_its_margin_grows);
    RUN_TEST(a_trial_of_nothing_ends);
    RUN_TEST(errors_of_law_and_pi_are_those_of_the_loops_themselves);
    RUN_TEST(a_setpoint_that_weighs_as_the_pv_does_is_tried_so);
    RUN_TEST(a_better_answer_of_the_pi_itself_counts_in_place_of_that_on_the_model);
    RUN_TEST(a_law_is_better_than_a_pi_that_the_model_is_unstable_with);
    RUN_TEST(a_second_trial_has_its_lambda_times_more_and_nothing_else);
    RUN_TEST(no_number_among_the_parameters_is_no_decay);
    return UNITY_END();
}
