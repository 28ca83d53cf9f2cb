/* identify/moments.[ch], identify/excitation.[ch], identify/identified.[ch].
 *
 * Contract (both scalar types)
 *   running sums             2e-5 relative of their definition in double (tests/reference/identify_sums.csv): e^-alpha h
 *                            is rounded once, which is a change of alpha of that size, known to the estimate
 *   noise-free elements      2 % in K, 2 % of L + T in L and in T, over all first-order elements of the plants furnace,
 *                            air compressor, Wood-Berry, Luyben-Vinante, packed bed, lime kiln and Shell, all outputs of
 *                            an input at once; measured: below 0.001 %
 *   lag of a few samples     the same, lags from 0.3 samples, any fraction of dead time
 *   standard deviations      within a factor 1.5 of the scatter over 400 records
 */
#include <string.h>

#include "csv.h"
#include "identify/moments.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20240607u

static struct moments bank;

void setUp(void) {}
void tearDown(void) {}

static void start(uint32_t outputs, double h_s)
{
    struct moments_config c = {outputs, MOMENTS_ALPHAS_MAX, (real_t)h_s, MOMENTS_FASTEST,
                               MOMENTS_RATIO};
    TEST_ASSERT_EQUAL_INT(ERR_OK, moments_init(&bank, &c));
}

static void step_one(double y)
{
    real_t value = (real_t)y;
    TEST_ASSERT_EQUAL_INT(ERR_OK, moments_step(&bank, &value));
}

/* One element alone, h = 1 s, double step of amplitude over half samples each way. */
static struct identified identify(struct test_element e, uint32_t half, uint32_t samples,
                                  double amplitude, const struct baseline *b)
{
    struct excitation u;
    struct identified r;
    start(1, 1.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 9, half, half, (real_t)amplitude));
    for (uint32_t k = 0; k < samples; k++)
        step_one(amplitude * double_step_response(&e, half, half, k) +
                 (b ? (double)b->offset : 0.0) + (b ? (double)b->slope_per_s * k : 0.0));
    TEST_ASSERT_EQUAL_INT(ERR_OK, moments_element(&bank, 0, &u, b, 0, &r, NULL));
    return r;
}

static void the_sums_are_those_of_their_definition(void)
{
    FILE *f = csv_open("reference/identify_sums.csv");
    double v[8];
    int rows = 0;
    while (csv_row(f, v, 8)) {
        struct test_element e = {1.0, v[0], v[1]};
        struct moments_config c = {1, 1, 1, (real_t)v[4], MOMENTS_RATIO};
        TEST_ASSERT_EQUAL_INT(ERR_OK, moments_init(&bank, &c));
        for (uint32_t k = 0; k < (uint32_t)v[3]; k++)
            step_one(double_step_response(&e, v[2], v[2], k));
        for (int n = 0; n < 3; n++)
            TEST_ASSERT_DOUBLE_WITHIN(2e-5 * (fabs(v[5 + n]) + fabs(v[5])), v[5 + n],
                                      (double)bank.alpha[0].sum[0][n].value);
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_INT(16, rows);
}

struct row {
    int plant, output, input;
    struct test_element e;
    uint32_t half, samples;
};

static void column_is_identified(const struct row *rows, int n, double *worst)
{
    struct excitation u;
    real_t reference[CHANNEL_MAX], y[CHANNEL_MAX];
    start((uint32_t)n, 2.0);
    for (int i = 0; i < n; i++)
        reference[i] = (real_t)(0.1 * (i + 1));
    TEST_ASSERT_EQUAL_INT(ERR_OK, moments_begin(&bank, reference));
    TEST_ASSERT_EQUAL_INT(ERR_OK,
                          excitation_double_step(&u, 0, rows->half, rows->half, (real_t)0.05));
    for (uint32_t k = 0; k < rows->samples; k++) {
        for (int i = 0; i < n; i++)
            y[i] = (real_t)(0.1 * (i + 1) +
                            0.05 * double_step_response(&rows[i].e, rows->half, rows->half, k));
        TEST_ASSERT_EQUAL_INT(ERR_OK, moments_step(&bank, y));
    }
    for (int i = 0; i < n; i++) {
        struct identified r;
        const struct test_element *e = &rows[i].e;
        TEST_ASSERT_EQUAL_INT(ERR_OK, moments_element(&bank, (uint32_t)i, &u, NULL, 0, &r, NULL));
        double time = e->lag + e->dead;
        double off[3] = {fabs((double)r.gain / e->gain - 1.0),
                         fabs((double)r.time_constant_s / 2.0 - e->lag) / time,
                         fabs((double)r.dead_time_s / 2.0 - e->dead) / time};
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_TRUE(off[k] < 0.02);
            worst[k] = off[k] > worst[k] ? off[k] : worst[k];
        }
        TEST_ASSERT_EQUAL_HEX16(0, r.flags);
    }
}

