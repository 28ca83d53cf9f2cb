/* A first-order model from a frequency response (design/response_fit.h), in single and double precision. Contract: an exact response of 400 random
 * models on 16 frequencies gives gain, time constant and dead time again within 0.2, 0.4 and 0.2 % of the sum of times; with 1 % of noise
 * within 5 %. */
#include <math.h>
#include <stdio.h>

#include "design/response_fit.h"
#include "interact/plant.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static unsigned long long seed = 20031903;

static double drawn(void) /* -1 to 1 */
{
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(long long)(seed >> 11) / 4503599627370496.0 - 1.0;
}

static size_t grid(real_t *omega, double lo, double hi, size_t n)
{
    for (size_t i = 0; i < n; i++)
        omega[i] = (real_t)(lo * pow(hi / lo, (double)i / (double)(n - 1)));
    return n;
}

static void a_model_is_found_again(void)
{
    real_t omega[16], error;
    struct cplx g[16];
    for (unsigned k = 0; k < 400; k++) {
        double scale = pow(10, 2 * drawn()), part = 0.5 + 0.45 * drawn();
        struct fopdt m = {.gain = (real_t)(pow(10, 2 * drawn()) * (drawn() > 0 ? 1 : -1)),
                          .dead_time_s = (real_t)(scale * part),
                          .time_constant_s = (real_t)(scale * (1 - part))},
                     found;
        size_t n = grid(omega, 0.1 / scale, 6 / scale, 16);
        for (size_t i = 0; i < n; i++)
            g[i] = fopdt_response(&m, omega[i]);
        TEST_ASSERT_EQUAL(ERR_OK,
                          fopdt_from_response(n, omega, g, (real_t)(2 * scale), &found, &error));
        TEST_ASSERT_TRUE(error < REAL_C(1e-3));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * fabs((double)m.gain), (double)m.gain, (double)found.gain);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * scale, (double)m.dead_time_s, (double)found.dead_time_s);
        TEST_ASSERT_DOUBLE_WITHIN(4e-3 * scale, (double)m.time_constant_s,
                                  (double)found.time_constant_s);
    }
}

static void noise_of_a_hundredth_moves_a_model_little(void)
{
    real_t omega[16], error;
    struct cplx g[16];
    for (unsigned k = 0; k < 400; k++) {
        double part = 0.5 + 0.4 * drawn();
        struct fopdt m = {.gain = 2,
                          .dead_time_s = (real_t)part,
                          .time_constant_s = (real_t)(1 - part)},
                     found;
        size_t n = grid(omega, 0.1, 6, 16);
        for (size_t i = 0; i < n; i++)
            g[i] = cplx_mul(fopdt_response(&m, omega[i]),
                            cplx((real_t)(1 + 0.01 * drawn()), (real_t)(0.01 * drawn())));
        TEST_ASSERT_EQUAL(ERR_OK, fopdt_from_response(n, omega, g, 2, &found, &error));
        TEST_ASSERT_TRUE(error > REAL_C(1e-4) && error < REAL_C(0.02));
        TEST_ASSERT_DOUBLE_WITHIN(0.05, (double)m.dead_time_s, (double)found.dead_time_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, (double)m.time_constant_s, (double)found.time_constant_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 2, (double)found.gain);
    }
}

static void a_response_of_another_kind_has_its_error_told(void)
{
    real_t omega[16], error;
    struct cplx g[16];
    struct fopdt found;
    size_t n = grid(omega, 0.1, 6, 16);
    for (size_t i = 0; i < n; i++) { /* a resonance */
        struct cplx s = cplx(0, omega[i]);
        g[i] = cplx_div(cplx(1, 0),
                        cplx_add(cplx(1, 0), cplx_add(cplx_scale(s, REAL_C(0.2)), cplx_mul(s, s))));
    }
    TEST_ASSERT_EQUAL(ERR_OK, fopdt_from_response(n, omega, g, 5, &found, &error));
    TEST_ASSERT_TRUE(error > REAL_C(0.3));
}

static void a_pure_gain_and_a_pure_dead_time_are_models(void)
{
    real_t omega[8], error;
    struct cplx g[8];
    struct fopdt found;
    size_t n = grid(omega, 0.1, 6, 8);
    for (unsigned delayed = 0; delayed < 2; delayed++) {
        const struct fopdt same = {.gain = -3, .dead_time_s = delayed ? REAL_C(0.7) : 0};
        for (size_t i = 0; i < n; i++)
            g[i] = fopdt_response(&same, omega[i]);
        TEST_ASSERT_EQUAL(ERR_OK, fopdt_from_response(n, omega, g, 2, &found, &error));
        TEST_ASSERT_DOUBLE_WITHIN(0.02, -3, (double)found.gain);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, delayed ? 0.7 : 0, (double)found.dead_time_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, (double)found.time_constant_s);
    }
}

