/* identify/fit_bend.[ch], and what fopdt_fit makes of it: a drift that turns once under a response.
 *
 * Contract (both scalar types)
 *   a bend taken out         1e-5 of its height is left; slope and step explained within 1e-3
 *   squares left             within 1e-3 of those of normal equations solved here in double
 *   noise-free elements      1 % in K, 1 % of L + T in T and L, whenever the drift turns
 *   standard deviations      rms of (K - true)/said within 0.6 to 1.3, beyond three of them in at most 2 %
 *   evaluations              at most FOPDT_FIT_UNITS_MAX, in pieces of any size with the same result
 */
#include <string.h>

#include "identify/common.h"
#include "identify/fopdt_fit.h"
#include "step_records.h"
#include "unity.h"

#define SEED   20261121u
#define POINTS 100u

static struct record record;
static struct fopdt_fit fit;
static struct fit_bend bend;

void setUp(void) {}
void tearDown(void) {}

static struct fit_line free_line(void)
{
    struct fit_line l = {.points = POINTS, .offset = true, .slope = true};
    fit_line_prepare(&l);
    return l;
}

static void a_bend_is_taken_out_and_explained(void)
{
    struct fit_line l = free_line();
    for (uint32_t at = 1; at < POINTS; at += 7) {
        real_t y[FIT_LINE_SIZE] = {0}, part[2], change, step, offset, slope, line_offset,
               line_slope;
        for (uint32_t i = 0; i < POINTS; i++) {
            double since = (i + 0.5 - at) / POINTS;
            y[i] = (real_t)(0.3 - 0.8 * (i + 0.5) / POINTS + (since > 0 ? 1.7 * since + 0.2 : 0.0));
        }
        fit_bend_place(&bend, &l, at);
        TEST_ASSERT_TRUE(bend.on);
        fit_line_remove(&l, y, &line_offset, &line_slope);
        fit_bend_remove(&bend, &l, y, part);
        for (uint32_t i = 0; i < POINTS; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, (double)y[i]);
        fit_bend_explain(&bend, part, &change, &step, &offset, &slope);
        if (bend.used < 2 || at < 5 || at > POINTS - 5) /* so near to an end the two look alike */
            continue;
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, 1.7, (double)change);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.2, (double)step);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.3, (double)(line_offset + offset));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, -0.8, (double)(line_slope + slope));
    }
}

/* Least squares of y on the columns 1, t, the bend and the model: normal equations by elimination. */
static double squares_by_elimination(const double *y, const double *model, uint32_t at)
{
    double a[4][5] = {{0}}, yy = 0.0;
    for (uint32_t i = 0; i < POINTS; i++) {
        double since = (i + 0.5 - at) / POINTS;
        double row[5] = {1.0, (i + 0.5) / POINTS, since > 0 ? since : 0.0, model[i], y[i]};
        for (int r = 0; r < 4; r++)
            for (int c = 0; c < 5; c++)
                a[r][c] += row[r] * row[c];
        yy += y[i] * y[i];
    }
    double right[4] = {a[0][4], a[1][4], a[2][4], a[3][4]}, x[4];
    for (int p = 0; p < 4; p++)
        for (int r = p + 1; r < 4; r++) {
            double f = a[r][p] / a[p][p];
            for (int c = p; c < 5; c++)
                a[r][c] -= f * a[p][c];
        }
    for (int p = 3; p >= 0; p--) {
        x[p] = a[p][4];
        for (int c = p + 1; c < 4; c++)
            x[p] -= a[p][c] * x[c];
        x[p] /= a[p][p];
    }
    for (int p = 0; p < 4; p++)
        yy -= x[p] * right[p];
    return yy;
}

static void the_squares_that_are_left_are_those_of_least_squares(void)
{
    struct random_source source = {SEED};
    struct fit_line l = free_line();
    struct test_element e = {1.0, 8.0, 3.0};
    for (uint32_t at = 3; at < POINTS - 3; at += 4) {
        double y[POINTS], model[POINTS];
        real_t column[2][FIT_LINE_SIZE] = {{0}}, scratch[FIT_LINE_SIZE];
        for (uint32_t i = 0; i < POINTS; i++) {
            model[i] = double_step_response(&e, 30, 30, i - 5.0);
            y[i] = 0.05 * model[i] + 0.02 * normal(&source) + (i > 50 ? 0.003 * (i - 50.0) : 0.0);
            column[0][i] = (real_t)y[i];
            column[1][i] = (real_t)model[i];
        }
        fit_line_remove(&l, column[0], NULL, NULL);
        fit_line_remove(&l, column[1], NULL, NULL);
        double truth = squares_by_elimination(y, model, at);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * truth, truth,
                                  (double)fit_bend_squares(&l, at, column[0], column[1], scratch));
    }
}