static void every_first_order_element_of_the_plants_comes_back(void)
{
    FILE *f = csv_open("reference/identify_elements.csv");
    double v[20], worst[3] = {0, 0, 0};
    struct row rows[64];
    int n = 0;
    while (n < 64 && csv_row(f, v, 20)) {
        rows[n] = (struct row){(int)v[0],          (int)v[1],      (int)v[2],
                               {v[5], v[4], v[3]}, (uint32_t)v[6], (uint32_t)v[7]};
        /* the records below are the reference's */
        for (int k = 8; k < 20; k += 2)
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, v[k + 1],
                                      double_step_response(&rows[n].e, v[6], v[6], v[k]));
        n++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_INT(54, n);
    for (int plant = 0; plant < 7; plant++)
        for (int input = 0; input < 4; input++) {
            struct row column[CHANNEL_MAX];
            int m = 0;
            for (int i = 0; i < n; i++)
                if (rows[i].plant == plant && rows[i].input == input)
                    column[m++] = rows[i];
            if (m > 0)
                column_is_identified(column, m, worst);
        }
    char text[120];
    snprintf(text, sizeof text, "54 elements, worst: K %.4f %%, T %.4f %%, L %.4f %% of L + T",
             100 * worst[0], 100 * worst[1], 100 * worst[2]);
    TEST_MESSAGE(text);
}

static void lags_of_a_few_samples_and_fractions_of_dead_time_come_back(void)
{
    struct random_source source = {SEED};
    for (int i = 0; i < 300; i++) {
        struct test_element e = {uniform(&source, 0.2, 3.0), spread_over(&source, 0.3, 8.0),
                                 uniform(&source, 0.0, 12.0)};
        uint32_t half = (uint32_t)(5.0 * (e.lag + e.dead)) + 2;
        struct identified r = identify(e, half, 3 * half + 10, 0.05, NULL);
        double time = e.lag + e.dead;
        TEST_ASSERT_EQUAL_HEX16(0, r.flags);
        TEST_ASSERT_DOUBLE_WITHIN(0.001 * e.gain, e.gain, (double)r.gain);
        TEST_ASSERT_DOUBLE_WITHIN(0.002 * time, e.lag, (double)r.time_constant_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.002 * time, e.dead, (double)r.dead_time_s);
    }
}

/* The guard ends the positive half early; the negative one may be cut too. */
static void a_double_step_that_was_cut_gives_the_same_element(void)
{
    struct test_element e = {1.5, 40.0, 6.0};
    for (uint32_t t2 = 20; t2 <= 60; t2 += 20) {
        struct excitation u;
        struct identified r;
        start(1, 1.0);
        TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 0, 30, t2, (real_t)0.1));
        for (uint32_t k = 0; k < 500; k++)
            step_one(0.1 * double_step_response(&e, 30, t2, k));
        TEST_ASSERT_EQUAL_INT(ERR_OK, moments_element(&bank, 0, &u, NULL, 0, &r, NULL));
        TEST_ASSERT_DOUBLE_WITHIN(0.003, 1.5, (double)r.gain);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 40.0, (double)r.time_constant_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 6.0, (double)r.dead_time_s);
    }
}

