/* identify/shape_fit.[ch], shape_search.[ch], shape_choice.[ch], shape_verdict.c, shape_tail.[ch], shape_curve.[ch].
 *
 * Contract (both scalar types)
 *   noise-free elements    every shape comes back: gain within 0.5 %, residence time within 1 % of dead time and lag, the whole step
 *                          response within 1 % of the gain; measured: see the message
 *   memory                 at most 2 KiB more than struct fopdt_fit; 72 bytes kept an element
 *   an output that is not  the gain is the slope at rest, but for terms of third order; a linear one has no such terms
 *   evaluations            at most SHAPE_FIT_UNITS_MAX, in pieces of any size with the same result
 *
 * How honest the deviations are is judged by tests/bench/shape_deviations.py on random elements.
 */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "identify/common.h"
#include "identify/shape_choice.h"
#include "identify/shape_curve.h"
#include "identify/shape_fit.h"
#include "identify/shape_search.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20261129u

_Static_assert(sizeof(struct shape_fit) <= sizeof(struct fopdt_fit) + 512u * sizeof(real_t),
               "memory of a fit");
_Static_assert(sizeof(struct shape_found) <= 72u || sizeof(real_t) > 4u, "memory of an element");

struct test_shape {
    double gain, dead, lag, square, zero;
};

static struct record record;
static struct fopdt_fit one_fit;
static struct shape_fit fit;

void setUp(void) {}
void tearDown(void) {}

static double shape_step(const struct test_shape *e, double k)
{
    double t = k - e->dead;
    if (!(t > 0.0))
        return 0.0;
    if (e->square <= 0.0)
        return e->gain * (1.0 - (1.0 - e->zero / e->lag) * exp(-t / e->lag));
    double complex root = csqrt(e->lag * e->lag - 4.0 * e->square);
    if (cabs(root) < 1e-4 * e->lag)
        root = 1e-4 * e->lag;
    double complex a = 0.5 * (e->lag + root), b = 0.5 * (e->lag - root);
    double complex rest = (a - e->zero) * cexp(-t / a) - (b - e->zero) * cexp(-t / b);
    return e->gain * (1.0 - creal(rest / (a - b)));
}

/* Slope of 1 in the end. */
static double ramp_step(const struct test_shape *e, double k)
{
    double t = k - e->dead;
    return t > 0.0 ? e->gain * (t + e->lag * expm1(-t / e->lag)) : 0.0;
}

struct test_levels {
    uint32_t before, half, after; /* samples; +amplitude, -amplitude for half each, 0 */
    double amplitude, noise, drift, h;
};

static void take(double (*step)(const struct test_shape *, double), const struct test_shape *e,
                 const struct test_levels *t, struct random_source *source)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, 1, (real_t)t->h));
    for (uint32_t k = 0; k < t->before + 2 * t->half + t->after; k++) {
        double at = (double)k - t->before, half = t->half, a = t->amplitude;
        double y = t->drift * k;
        if (e)
            y += a * (step(e, at) - 2.0 * step(e, at - half) + step(e, at - 2.0 * half));
        if (source)
            y += t->noise * normal(source);
        real_t value = (real_t)y;
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &value));
        if (k == t->before)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, (real_t)a));
        if (k == t->before + t->half)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, -(real_t)a));
        if (k == t->before + 2 * t->half)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, 0));
    }
}

static struct shape_found run_in_pieces(const struct fopdt_fit_options *options, uint32_t units)
{
    struct fopdt_fit_result one;
    struct shape_found found;
    TEST_ASSERT_EQUAL_INT(ERR_OK, fopdt_fit_begin(&one_fit, &record, 0, options));
    TEST_ASSERT_TRUE(fopdt_fit_run(&one_fit, FOPDT_FIT_UNITS_MAX));
    TEST_ASSERT_EQUAL_INT(ERR_OK, fopdt_fit_result(&one_fit, &one));
    TEST_ASSERT_EQUAL_INT(ERR_OK, shape_fit_begin(&fit, &record, 0, options, &one));
    TEST_ASSERT_EQUAL_INT(ERR_STATE, shape_fit_result(&fit, &found));
    for (uint32_t n = 0; !shape_fit_run(&fit, units); n++)
        TEST_ASSERT_TRUE(n <= SHAPE_FIT_UNITS_MAX / units);
    TEST_ASSERT_TRUE(fit.evaluations <= SHAPE_FIT_UNITS_MAX);
    TEST_ASSERT_EQUAL_INT(ERR_OK, shape_fit_result(&fit, &found));
    return found;
}