static void a_dead_time_is_not_above_the_most_that_was_asked_for(void)
{
    real_t omega[8], error;
    struct cplx g[8];
    struct fopdt found;
    const struct fopdt late = {
        .gain = 2, .dead_time_s = REAL_C(1.02), .time_constant_s = REAL_C(0.5)};
    size_t n = grid(omega, 0.1, 6, 8);
    for (size_t i = 0; i < n; i++)
        g[i] = fopdt_response(&late, omega[i]);
    TEST_ASSERT_EQUAL(ERR_OK, fopdt_from_response(n, omega, g, 1, &found, &error));
    TEST_ASSERT_TRUE(found.dead_time_s <= 1);
}

/* A lead: the best model with a time constant of 0 and above has 0, and the gain that fits best then. */
static void where_no_lag_fits_the_gain_alone_is_the_best_there_is(void)
{
    real_t omega[16], error;
    struct cplx g[16];
    struct fopdt found;
    size_t n = grid(omega, 0.1, 6, 16);
    for (size_t i = 0; i < n; i++)
        g[i] = cplx(2, REAL_C(0.6) * omega[i]);
    TEST_ASSERT_EQUAL(ERR_OK, fopdt_from_response(n, omega, g, 0, &found, &error));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, (double)found.time_constant_s);
    for (int side = -1; side <= 1; side += 2) {
        double sum = 0;
        for (size_t i = 0; i < n; i++)
            sum += (double)(cplx_square(cplx_sub(
                                cplx(found.gain * (1 + REAL_C(0.02) * (real_t)side), 0), g[i])) /
                            cplx_square(g[i]));
        TEST_ASSERT_TRUE(sqrt(sum / (double)n) > (double)error);
    }
}

static void responses_that_are_none_are_refused(void)
{
    real_t omega[3] = {REAL_C(0.1), 1, 6}, error;
    struct cplx g[3] = {{1, 0}, {REAL_C(0.5), REAL_C(-0.5)}, {0, REAL_C(-0.1)}};
    struct fopdt found;
    TEST_ASSERT_EQUAL(ERR_RANGE, fopdt_from_response(2, omega, g, 1, &found, &error));
    TEST_ASSERT_EQUAL(ERR_RANGE, fopdt_from_response(3, omega, g, -1, &found, &error));
    g[1].re = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, fopdt_from_response(3, omega, g, 1, &found, &error));
    g[1] = cplx(0, 0);
    TEST_ASSERT_EQUAL(ERR_RANGE, fopdt_from_response(3, omega, g, 1, &found, &error));
    g[1] = cplx(1, 0);
    omega[0] = 0;
    TEST_ASSERT_EQUAL(ERR_RANGE, fopdt_from_response(3, omega, g, 1, &found, &error));
}

static void in_pieces_it_is_the_same(void)
{
    real_t omega[16], error;
    struct cplx g[16];
    const struct fopdt m = {.gain = 2, .dead_time_s = REAL_C(0.43), .time_constant_s = REAL_C(1.1)};
    struct fopdt whole;
    struct response_fit f;
    unsigned pieces = 1;
    size_t n = grid(omega, 0.1, 6, 16);
    for (size_t i = 0; i < n; i++)
        g[i] = fopdt_response(&m, omega[i]);
    TEST_ASSERT_EQUAL(ERR_OK, fopdt_from_response(n, omega, g, 2, &whole, &error));
    TEST_ASSERT_EQUAL(ERR_OK, response_fit_begin(&f, n, omega, g, 2));
    while (response_fit_piece(&f, n, omega, g))
        pieces++;
    TEST_ASSERT_TRUE(pieces >= 40 && pieces <= 50);
    TEST_ASSERT_EQUAL_MEMORY(&whole, &f.best, sizeof whole);
    TEST_ASSERT_EQUAL_MEMORY(&error, &f.error, sizeof error);
}

int main(void)
{
    printf("seed %llu\n", seed);
    UNITY_BEGIN();
    RUN_TEST(a_model_is_found_again);
    RUN_TEST(noise_of_a_hundredth_moves_a_model_little);
    RUN_TEST(a_response_of_another_kind_has_its_error_told);
    RUN_TEST(a_pure_gain_and_a_pure_dead_time_are_models);
    RUN_TEST(a_dead_time_is_not_above_the_most_that_was_asked_for);
    RUN_TEST(where_no_lag_fits_the_gain_alone_is_the_best_there_is);
    RUN_TEST(responses_that_are_none_are_refused);
    RUN_TEST(in_pieces_it_is_the_same);
    return UNITY_END();
}