static void offset_and_drift_are_removed(void)
{
    struct test_element e = {-0.8, 50.0, 10.0};
    struct baseline b = {(real_t)0.003, (real_t)2e-5, 0, 0, 0};
    struct identified r = identify(e, 300, 900, 0.05, &b);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, -0.8, (double)r.gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 50.0, (double)r.time_constant_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 10.0, (double)r.dead_time_s);
}

static void a_line_through_two_means_is_the_drift_with_its_deviation(void)
{
    struct baseline b;
    TEST_ASSERT_EQUAL_INT(
        ERR_OK, baseline_from_means(-10, 1, (real_t)0.3, 30, 3, (real_t)0.4, (real_t)0.1, &b));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, (double)b.slope_per_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.5, (double)b.offset);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 / 40.0, (double)b.slope_sd_per_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, sqrt(81.0 + 16.0) / 40.0, (double)b.offset_sd);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, baseline_from_means(5, 0, 0, 5, 0, 0, 0, &b));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, baseline_from_means(0, 0, -1, 5, 0, 0, 0, &b));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, baseline_from_means(0, (real_t)NAN, 0, 5, 0, 0, 0, &b));
}

static void a_guess_of_residence_time_chooses_the_alpha(void)
{
    struct test_element e = {1.0, 60.0, 20.0};
    struct excitation u;
    struct identified r;
    uint32_t chosen;
    start(1, 1.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 0, 400, 400, 1));
    for (uint32_t k = 0; k < 1300; k++)
        step_one(double_step_response(&e, 400, 400, k));
    /* with and without a guess, wrong as it may be, it ends at the alpha nearest 1/80 */
    const real_t guesses[] = {0, 80, 10, 1000};
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, moments_element(&bank, 0, &u, NULL, guesses[i], &r, &chosen));
        TEST_ASSERT_DOUBLE_WITHIN(0.42, 0.0, log((double)moments_alpha(&bank, chosen) * 80.0));
    }
}

static void an_output_that_follows_at_once_has_no_lag_and_no_dead_time(void)
{
    struct identified r = identify((struct test_element){2.5, 0.0, 0.0}, 50, 150, 0.1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 2.5, (double)r.gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)r.time_constant_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)r.dead_time_s);
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_NEGATIVE_RADICAND, r.flags);
}

/* y = 1 - 0.6 e^-t/T: jumps to 0.4 at once, so that no first-order lag with L >= 0 is spread as widely. */
static void a_response_that_jumps_first_takes_its_fall_back_and_says_so(void)
{
    struct excitation u;
    struct identified r;
    struct test_element lag = {0.6, 40.0, 0.0}, jump = {0.4, 0.0, 0.0};
    start(1, 1.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 0, 300, 300, 1));
    for (uint32_t k = 0; k < 900; k++)
        step_one(double_step_response(&lag, 300, 300, k) +
                 double_step_response(&jump, 300, 300, k));
    TEST_ASSERT_EQUAL_INT(ERR_OK, moments_element(&bank, 0, &u, NULL, 0, &r, NULL));
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_NEGATIVE_L, r.flags);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)r.dead_time_s);
    TEST_ASSERT_TRUE(r.time_constant_s > 5 && r.time_constant_s < 40);
    TEST_ASSERT_DOUBLE_WITHIN(0.15, 1.0, (double)r.gain);
}

/* An unstable element 1/(1 - T s) climbs for ever: a > 1/alpha, T < 0 by the formula. */
static void a_response_that_grows_gives_a_negative_time_constant_and_says_so(void)
{
    struct excitation u;
    struct identified r;
    real_t raw = 0;
    bool seen = false;
    start(1, 1.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 0, 100, 100, 1));
    for (uint32_t k = 0; k < 200; k++)
        step_one(k <= 100 ? exp(k / 50.0) - 1.0
                          : exp(k / 50.0) - 2.0 * exp((k - 100) / 50.0) + 1.0);
    for (uint32_t i = 0; i < bank.alphas; i++)
        if (moments_at(&bank, i, 0, &u, NULL, &r, &raw) == ERR_OK &&
            (r.flags & IDENTIFIED_NEGATIVE_T)) {
            TEST_ASSERT_TRUE(raw < 0);
            TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)r.time_constant_s);
            TEST_ASSERT_TRUE(real_is_finite(r.gain) && r.dead_time_s >= 0);
            seen = true;
        }
    TEST_ASSERT_TRUE(seen);
}