static struct shape_found run(const struct fopdt_fit_options *options)
{
    return run_in_pieces(options, SHAPE_FIT_UNITS_MAX);
}

static struct test_shape as_found(const struct shape_found *f, double h)
{
    return (struct test_shape){(double)f->shape.gain, (double)f->shape.dead_time_s / h,
                               (double)f->shape.lag_s / h, (double)f->shape.square_s2 / h / h,
                               (double)f->shape.zero_s / h};
}

/* Largest difference of two step responses over the gain. */
static double apart(const struct test_shape *a, const struct test_shape *b, double length)
{
    double worst = 0.0;
    for (int i = 0; i <= 200; i++)
        worst = fmax(worst,
                     fabs(shape_step(a, length * i / 200.0) - shape_step(b, length * i / 200.0)));
    return worst / fabs(a->gain);
}

static void every_shape_comes_back_without_noise(void)
{
    /* half: samples of a level */
    static const struct {
        struct test_shape e;
        uint32_t half;
        enum shape_kind kind;
    } cases[] = {
        {{1.3, 20, 60, 0, 0}, 330, SHAPE_ONE_LAG},
        {{-0.4, 0, 60, 0, 0}, 330, SHAPE_ONE_LAG},
        {{0.7, 90, 30, 0, 0}, 260, SHAPE_ONE_LAG},
        {{1, 12, 60 + 20, 60 * 20, 0}, 400, SHAPE_TWO_LAGS},
        {{-2, 30, 50 + 49, 50 * 49, 0}, 400, SHAPE_TWO_LAGS},
        {{0.5, 10, 100, 2500, 0}, 400, SHAPE_TWO_LAGS}, /* equal */
        {{1, 15, 2 * 0.1 * 30, 900, 0}, 1400, SHAPE_TWO_LAGS},
        {{1, 15, 2 * 0.15 * 30, 900, 0}, 900, SHAPE_TWO_LAGS},
        {{-1, 0, 2 * 0.3 * 40, 1600, 0}, 700, SHAPE_TWO_LAGS},
        {{1, 40, 2 * 0.7 * 40, 1600, 0}, 400, SHAPE_TWO_LAGS},
        {{1, 10, 60 + 30, 60 * 30, -50}, 500, SHAPE_TWO_WITH_ZERO}, /* the wrong way first */
        {{-1, 25, 40 + 35, 40 * 35, -80}, 500, SHAPE_TWO_WITH_ZERO},
        {{1, 10, 60 + 30, 60 * 30, 130}, 500, SHAPE_TWO_WITH_ZERO}, /* beyond its end */
        {{1, 10, 2 * 0.3 * 30, 900, 60}, 500, SHAPE_TWO_WITH_ZERO},
        {{1, 4, 10 + 50, 10 * 50, 0.5 * 60}, 300, SHAPE_TWO_WITH_ZERO}, /* fast and slow */
        {{-1, 4, 10 + 200, 10 * 200, 0.3 * 10 + 0.7 * 200}, 1200, SHAPE_TWO_WITH_ZERO},
        {{1, 8, 10 + 400, 10 * 400, 0.5 * 410}, 2400, SHAPE_TWO_WITH_ZERO},
    };
    double worst[3] = {0, 0, 0};
    uint32_t most = 0;
    for (unsigned k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        const struct test_shape *e = &cases[k].e;
        struct test_levels t = {5, cases[k].half, cases[k].half, 0.05, 0, 1e-6, 2.0};
        take(shape_step, e, &t, NULL);
        struct shape_found r = run(NULL);
        struct test_shape s = as_found(&r, t.h);
        char text[40];
        snprintf(text, sizeof text, "case %u", k);
        TEST_ASSERT_EQUAL_INT_MESSAGE(cases[k].kind, r.kind, text);
        double off[3] = {fabs(s.gain / e->gain - 1.0),
                         fabs(s.dead + s.lag - s.zero - e->dead - e->lag + e->zero) /
                             (e->dead + e->lag),
                         apart(e, &s, cases[k].half)};
        static const double most_off[3] = {0.005, 0.01, 0.01};
        for (int i = 0; i < 3; i++) {
            TEST_ASSERT_TRUE_MESSAGE(off[i] < most_off[i], text);
            worst[i] = fmax(worst[i], off[i]);
        }
        most = fit.evaluations > most ? fit.evaluations : most;
    }
    char text[140];
    snprintf(
        text, sizeof text,
        "worst: gain %.3f %%, residence time %.3f %%, response %.3f %%; at most %u evaluations",
        100 * worst[0], 100 * worst[1], 100 * worst[2], (unsigned)most);
    TEST_MESSAGE(text);
}