/* Double step of 0.05 from sample 0, half samples each way, under a drift that turns. */
struct bent_record {
    struct test_element element;
    uint32_t half, samples;
    double noise, slope, change, turns; /* per sample; sample of the turn */
};

static void take(const struct bent_record *t, struct random_source *source)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, 1, 1));
    for (uint32_t k = 0; k < t->samples; k++) {
        double y = 0.05 * double_step_response(&t->element, t->half, t->half, k) + t->slope * k;
        if (k > t->turns)
            y += t->change * (k - t->turns);
        real_t value = (real_t)(y + (t->noise > 0.0 ? t->noise * normal(source) : 0.0));
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &value));
        if (k == 0)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, REAL_C(0.05)));
        if (k == t->half)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, REAL_C(-0.05)));
        if (k == 2 * t->half)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, 0));
    }
}

/* Knowledge before the step: level and slope, with their errors. */
static struct fopdt_fit_options known(const struct bent_record *t, double offset_sd,
                                      double slope_sd)
{
    return (struct fopdt_fit_options){.bent = true,
                                      .baseline = {.slope_per_s = (real_t)t->slope,
                                                   .offset_sd = (real_t)offset_sd,
                                                   .slope_sd_per_s = (real_t)slope_sd,
                                                   .noise_sd = (real_t)t->noise}};
}

static struct fopdt_fit_result run(const struct fopdt_fit_options *options, uint32_t units)
{
    struct fopdt_fit_result r;
    TEST_ASSERT_EQUAL_INT(ERR_OK, fopdt_fit_begin(&fit, &record, 0, options));
    for (uint32_t n = 0; !fopdt_fit_run(&fit, units); n++)
        TEST_ASSERT_TRUE(n <= FOPDT_FIT_UNITS_MAX / units);
    TEST_ASSERT_EQUAL_INT(ERR_OK, fopdt_fit_result(&fit, &r));
    TEST_ASSERT_TRUE(r.evaluations <= FOPDT_FIT_UNITS_MAX);
    return r;
}

static struct bent_record any(struct random_source *source)
{
    struct bent_record t = {.element = {1.0, 50.0, 0.0}, .half = 260, .samples = 900};
    t.element.dead = uniform(source, 0.0, 40.0);
    t.slope = uniform(source, -1.0, 1.0) > 0 ? 1e-4 : -1e-4;
    t.change = -2.0 * t.slope;
    t.turns = uniform(source, 30.0, 860.0);
    return t;
}

static void an_element_comes_back_from_under_a_drift_that_turns(void)
{
    struct random_source source = {SEED};
    double worst[3] = {0};
    for (int i = 0; i < 60; i++) {
        struct bent_record t = any(&source);
        take(&t, NULL);
        struct fopdt_fit_options o = known(&t, 1e-4, 1e-6);
        struct fopdt_fit_result r = run(&o, FOPDT_FIT_UNITS_MAX);
        double time = t.element.lag + t.element.dead;
        const double off[3] = {fabs((double)r.element.gain - 1.0),
                               fabs((double)r.element.time_constant_s - t.element.lag) / time,
                               fabs((double)r.element.dead_time_s - t.element.dead) / time};
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_TRUE(off[k] < 0.01);
            worst[k] = off[k] > worst[k] ? off[k] : worst[k];
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * fabs(t.slope), t.slope, (double)r.slope_per_s);
        if (t.turns < 800.0) /* of what comes after little is seen */
            TEST_ASSERT_DOUBLE_WITHIN(0.1 * fabs(t.change), t.change, (double)r.bend_per_s);
        TEST_ASSERT_DOUBLE_WITHIN(2.5 * record.block, t.turns, (double)r.bend_at_s);
    }
    char text[120];
    snprintf(text, sizeof text, "worst of 60: K %.2f %%, T %.2f %%, L %.2f %% of L + T",
             100 * worst[0], 100 * worst[1], 100 * worst[2]);
    TEST_MESSAGE(text);
}