static void noise_alone_has_no_gain_and_no_times(void)
{
    struct random_source source = {SEED};
    struct excitation u;
    struct baseline b = {.noise_sd = (real_t)0.005};
    int found = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 0, 200, 200, (real_t)0.05));
    for (int i = 0; i < 400; i++) {
        struct identified r;
        start(1, 1.0);
        for (uint32_t k = 0; k < 600; k++)
            step_one(0.005 * normal(&source));
        TEST_ASSERT_EQUAL_INT(ERR_OK, moments_element(&bank, 0, &u, &b, 0, &r, NULL));
        if (r.flags & IDENTIFIED_NO_GAIN) {
            TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)(r.time_constant_s + r.dead_time_s));
            TEST_ASSERT_TRUE(r.gain_sd > 0);
        } else {
            found++;
        }
    }
    TEST_ASSERT_LESS_THAN_INT(12, found); /* 3 %: several alphas at 3 standard deviations each */
}

static void the_standard_deviations_are_those_of_the_scatter(void)
{
    struct random_source source = {SEED};
    struct test_element e = {1.0, 40.0, 10.0};
    struct excitation u;
    double sum[3] = {0, 0, 0}, square[3] = {0, 0, 0}, said[3] = {0, 0, 0};
    const int runs = 400;
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 0, 250, 250, (real_t)0.05));
    for (int i = 0; i < runs; i++) {
        /* offset from a mean of 50 samples before */
        double offset = 0.003 * normal(&source) / sqrt(50.0);
        struct baseline b = {.noise_sd = (real_t)0.003, .offset_sd = (real_t)(0.003 / sqrt(50.0))};
        struct identified r;
        start(1, 1.0);
        for (uint32_t k = 0; k < 750; k++)
            step_one(offset + 0.05 * double_step_response(&e, 250, 250, k) +
                     0.003 * normal(&source));
        TEST_ASSERT_EQUAL_INT(ERR_OK, moments_element(&bank, 0, &u, &b, 50, &r, NULL));
        const double v[3] = {(double)r.gain, (double)r.time_constant_s, (double)r.dead_time_s};
        const double s[3] = {(double)r.gain_sd, (double)r.time_constant_sd_s,
                             (double)r.dead_time_sd_s};
        for (int k = 0; k < 3; k++) {
            sum[k] += v[k];
            square[k] += v[k] * v[k];
            said[k] += s[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        double mean = sum[k] / runs, scatter = sqrt(square[k] / runs - mean * mean);
        char text[80];
        snprintf(text, sizeof text, "%c: scatter %.4f, said %.4f", "KTL"[k], scatter,
                 said[k] / runs);
        TEST_MESSAGE(text);
        TEST_ASSERT_TRUE(said[k] / runs < 1.5 * scatter && said[k] / runs > scatter / 1.5);
    }
}

/* 0.05 s samples, a process of half an hour: 36000 samples and 24 bits. */
static void tens_of_thousands_of_samples_do_not_wear_the_sums_out(void)
{
    struct test_element e = {0.4, 1500.0, 800.0};
    struct identified r = identify(e, 11500, 36000, 0.05, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.0004, 0.4, (double)r.gain);
    TEST_ASSERT_DOUBLE_WITHIN(2.5, 1500.0, (double)r.time_constant_s);
    TEST_ASSERT_DOUBLE_WITHIN(2.5, 800.0, (double)r.dead_time_s);
}

static void what_is_not_finite_is_refused_and_changes_nothing(void)
{
    const real_t bad[] = {(real_t)NAN, (real_t)INFINITY, (real_t)-INFINITY};
    start(2, 1.0);
    for (int i = 0; i < 3; i++) {
        struct moments was = bank;
        real_t y[2] = {1, bad[i]};
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, moments_step(&bank, y));
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, moments_begin(&bank, y));
        TEST_ASSERT_EQUAL_MEMORY(&was, &bank, sizeof was);
        struct excitation u;
        excitation_clear(&u);
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, excitation_move(&u, 0, bad[i]));
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, excitation_double_step(&u, 0, 5, 5, bad[i]));
        TEST_ASSERT_EQUAL_UINT32(0, u.edges);
        struct baseline b = {.slope_per_s = bad[i]};
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, baseline_validate(&b));
        struct moments_config c = {1, 3, bad[i], MOMENTS_FASTEST, MOMENTS_RATIO};
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, moments_init(&bank, &c));
    }
}