static void the_work_can_be_cut_into_pieces_of_any_size(void)
{
    struct random_source source = {SEED};
    const struct test_shape e = {1, 10, 60 + 30, 60 * 30, -50};
    const struct test_levels t = {5, 400, 400, 0.05, 0.002, 1e-6, 1.0};
    take(shape_step, &e, &t, &source);
    struct shape_found whole = run(NULL);
    static const uint32_t units[] = {1, 2, 7, 100};
    for (unsigned k = 0; k < 4; k++) {
        struct shape_found pieces = run_in_pieces(NULL, units[k]);
        TEST_ASSERT_EQUAL_INT(0, memcmp(&whole.shape, &pieces.shape, sizeof whole.shape));
        TEST_ASSERT_EQUAL_INT(0, memcmp(whole.sd, pieces.sd, sizeof whole.sd));
        TEST_ASSERT_EQUAL_INT(
            0, memcmp(whole.correlation, pieces.correlation, sizeof whole.correlation));
        TEST_ASSERT_EQUAL_INT(whole.kind, pieces.kind);
    }
}

static void an_integrator_with_a_lag_is_known_by_its_slope(void)
{
    struct random_source source = {SEED};
    const struct test_shape e = {0.004, 10, 25, 0, 0};
    const struct test_levels t = {5, 300, 300, 0.05, 0.0005, 1e-6, 2.0};
    take(ramp_step, &e, &t, &source);
    struct shape_found r = run(NULL);
    TEST_ASSERT_EQUAL_INT(SHAPE_INTEGRATING, r.kind);
    double long_lag = (double)(SHAPE_INTEGRATOR_TIMES * 900) * 2.0;
    double slope = (double)r.shape.gain / long_lag; /* per second */
    double sd = (double)r.sd[SHAPE_GAIN] / long_lag;
    TEST_ASSERT_DOUBLE_WITHIN(3.0 * sd, 0.004 / 2.0, slope);
    TEST_ASSERT_TRUE(sd < 0.01 * slope);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * long_lag, long_lag, (double)r.shape.lag_s);
    double fast_s = (double)(r.shape.square_s2 / r.shape.lag_s);
    TEST_ASSERT_DOUBLE_WITHIN(6.0, 50.0, fast_s);
    TEST_ASSERT_DOUBLE_WITHIN(6.0, 20.0, (double)r.shape.dead_time_s);
}

static void an_integrator_seen_for_less_than_four_lags_is_slow(void)
{
    struct random_source source = {SEED};
    const struct test_shape e = {0.004, 10, 120, 0, 0};
    const struct test_levels t = {5, 300, 300, 0.05, 0.0002, 1e-6, 2.0};
    take(ramp_step, &e, &t, &source);
    struct shape_found r = run(NULL);
    TEST_ASSERT_EQUAL_INT(SHAPE_SLOW, r.kind);
}

static void a_level_that_ends_early_shows_at_least_what_it_has_shown(void)
{
    struct random_source source = {SEED};
    for (int n = 0; n < 20; n++) {
        const struct test_shape e = {n % 2 ? 1.0 : -1.0, 20, 600, 0, 0};
        const struct test_levels t = {5, 260, 260, 0.05, 0.0005, 1e-6, 1.0};
        take(shape_step, &e, &t, &source);
        struct fopdt_fit_options o = {
            .baseline = {.noise_sd = (real_t)0.0005}, .free_offset = true, .free_slope = true};
        struct shape_found r = run(&o);
        TEST_ASSERT_EQUAL_INT(SHAPE_SLOW, r.kind);
        TEST_ASSERT_TRUE((double)r.shape.gain * e.gain > 0.25);
        TEST_ASSERT_TRUE((double)r.shape.gain * e.gain < 0.5);
        TEST_ASSERT_TRUE(r.shape.lag_s > 100 && r.shape.lag_s < 600);
        /* The beginning stays: gain over lag. */
        TEST_ASSERT_DOUBLE_WITHIN(0.15, 1.0, fabs((double)(r.shape.gain / r.shape.lag_s)) * 600.0);
    }
}

