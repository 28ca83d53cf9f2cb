/* Minimum variance: on linear minimum-phase plants that it does not know, the self-tuner comes within 3 % of the least variance
 * that any controller can reach, in the number format of the build. N = 100,000 samples, forgetting 0.998, lambda 0, a square wave
 * of one noise deviation on the setpoint, g0 kept within [g/5, 5 g] by simplified correction.
 *
 * The least variance of y(t) - w(t - k) is that of what nobody can know k samples ahead: sigma^2 (e_0^2 + ... + e_(k-1)^2), e the
 * first terms of 1/A, or of 1/(A Delta) where the noise is integrated. The estimate of a variance from N samples is good to
 * sqrt(2/N) = 0.45 %, and forgetting costs about parameters * (1 - 0.998)/2 = 0.3 %. */
#include <math.h>
#include <stdio.h>

#include "gmv_bench.h"
#include "random_source.h"
#include "unity.h"

#define SAMPLES 100000u
#define BEGIN   2000u /* tuned in by then */
#define SIGMA   0.01
#define SEED    20261125u
#define WITHIN  1.03

static struct gmv_bench b;
static struct random_source source;

void setUp(void)
{
    source.state = SEED;
    memset(&b, 0, sizeof b);
}

void tearDown(void) {}

static double normal(void)
{
    double u = ((double)(random_next(&source) >> 11) + 0.5) / 9007199254740992.0;
    double v = (double)(random_next(&source) >> 11) / 9007199254740992.0;
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

static void plant_of(unsigned loops, enum gmv_form form, unsigned k, unsigned nc)
{
    static const double a[2] = {0.8, 0.7}, g[2][2] = {{-0.3, 0.12}, {-0.1, 0.4}};
    b.config = gmv_plain_config((uint8_t)loops);
    b.config.shape.form = (uint8_t)form;
    b.config.shape.nb = (uint8_t)k;
    b.config.shape.nc = (uint8_t)nc;
    b.config.rls.forget = 0.998f;
    b.config.rls.correction = RLS_CORRECT_SPC;
    for (unsigned i = 0; i < loops; i++) {
        b.plant.a[i] = a[i];
        for (unsigned j = 0; j < loops; j++) {
            b.plant.b[i][j] = g[i][j];
            b.plant.k[i][j] = b.config.shape.delay[i][j] = (uint8_t)k;
        }
        int own = gmv_place_of_u(&b.config.shape, i, i);
        double sign = g[i][i] < 0 ? -1 : 1, size = fabs(g[i][i]);
        b.config.theta[i][own] = (float)(sign * size * 2); /* twice too large */
        b.config.lo[i][own] = (float)(sign < 0 ? -5 * size : size / 5);
        b.config.hi[i][own] = (float)(sign < 0 ? -size / 5 : 5 * size);
    }
}

/* The least variance, in sigma^2. */
static double least_variance(double a, enum gmv_form form, unsigned k)
{
    double sum = 0, e = 1, power = 1;
    for (unsigned l = 0; l < k; l++) {
        sum += e * e;
        power *= a;
        e = form == GMV_INCREMENTAL ? e + power : power;
    }
    return sum;
}

/* Returns the worst loop's variance over the least. `recovered`: samples after the gains have changed by `factor` in the midst of
 * the run until the squares of the errors over 100 samples are back below twice the least; NULL: they do not change. */
static double run(unsigned loops, enum gmv_form form, unsigned k, unsigned nc, double factor,
                  unsigned *recovered)
{
    double square[2] = {0, 0}, window = 0, noise[2] = {0, 0}, w_before[2][4] = {{0}};
    unsigned counted = 0, good_at = 0;
    plant_of(loops, form, k, nc);
    gmv_bench_begin(&b, 0);
    for (unsigned t = 0; t < SAMPLES; t++) {
        double w[2];
        for (unsigned i = 0; i < loops; i++) {
            w[i] = (t / (20 + 7 * i)) % 2 ? SIGMA : -SIGMA;
            noise[i] = SIGMA * normal() + (form == GMV_INCREMENTAL ? noise[i] : 0);
            double error = b.plant.y[i] - w_before[i][k - 1];
            square[i] += t >= BEGIN ? error * error : 0;
            if (i == 0)
                window += (error * error - window) / 100;
            memmove(&w_before[i][1], &w_before[i][0], 3 * sizeof(double));
            w_before[i][0] = w[i];
            for (unsigned j = 0; j < loops && t == SAMPLES / 2; j++)
                b.plant.b[i][j] *= factor;
        }
        counted += t >= BEGIN;
        if (t > SAMPLES / 2 + 100 && !good_at &&
            window < 2 * SIGMA * SIGMA * least_variance(0.8, form, k))
            good_at = t - SAMPLES / 2;
        gmv_bench_step(&b, w, noise, true);
    }
    if (recovered)
        *recovered = good_at;
    double worst = 0;
    for (unsigned i = 0; i < loops; i++)
        worst = fmax(worst,
                     square[i] / counted / (SIGMA * SIGMA) / least_variance(b.plant.a[i], form, k));
    return worst;
}

static double ratio_of(unsigned loops, enum gmv_form form, unsigned k, unsigned nc)
{
    setUp();
    double ratio = run(loops, form, k, nc, 1, NULL);
    printf("%u loops, %s, k = %u, nc = %u: variance %.4f of the least\n", loops,
           form == GMV_INCREMENTAL ? "incremental" : "positional", k, nc, ratio);
    return ratio;
}

static void one_loop_comes_to_the_least_variance(void)
{
    TEST_ASSERT_TRUE(ratio_of(1, GMV_POSITIONAL, 1, 0) < WITHIN);
    TEST_ASSERT_TRUE(ratio_of(1, GMV_INCREMENTAL, 1, 0) < WITHIN);
}

/* Differences over two steps make a moving average 1 + z^-1 of integrated white noise: without a past prediction in the regression
 * the incremental form cannot know the part of it that has been seen. */
static void one_loop_with_a_longer_dead_time_does_as_well_incremental_with_a_past_prediction(void)
{
    TEST_ASSERT_TRUE(ratio_of(1, GMV_POSITIONAL, 2, 0) < WITHIN);
    TEST_ASSERT_TRUE(ratio_of(1, GMV_INCREMENTAL, 2, 1) < WITHIN);
    TEST_ASSERT_TRUE(ratio_of(1, GMV_INCREMENTAL, 2, 0) > WITHIN);
}

static void two_loops_together_come_to_the_least_variance(void)
{
    TEST_ASSERT_TRUE(ratio_of(2, GMV_POSITIONAL, 1, 0) < WITHIN);
    TEST_ASSERT_TRUE(ratio_of(2, GMV_INCREMENTAL, 1, 0) < WITHIN);
}

static void after_the_gain_has_changed_it_comes_back(void)
{
    static const double factors[] = {0.5, 2};
    for (unsigned form = 0; form < 2; form++)
        for (unsigned f = 0; f < 2; f++) {
            unsigned samples = 0;
            setUp();
            (void)run(1, (enum gmv_form)form, 1, 0, factors[f], &samples);
            printf("%s, gain times %g: below twice the least variance again after %u samples\n",
                   form == GMV_INCREMENTAL ? "incremental" : "positional", factors[f], samples);
            TEST_ASSERT_TRUE(samples > 0 && samples < 2000); /* four memories of 1/(1 - 0.998) */
        }
}

/* Digest of Folami (1989), 5.3.2: y(t+1) = p y(t) + (1 - p) w(t), here with parameters that were learnt under P. */
static void with_p_the_learnt_loop_is_first_order_with_its_time_constant(void)
{
    for (unsigned form = 0; form < 2; form++) {
        const double none[2] = {0, 0}, p = exp(-30.0 / 60);
        setUp();
        plant_of(1, (enum gmv_form)form, 1, 0);
        b.config.tau_p_s[0] = 60;
        gmv_bench_begin(&b, 0);
        for (unsigned t = 0; t < 400; t++) {
            double w[2] = {(t / 20) % 2 ? 0.1 : -0.1, 0}, before = b.plant.y[0];
            gmv_bench_step(&b, w, none, true);
            if (t >= 300)
                TEST_ASSERT_DOUBLE_WITHIN(1e-3, p * before + (1 - p) * w[0], b.plant.y[0]);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    printf("seed %u\n", SEED);
    RUN_TEST(one_loop_comes_to_the_least_variance);
    RUN_TEST(one_loop_with_a_longer_dead_time_does_as_well_incremental_with_a_past_prediction);
    RUN_TEST(two_loops_together_come_to_the_least_variance);
    RUN_TEST(after_the_gain_has_changed_it_comes_back);
    RUN_TEST(with_p_the_learnt_loop_is_first_order_with_its_time_constant);
    return UNITY_END();
}