static void the_standard_deviation_knows_what_the_bend_hides(void)
{
    struct random_source source = {SEED};
    double square = 0.0, plain = 0.0;
    int far = 0;
    const int runs = 300;
    for (int i = 0; i < runs; i++) {
        struct bent_record t = any(&source);
        t.noise = 0.003;
        take(&t, &source);
        struct fopdt_fit_options o = known(&t, 6e-4, 1e-5);
        o.baseline.offset += (real_t)(6e-4 * normal(&source));
        o.baseline.slope_per_s += (real_t)(1e-5 * normal(&source));
        struct fopdt_fit_result r = run(&o, FOPDT_FIT_UNITS_MAX);
        double z = ((double)r.element.gain - 1.0) / (double)r.element.gain_sd;
        square += z * z;
        far += fabs(z) > 3.0;
        o.bent = false;
        r = run(&o, FOPDT_FIT_UNITS_MAX);
        plain += fabs((double)r.element.gain - 1.0) > 0.1;
    }
    char text[120];
    snprintf(text, sizeof text,
             "rms error %.2f deviations, %d of %d beyond three; no bend: %.0f wrong by a tenth",
             sqrt(square / runs), far, runs, plain);
    TEST_MESSAGE(text);
    TEST_ASSERT_TRUE(sqrt(square / runs) > 0.6 && sqrt(square / runs) < 1.3);
    TEST_ASSERT_LESS_OR_EQUAL_INT(runs / 50, far);
}

static void a_drift_that_does_not_turn_is_none_the_worse(void)
{
    struct random_source source = {SEED};
    for (int i = 0; i < 50; i++) {
        struct bent_record t = any(&source);
        t.noise = 0.002;
        t.change = 0.0;
        take(&t, &source);
        struct fopdt_fit_options o = known(&t, 4e-4, 1e-5);
        struct fopdt_fit_result r = run(&o, FOPDT_FIT_UNITS_MAX);
        TEST_ASSERT_DOUBLE_WITHIN(4.0 * (double)r.element.gain_sd, 1.0, (double)r.element.gain);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 1.0, (double)r.element.gain);
    }
}

static void the_work_can_be_cut_into_pieces_of_any_size(void)
{
    struct random_source source = {SEED};
    struct bent_record t = any(&source);
    t.noise = 0.003;
    take(&t, &source);
    struct fopdt_fit_options o = known(&t, 6e-4, 1e-5);
    struct fopdt_fit_result whole = run(&o, FOPDT_FIT_UNITS_MAX);
    for (uint32_t units = 1; units < 60; units += 13) {
        struct fopdt_fit_result pieces = run(&o, units);
        TEST_ASSERT_EQUAL_MEMORY(&whole, &pieces, sizeof whole);
    }
}

static void rubbish_ends_and_gives_finite_numbers(void)
{
    struct random_source source = {SEED};
    struct fopdt_fit_options o = {.bent = true, .free_offset = true, .free_slope = true};
    for (int i = 0; i < 200; i++) {
        double size = spread_over(&source, 1e-12, 1e10);
        uint32_t samples = 14 + random_below(&source, 400);
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, 1, 1));
        for (uint32_t k = 0; k < samples; k++) {
            real_t y = i % 7 ? (real_t)(size * normal(&source)) : (real_t)size;
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &y));
            if (k == 1 || k == samples / 3 || k == samples / 2)
                TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, k == 1 ? 1 : (real_t)(k % 2)));
        }
        struct fopdt_fit_result r = run(&o, 50);
        TEST_ASSERT_TRUE(real_is_finite(r.element.gain) && real_is_finite(r.element.gain_sd));
        TEST_ASSERT_TRUE(real_is_finite(r.bend_per_s) && real_is_finite(r.bend_step));
        TEST_ASSERT_TRUE(real_is_finite(r.offset) && real_is_finite(r.slope_per_s));
        TEST_ASSERT_TRUE(real_is_finite(r.misfit) && real_is_finite(r.plateau_gain));
    }
}

int main(void)
{
    UNITY_BEGIN();
    printf("seed %u\n", SEED);
    RUN_TEST(a_bend_is_taken_out_and_explained);
    RUN_TEST(the_squares_that_are_left_are_those_of_least_squares);
    RUN_TEST(an_element_comes_back_from_under_a_drift_that_turns);
    RUN_TEST(the_standard_deviation_knows_what_the_bend_hides);
    RUN_TEST(a_drift_that_does_not_turn_is_none_the_worse);
    RUN_TEST(the_work_can_be_cut_into_pieces_of_any_size);
    RUN_TEST(rubbish_ends_and_gives_finite_numbers);
    return UNITY_END();
}