static void noise_alone_is_no_response_and_not_known_to_be_zero(void)
{
    struct random_source source = {SEED};
    int silent = 0, beyond = 0;
    for (int n = 0; n < 100; n++) {
        const struct test_levels t = {5, 300, 300, 0.05, 0.003, 1e-6, 1.0};
        take(NULL, NULL, &t, &source);
        struct shape_found r = run(NULL);
        silent += r.kind == SHAPE_NO_RESPONSE;
        TEST_ASSERT_TRUE(r.kind == SHAPE_NO_RESPONSE || r.kind == SHAPE_SLOW);
        TEST_ASSERT_TRUE(r.sd[SHAPE_GAIN] > 0);
        beyond += real_abs(r.shape.gain) > 2 * r.sd[SHAPE_GAIN];
    }
    TEST_ASSERT_TRUE(silent >= 98);
    TEST_ASSERT_TRUE(beyond <= 9);
}

static void a_record_without_any_change_is_unknown(void)
{
    const struct test_levels t = {5, 300, 300, 0.05, 0, 0, 1.0};
    take(NULL, NULL, &t, NULL);
    struct shape_found r = run(NULL);
    TEST_ASSERT_EQUAL_INT(SHAPE_UNKNOWN, r.kind);
    /* With noise that is known it is no response, within that noise. */
    struct fopdt_fit_options o = {
        .baseline = {.noise_sd = (real_t)0.003}, .free_offset = true, .free_slope = true};
    r = run(&o);
    TEST_ASSERT_EQUAL_INT(SHAPE_NO_RESPONSE, r.kind);
    TEST_ASSERT_TRUE(r.sd[SHAPE_GAIN] > 0);
}

static void a_place_whose_response_begins_after_the_record_explains_nothing(void)
{
    const struct test_levels t = {5, 300, 300, 0.05, 0, 0, 1.0};
    const struct test_shape e = {1, 20, 60, 0, 0};
    const struct shape_place place = {.dead = 2000, .time = 60, .ratio = (real_t)0.2};
    take(shape_step, &e, &t, NULL);
    run(NULL);
    for (int formula = 0; formula < SHAPE_FORMULAS; formula++) {
        real_t squares[2] = {0, 0}, linear[3] = {1, 1, 1};
        shape_search_squares(&fit, (enum shape_formula)formula, &place, squares, linear);
        TEST_ASSERT_TRUE(squares[0] == fit.total && squares[1] == fit.total);
        TEST_ASSERT_TRUE(linear[0] == 0 && linear[1] == 0 && linear[2] == 0);
    }
}

static double sawtooth(const struct test_shape *e, double k)
{
    (void)e;
    return k > 0.0 ? fmod(k, 60.0) / 60.0 + (fmod(k, 140.0) > 70.0 ? 1.0 : 0.0) : 0.0;
}

static void a_response_that_no_formula_has_is_unknown(void)
{
    const struct test_levels t = {5, 300, 300, 0.05, 0, 0, 1.0};
    const struct test_shape e = {1, 0, 1, 0, 0};
    struct random_source source = {SEED};
    take(sawtooth, &e, &t, &source);
    struct shape_found r = run(NULL);
    TEST_ASSERT_TRUE(r.kind == SHAPE_UNKNOWN || r.kind == SHAPE_SLOW);
}

static void deviations_include_the_choice(void)
{
    /* Two lags of which the second is hardly seen: one lag and two explain the record about as well. */
    struct random_source source = {SEED};
    int mixed = 0;
    for (int n = 0; n < 20; n++) {
        const struct test_shape e = {1, 20, 60 + 6, 60 * 6, 0};
        const struct test_levels t = {5, 300, 300, 0.05, 0.006, 0, 1.0};
        take(shape_step, &e, &t, &source);
        struct shape_found r = run(NULL);
        struct shape other;
        if (!(shape_found_other(&r, &other) > (real_t)0.15) || r.kind != SHAPE_ONE_LAG)
            continue;
        mixed++;
        /* More than the fit of one lag alone says. */
        TEST_ASSERT_TRUE(r.sd[SHAPE_DEAD] * r.sd[SHAPE_DEAD] >
                         fit.candidate[SHAPE_FORMULA_ONE].covariance[2]);
        TEST_ASSERT_TRUE(r.sd[SHAPE_SQUARE] > 0);
        TEST_ASSERT_TRUE(other.square_s2 > 0);
    }
    TEST_ASSERT_TRUE(mixed >= 3);
}

/* ---- outputs that are not linear ---- */