static void a_bank_out_of_range_is_refused(void)
{
    const struct moments_config bad[] = {{0, 3, 1, MOMENTS_FASTEST, 2},
                                         {CHANNEL_MAX + 1, 3, 1, MOMENTS_FASTEST, 2},
                                         {1, 0, 1, MOMENTS_FASTEST, 2},
                                         {1, MOMENTS_ALPHAS_MAX + 1, 1, MOMENTS_FASTEST, 2},
                                         {1, 3, 0, MOMENTS_FASTEST, 2},
                                         {1, 3, 1, 0, 2},
                                         {1, 3, 1, 2, 2},
                                         {1, 3, 1, MOMENTS_FASTEST, 1},
                                         {1, 12, 1, MOMENTS_FASTEST, 1000}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        TEST_ASSERT_EQUAL_INT(ERR_RANGE, moments_init(&bank, &bad[i]));
    TEST_ASSERT_EQUAL_UINT32(1, moments_alphas_for(1, 1));
    TEST_ASSERT_EQUAL_UINT32(7, moments_alphas_for(1, 100));
    TEST_ASSERT_EQUAL_UINT32(MOMENTS_ALPHAS_MAX, moments_alphas_for((real_t)0.05, 1e6));
}

static void without_samples_edges_or_strength_there_is_no_answer(void)
{
    struct excitation u;
    struct identified r;
    start(1, 1.0);
    excitation_clear(&u);
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, moments_element(&bank, 0, &u, NULL, 0, &r, NULL));
    step_one(0.0);
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, moments_element(&bank, 0, &u, NULL, 0, &r, NULL));
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 0, 10, 10, 1));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, moments_element(&bank, 1, &u, NULL, 0, &r, NULL));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, moments_element(&bank, 0, &u, NULL, -1, &r, NULL));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE,
                          moments_element(&bank, 0, &u, NULL, (real_t)NAN, &r, NULL));
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, moments_at(&bank, 11, 0, &u, NULL, &r, NULL));
    /* an output that did not move at all */
    for (int k = 0; k < 100; k++)
        step_one(0.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, moments_element(&bank, 0, &u, NULL, 0, &r, NULL));
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_NO_GAIN, r.flags);
}

static void rubbish_gives_an_error_or_finite_numbers(void)
{
    struct random_source source = {SEED};
    for (int i = 0; i < 2000; i++) {
        struct excitation u;
        start(1, 1.0);
        uint32_t t1 = 1 + random_below(&source, 60), t2 = 1 + random_below(&source, 60);
        double size = spread_over(&source, 1e-12, 1e12);
        TEST_ASSERT_EQUAL_INT(
            ERR_OK, excitation_double_step(&u, 0, t1, t2, (real_t)spread_over(&source, 1e-6, 1e6)));
        uint32_t n = 1 + random_below(&source, 150);
        for (uint32_t k = 0; k < n; k++)
            step_one(size * uniform(&source, -1.0, 1.0));
        for (uint32_t a = 0; a < bank.alphas; a++) {
            struct identified r;
            real_t raw;
            enum err err = moments_at(&bank, a, 0, &u, NULL, &r, &raw);
            if (err)
                continue;
            TEST_ASSERT_TRUE(real_is_finite(r.gain) && real_is_finite(r.gain_sd) &&
                             real_is_finite(raw));
            TEST_ASSERT_TRUE(r.time_constant_s >= 0 && r.dead_time_s >= 0);
            TEST_ASSERT_TRUE(real_is_finite(r.time_constant_s) && real_is_finite(r.dead_time_s));
        }
    }
}