/* T y' + y = K u + a y^2 + b u^2, twenty steps a sample: gain and time depend on the output, and the gain on the input. */
static void take_curved(double a, double b, double noise, struct random_source *source)
{
    const uint32_t before = 5, half = 300, after = 400;
    double y = 0.0, u = 0.0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, 1, 1));
    for (uint32_t k = 0; k < before + 2 * half + after; k++) {
        for (int n = 0; n < 20; n++)
            y += 0.05 / 60.0 * (1.3 * u + a * y * y + b * u * u - y);
        real_t value = (real_t)(y + noise * normal(source));
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &value));
        real_t level = (real_t)(k == before ? 0.05 : k == before + half ? -0.05 : 0.0);
        if (k == before || k == before + half || k == before + 2 * half) {
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, level));
            u = (double)level;
        }
    }
}

static void the_gain_of_an_output_that_is_not_linear_is_the_slope_at_rest(void)
{
    /* Gains up and down differ by 10 to 20 % of the mean. */
    static const double second[][2] = {{0.6, 0}, {-0.6, 0}, {0, 2}, {0.6, 1.5}};
    struct random_source source = {SEED};
    for (unsigned n = 0; n < 4; n++) {
        take_curved(second[n][0], second[n][1], 2e-4, &source);
        struct shape_found r = run(NULL);
        double residence = (double)shape_residence_s(&r.shape);
        TEST_ASSERT_TRUE(shape_curve_is_on(&fit));
        TEST_ASSERT_TRUE(r.kind == SHAPE_ONE_LAG || r.kind == SHAPE_TWO_LAGS);
        /* But for terms of third order, 1 % at 20 %. */
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * 1.3, 1.3, (double)r.shape.gain);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * 60.0, 60.0, residence);
    }
}

static void a_linear_output_has_no_curve(void)
{
    struct random_source source = {SEED};
    int curves = 0;
    for (int i = 0; i < 60; i++) {
        const struct test_shape e = {1, 10, 60, i % 2 ? 0 : 700, i % 3 ? 0 : 20};
        const struct test_levels t = {5, 300, 300, 0.05, 0.001 * (1 + i % 5), 0, 1.0};
        take(shape_step, &e, &t, &source);
        (void)run(NULL);
        curves += shape_curve_is_on(&fit);
    }
    TEST_ASSERT_TRUE(curves <= 1);
}

static void a_step_one_way_says_nothing_of_a_curve(void)
{
    struct random_source source = {SEED};
    const struct test_shape e = {1, 10, 60, 0, 0};
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, 1, 1));
    for (uint32_t k = 0; k < 805; k++) {
        double y = 0.05 * (shape_step(&e, k - 5.0) - shape_step(&e, k - 405.0));
        real_t value = (real_t)(y + 4.0 * y * y + 1e-4 * normal(&source));
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &value));
        if (k == 5 || k == 405)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, (real_t)(k == 5 ? 0.05 : 0.0)));
    }
    (void)run(NULL);
    TEST_ASSERT_FALSE(shape_curve_is_on(&fit));
}

/* A tenth of the gain, 1.6 levels long: the formula with a zero fits it as well with a lag of half a level. */
static void deviations_include_a_slow_tail_that_the_record_does_not_exclude(void)
{
    struct random_source source = {SEED};
    const struct test_shape e = {1, 10, 860, 48000, 726};
    const struct test_levels t = {5, 500, 1000, 0.08, 0.001, 0, 1.0};
    int known = 0, far = 0;
    for (int i = 0; i < 20; i++) {
        take(shape_step, &e, &t, &source);
        const struct fopdt_fit_options rest = {.baseline = {.noise_sd = (real_t)0.001}};
        struct shape_found r = run(&rest);
        if (r.kind == SHAPE_SLOW || r.kind == SHAPE_PERHAPS_SLOW)
            continue;
        known++;
        far += fabs((double)(r.shape.gain - 1)) > 3.0 * (double)r.sd[SHAPE_GAIN];
    }
    TEST_ASSERT_TRUE(known >= 10);
    TEST_ASSERT_TRUE(far <= known / 5);
}

static void too_little_and_bad_numbers_are_refused(void)
{
    const struct test_shape e = {1, 10, 60, 0, 0};
    struct test_levels t = {5, 300, 300, 0.05, 0, 0, 1.0};
    struct fopdt_fit_result one = {.element = {.time_constant_s = 60, .dead_time_s = 10}};
    struct fopdt_fit_options o = {.free_offset = true, .free_slope = true};
    struct shape_found found;
    take(shape_step, &e, &t, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_OK, shape_fit_begin(&fit, &record, 0, &o, &one));
    TEST_ASSERT_EQUAL_INT(ERR_STATE, shape_fit_result(&fit, &found));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, shape_fit_begin(&fit, &record, 1, &o, &one));
    o.bent = true;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, shape_fit_begin(&fit, &record, 0, &o, &one));
    o.bent = false;
    o.time_max_s = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, shape_fit_begin(&fit, &record, 0, &o, &one));
    o.time_max_s = -1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, shape_fit_begin(&fit, &record, 0, &o, &one));
    o.time_max_s = 0;
    o.baseline.slope_sd_per_s = -1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, shape_fit_begin(&fit, &record, 0, &o, &one));
    o.baseline.slope_sd_per_s = 0;
    one.element.dead_time_s = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, shape_fit_begin(&fit, &record, 0, &o, &one));
    one.element.dead_time_s = 0;
    one.element.time_constant_s = -1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, shape_fit_begin(&fit, &record, 0, &o, &one));
    one.element.time_constant_s = 60;
    record.y[0][40] = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, shape_fit_begin(&fit, &record, 0, &o, &one));
    record.y[0][40] = (real_t)2e12;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, shape_fit_begin(&fit, &record, 0, &o, &one));
    t = (struct test_levels){5, 4, 2, 0.05, 0, 0, 1.0}; /* 15 points */
    take(shape_step, &e, &t, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, shape_fit_begin(&fit, &record, 0, &o, &one));
    t = (struct test_levels){40, 300, 300, 1e-7, 0, 0, 1.0}; /* an input of nearly nothing */
    take(shape_step, &e, &t, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, shape_fit_begin(&fit, &record, 0, &o, &one));
    excitation_clear(&record.input);
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, shape_fit_begin(&fit, &record, 0, &o, &one));
}

static void rubbish_of_any_size_ends_and_gives_finite_numbers(void)
{
    struct random_source source = {SEED};
    for (int i = 0; i < 200; i++) {
        struct test_levels t = {random_below(&source, 30),
                                4 + random_below(&source, 300),
                                10 + random_below(&source, 300),
                                0,
                                1,
                                0,
                                1};
        t.amplitude = spread_over(&source, 1e-5, 1e5);
        take(NULL, NULL, &t, &source);
        real_t scale = (real_t)spread_over(&source, 1e-9, 1e6);
        for (uint32_t k = 0; k < record.points; k++)
            record.y[0][k] *= scale;
        struct shape_found r = run(NULL);
        real_t covariance[25];
        shape_found_covariance(&r, covariance);
        const real_t all[] = {r.shape.gain,      r.shape.dead_time_s, r.shape.lag_s,
                              r.shape.square_s2, r.shape.zero_s,      r.sd[SHAPE_GAIN],
                              r.sd[SHAPE_DEAD]};
        for (unsigned k = 0; k < sizeof all / sizeof all[0]; k++)
            TEST_ASSERT_TRUE(real_is_finite(all[k]));
        for (uint32_t n = 0; n < 5; n++) {
            struct shape member;
            shape_found_draw(&r, 1, n, &member);
            TEST_ASSERT_TRUE(member.dead_time_s >= 0 && member.lag_s >= 0 && member.square_s2 >= 0);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_shape_comes_back_without_noise);
    RUN_TEST(the_work_can_be_cut_into_pieces_of_any_size);
    RUN_TEST(an_integrator_with_a_lag_is_known_by_its_slope);
    RUN_TEST(an_integrator_seen_for_less_than_four_lags_is_slow);
    RUN_TEST(a_level_that_ends_early_shows_at_least_what_it_has_shown);
    RUN_TEST(noise_alone_is_no_response_and_not_known_to_be_zero);
    RUN_TEST(a_record_without_any_change_is_unknown);
    RUN_TEST(a_place_whose_response_begins_after_the_record_explains_nothing);
    RUN_TEST(a_response_that_no_formula_has_is_unknown);
    RUN_TEST(deviations_include_the_choice);
    RUN_TEST(the_gain_of_an_output_that_is_not_linear_is_the_slope_at_rest);
    RUN_TEST(a_linear_output_has_no_curve);
    RUN_TEST(a_step_one_way_says_nothing_of_a_curve);
    RUN_TEST(deviations_include_a_slow_tail_that_the_record_does_not_exclude);
    RUN_TEST(too_little_and_bad_numbers_are_refused);
    RUN_TEST(rubbish_of_any_size_ends_and_gives_finite_numbers);
    return UNITY_END();
}