/* Three times as long as 1/alpha is long enough: eta = 1/2 and 1/4 come out of exp and log as they went in. */
static void a_record_shorter_than_three_times_its_weight_says_so(void)
{
    static const uint32_t enough[] = {6, 12};
    for (uint32_t i = 0; i < 2; i++)
        for (uint32_t less = 0; less < 2; less++) {
            struct excitation u;
            struct identified r;
            start(1, 1.0);
            TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 0, 2, 2, REAL_C(0.1)));
            for (uint32_t k = 0; k < enough[i] - less; k++)
                step_one(0.1 *
                         double_step_response(&(struct test_element){1.0, 1.0, 0.0}, 2, 2, k));
            TEST_ASSERT_EQUAL_INT(ERR_OK, moments_at(&bank, i, 0, &u, NULL, &r, NULL));
            TEST_ASSERT_EQUAL_HEX16(less ? IDENTIFIED_SHORT : 0, r.flags & IDENTIFIED_SHORT);
        }
}

static void edges_keep_their_order_and_their_number(void)
{
    struct excitation u;
    excitation_clear(&u);
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_move(&u, 5, 2));
    TEST_ASSERT_EQUAL_INT(ERR_STATE, excitation_move(&u, 4, 3));
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_move(&u, 7, 2)); /* no change, no edge */
    TEST_ASSERT_EQUAL_UINT32(1, u.edges);
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_move(&u, 8, -3));
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_move(&u, 8, 2)); /* taken back within the sample */
    TEST_ASSERT_EQUAL_UINT32(1, u.edges);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 2.0, (double)excitation_level(&u));
    for (uint32_t i = 1; i < EXCITATION_EDGES_MAX; i++)
        TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_move(&u, 8 + i, (i & 1) ? -3 : 2));
    TEST_ASSERT_EQUAL_INT(ERR_FULL, excitation_move(&u, 100, 9));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 3.0, (double)excitation_peak(&u));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, excitation_double_step(&u, 0, 0, 5, 1));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, excitation_double_step(&u, 0, 5, 5, 0));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, excitation_double_step(&u, UINT32_MAX - 5, 5, 5, 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_sums_are_those_of_their_definition);
    RUN_TEST(every_first_order_element_of_the_plants_comes_back);
    RUN_TEST(lags_of_a_few_samples_and_fractions_of_dead_time_come_back);
    RUN_TEST(a_double_step_that_was_cut_gives_the_same_element);
    RUN_TEST(offset_and_drift_are_removed);
    RUN_TEST(a_line_through_two_means_is_the_drift_with_its_deviation);
    RUN_TEST(a_guess_of_residence_time_chooses_the_alpha);
    RUN_TEST(an_output_that_follows_at_once_has_no_lag_and_no_dead_time);
    RUN_TEST(a_response_that_jumps_first_takes_its_fall_back_and_says_so);
    RUN_TEST(a_response_that_grows_gives_a_negative_time_constant_and_says_so);
    RUN_TEST(noise_alone_has_no_gain_and_no_times);
    RUN_TEST(the_standard_deviations_are_those_of_the_scatter);
    RUN_TEST(tens_of_thousands_of_samples_do_not_wear_the_sums_out);
    RUN_TEST(what_is_not_finite_is_refused_and_changes_nothing);
    RUN_TEST(a_bank_out_of_range_is_refused);
    RUN_TEST(without_samples_edges_or_strength_there_is_no_answer);
    RUN_TEST(rubbish_gives_an_error_or_finite_numbers);
    RUN_TEST(a_record_shorter_than_three_times_its_weight_says_so);
    RUN_TEST(edges_keep_their_order_and_their_number);
    return UNITY_END();
}
