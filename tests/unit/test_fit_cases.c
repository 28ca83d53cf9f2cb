/* Guards the promise of docs/inside/proofs.md that tests notice nine in ten faults drawn from the code. Answers are compared with references
 * within bounds, and a changed threshold, weight or fall-back mostly stays within them. Here it moves a line.
 *
 * The lines are results of fits of many small records, five digits each. In a family of records one number grows from case to case through
 * the place where the answer or a flag changes. test_fopdt_fit.c and test_fit_bend.c check how right the answers are.
 *
 * Kept in reference/fit_cases.txt, which support/kept_transcript.h says how to write anew. */
#include <math.h>
#include <string.h>

#include "identify/fopdt_fit.h"
#include "identify/guard.h"
#include "kept_transcript.h"
#include "step_records.h"
#include "unity.h"

#define SEED  20261122u
#define EDGES 3

/* A record; times in samples of 2 s. */
struct shape {
    struct test_element part[2]; /* summed up */
    double swing, swing_period, swing_lasts;
    double noise, hangs; /* deviation of a sample, how much of it the next one keeps */
    double drift, bend, hop;
    double spike; /* at sample 100 */
    double scale; /* of all levels of the input */
    double bend_at, samples, edge[EDGES], level[EDGES];
    struct fopdt_fit_options options;
    double start_lag, start_dead; /* below 0: none */
    double known;                 /* noise that is said beforehand */
};

static struct record record;
static struct fopdt_fit fit;
static struct shape shape;

void setUp(void) {}
void tearDown(void) {}

/* A double step of 0.05 from rest to rest that an element of 30 samples follows. */
static void plain(void)
{
    shape = (struct shape){.part = {{1.0, 30.0, 8.0}, {0.0, 1.0, 0.0}},
                           .swing_period = 40.0,
                           .swing_lasts = 80.0,
                           .noise = 1e-4,
                           .scale = 0.05,
                           .samples = 600,
                           .edge = {60, 240, 420},
                           .level = {1, -1, 0},
                           .start_lag = -1.0,
                           .options = {.free_offset = true, .free_slope = true}};
}

/* One step. */
static void single(void)
{
    plain();
    shape.edge[1] = shape.edge[2] = -1.0;
    shape.options.free_slope = false;
}

static double response(double k)
{
    double y = 0.0, before = 0.0;
    for (unsigned i = 0; i < EDGES && shape.edge[i] >= 0.0; i++) {
        double since = k - shape.edge[i], change = shape.scale * (shape.level[i] - before);
        before = shape.level[i];
        for (unsigned n = 0; n < 2; n++)
            y += change * step_response(&shape.part[n], since);
        if (since > 0.0)
            y += change * shape.swing * exp(-since / shape.swing_lasts) *
                 sin(6.283185307179586 * since / shape.swing_period);
    }
    return y;
}

static void take(void)
{
    struct random_source random = {SEED};
    double hanging = 0.0;
    real_t reference = REAL_C(0.4);
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, 1, 2));
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_begin(&record, &reference));
    for (unsigned k = 0; k < (unsigned)shape.samples; k++) {
        double y = 0.4 + response(k) + shape.drift * k;
        if (k > shape.bend_at)
            y += shape.bend * (k - shape.bend_at) + shape.hop;
        hanging = shape.hangs * hanging + shape.noise * normal(&random);
        y += hanging + (k == 100 ? shape.spike : 0.0);
        real_t sample = (real_t)y;
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &sample));
        for (unsigned i = 0; i < EDGES; i++)
            if (shape.edge[i] >= 0.0 && k == (unsigned)shape.edge[i])
                TEST_ASSERT_EQUAL_INT(ERR_OK,
                                      record_move(&record, (real_t)(shape.scale * shape.level[i])));
    }
}

static void says(double value)
{
    struct identified start = {.time_constant_s = (real_t)(2.0 * shape.start_lag),
                               .dead_time_s = (real_t)(2.0 * shape.start_dead)};
    struct fopdt_fit_options o = shape.options;
    struct fopdt_fit_result r;
    if (shape.start_lag >= 0.0)
        o.start = &start;
    o.baseline.noise_sd = (real_t)shape.known;
    take();
    enum err err = fopdt_fit_begin(&fit, &record, 0, &o);
    if (err) {
        kept_line("%.4g error %d", value, err);
        return;
    }
    while (!fopdt_fit_run(&fit, 40))
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, fopdt_fit_result(&fit, &r));
    const struct identified *e = &r.element;
    kept_line(
        "%.4g: %.5g %.3g %.5g %.3g %.5g %.3g %x %.4g %.3g %.3g %.4g %.5g %.3g %.4g %.4g %.4g %u",
        value, (double)e->gain, (double)e->gain_sd, (double)e->time_constant_s,
        (double)e->time_constant_sd_s, (double)e->dead_time_s, (double)e->dead_time_sd_s, e->flags,
        (double)r.residual_sd, (double)r.misfit, (double)r.correlation, (double)r.significance,
        (double)r.plateau_gain, (double)r.plateau_gain_sd, (double)r.moved, (double)r.offset,
        (double)r.slope_per_s, (unsigned)r.evaluations);
    if (e->flags & IDENTIFIED_NO_GAIN)
        TEST_ASSERT_TRUE(r.covariance[0] == e->gain_sd * e->gain_sd);
    if (shape.options.bent)
        kept_line("bend at %.5g by %.4g and %.4g covariance %.4g %.4g %.4g", (double)r.bend_at_s,
                  (double)r.bend_per_s, (double)r.bend_step, (double)r.covariance[1],
                  (double)r.covariance[3], (double)r.covariance[4]);
}

/* The records with this number at so many values, each `times` the one before. */
static void grows(const char *what, double *number, double from, double times, unsigned n)
{
    kept_line("# %s", what);
    for (double x = from; n > 0; n--, x *= times) {
        *number = x;
        says(x);
    }
}

static void adds(const char *what, double *number, double from, double more, unsigned n)
{
    kept_line("# %s", what);
    for (unsigned i = 0; i < n; i++) {
        *number = from + more * i;
        says(*number);
    }
}

/* ---- the wrong way first ---- */

static void dips(void)
{
    plain();
    shape.part[0] = (struct test_element){1.1, 30, 8};
    shape.part[1] = (struct test_element){0, 4, 0};
    shape.noise = 1e-6;
    grows("dips", &shape.part[1].gain, -0.01, 1.4, 9);
    shape.scale = -0.05;
    shape.part[1].gain = -0.1;
    grows("a dip in noise", &shape.noise, 1e-4, 1.5, 9);
    single();
    shape.part[0] = (struct test_element){-1.0, 4000, 8};
    shape.part[1] = (struct test_element){0, 3, 0};
    shape.samples = 200;
    shape.noise = 1e-6;
    shape.options.time_max_s = REAL_C(1e5);
    grows("dips before little of a response", &shape.part[1].gain, 5e-4, 1.5, 9);
    plain();
    shape.edge[1] = 75;
    shape.edge[2] = 95;
    grows("slow after a short step", &shape.part[0].lag, 5, 2, 7);
    shape.edge[2] = -1;
    grows("slow after a short step, two levels", &shape.part[0].lag, 20, 4, 3);
    plain();
    shape.part[0].lag = 60;
    shape.part[1] = (struct test_element){-0.05, 5, 0};
    shape.edge[1] = 110;
    shape.edge[2] = 170;
    shape.noise = 1e-5;
    grows("dips after a short step", &shape.part[1].gain, -0.05, 1.5, 6);
    plain();
    shape.part[1] = (struct test_element){-0.3, 2, 0};
    adds("a dip that is late", &shape.part[1].dead, 0, 8, 9);
}

/* ---- turns ---- */

static void swings(void)
{
    single();
    shape.noise = 1e-5;
    shape.swing_period = 110;
    shape.swing_lasts = 250;
    grows("swings", &shape.swing, 0.03, 1.3, 11);
    shape.swing = 0.4;
    grows("a swing in noise", &shape.noise, 1e-4, 1.5, 12);
    shape.noise = 1e-5;
    shape.swing = 0.2;
    grows("swings of other periods", &shape.swing_period, 9, 1.6, 8);
    plain();
    shape.part[0].gain = -1.0;
    shape.swing = 0.4;
    shape.swing_period = 90;
    grows("swings that die away", &shape.swing_lasts, 5, 2, 7);
}

/* ---- the end of the record ---- */

static void ends(void)
{
    single();
    shape.noise = 1e-5;
    adds("one step, record cut", &shape.samples, 100, 20, 14);
    shape.samples = 400;
    shape.part[1].lag = 500;
    grows("a slow tail", &shape.part[1].gain, 0.01, 2, 5);
    shape.part[1].gain = 0.3;
    grows("a slow tail in noise", &shape.noise, 3e-5, 3, 4);
    single();
    shape.samples = 512;
    shape.bend_at = 448;
    grows("a ramp at the end", &shape.bend, 3.3e-5, 1.04, 12);
    shape.bend = 1e-4;
    grows("a ramp that begins earlier", &shape.bend_at, 400, 1.03, 5);
    plain();
    adds("a double step, record cut", &shape.samples, 250, 30, 10);
}

/* ---- what noise hides ---- */

static void lost(void)
{
    plain();
    shape.noise = 3e-3;
    grows("gains in noise", &shape.part[0].gain, 0.005, 1.3, 14);
    shape.part[0].gain = 0.0;
    shape.known = 3e-3;
    grows("no gain, of noise that is known", &shape.noise, 1e-4, 4, 5);
    shape.options.free_slope = false;
    shape.part[0].gain = -0.03;
    grows("a gain in noise and a level at rest", &shape.noise, 5e-4, 1.4, 8);
    plain();
    shape.known = shape.noise = 3e-3;
    shape.options = (struct fopdt_fit_options){
        .baseline = {.offset_sd = REAL_C(3e-4), .slope_sd_per_s = REAL_C(1e-6)}};
    grows("gains in noise, level and drift known", &shape.part[0].gain, 0.01, 1.5, 4);
    plain();
    adds("noise that hangs together", &shape.hangs, 0.3, 0.06, 12);
    plain();
    shape.part[1] = (struct test_element){0.5, 8, 0};
    grows("not of first order, noise as known", &shape.known, 1e-5, 1.5, 14);
    shape.known = 0.0;
    grows("not of first order, by its noise", &shape.noise, 1e-5, 1.6, 12);
    plain();
    grows("one wild sample", &shape.spike, 0.01, 10, 6);
}

/* ---- slow, and as fast as nothing ---- */

static void times(void)
{
    plain();
    shape.noise = 1e-5;
    grows("lags", &shape.part[0].lag, 0.05, 2, 18);
    shape.part[0].gain = 10;
    shape.noise = 8e-3;
    grows("slow lags in noise", &shape.part[0].lag, 60, 1.5, 11);
    single();
    shape.part[0].gain = 20;
    shape.noise = 1e-4;
    grows("slow lags, one step", &shape.part[0].lag, 60, 1.7, 10);
    shape.part[0].lag = 300;
    shape.options.time_max_s = REAL_C(200.0);
    grows("more than may be, a level at rest", &shape.part[0].lag, 50, 1.25, 8);
    single();
    shape.part[0].lag = 10;
    shape.options.time_max_s = REAL_C(648.0);
    adds("a dead time of more than may be", &shape.part[0].dead, 290, 30, 4);
    plain();
    shape.options.time_max_s = REAL_C(1.5);
    shape.part[0].dead = 0;
    grows("nothing may be", &shape.part[0].lag, 0.1, 2, 5);
    plain();
    adds("dead times", &shape.part[0].dead, 0, 0.37, 8);
    grows("long dead times", &shape.part[0].dead, 30, 1.5, 8);
    plain();
    shape.noise = 1e-6;
    shape.part[0].lag = 0.0;
    adds("dead times alone", &shape.part[0].dead, 0, 0.7, 4);
    shape.part[0].lag = 0.4;
    adds("dead times and hardly a lag", &shape.part[0].dead, 0, 0.29, 8);
    single();
    shape.samples = 120;
    shape.noise = 1e-6;
    shape.part[0].lag = 0.0;
    adds("dead times alone, every sample", &shape.part[0].dead, 0, 0.7, 4);
    shape.part[0].dead = 0.4;
    grows("nothing but a short lag, every sample", &shape.part[0].lag, 0.01, 1.5, 10);
    shape.part[0].lag = 0.15;
    adds("hardly a lag, every sample", &shape.part[0].dead, 0.05, 0.17, 12);
    plain();
    shape.noise = 1e-6;
    shape.samples = 2600;
    shape.part[0].lag = 0.4;
    adds("dead times alone, in blocks", &shape.part[0].dead, 0, 1.3, 8);
}

/* ---- the flat ends of the levels ---- */

static void levels(void)
{
    plain();
    adds("levels reached or not", &shape.part[0].lag, 22, 2, 14);
    plain();
    shape.edge[2] = 560;
    adds("a last level reached or not", &shape.samples, 562, 12, 8);
    plain();
    shape.edge[0] = 3;
    shape.level[2] = 1.0;
    adds("levels that are nearly the same", &shape.level[1], 0.5, 0.05, 10);
    plain();
    shape.edge[1] = 240;
    shape.edge[2] = -1;
    adds("two steps, the second late", &shape.edge[1], 240, 45, 8);
}

/* ---- what is known beforehand ---- */

static void known(void)
{
    static const double sds[] = {0.0, 1e-9, 1e-5, 1e-3};
    plain();
    shape.drift = 2e-6;
    shape.known = 1e-3;
    shape.options = (struct fopdt_fit_options){.free_slope = false};
    shape.options.baseline = (struct baseline){.offset = REAL_C(2e-4), .slope_per_s = REAL_C(1e-6)};
    for (unsigned i = 0; i < 4; i++) {
        kept_line("# level known to %g", sds[i]);
        shape.options.baseline.offset_sd = (real_t)sds[i];
        for (unsigned j = 0; j < 4; j++) {
            shape.options.baseline.slope_sd_per_s = (real_t)(sds[j] / 600.0);
            says(sds[j]);
        }
    }
    plain();
    shape.drift = 2e-6;
    shape.options.free_offset = false;
    grows("drift free, level known", &shape.known, 1e-6, 10, 4);
    plain();
    shape.options.free_offset = shape.options.free_slope = false;
    shape.options.baseline.offset_sd = REAL_C(1e-12);
    shape.known = 1e-3;
    kept_line("# a level and a drift that are not those known");
    for (unsigned i = 0; i < 4; i++) {
        static const double levels[] = {1e-12, 2.4e-8, 5e-8, 1e-6},
                            slopes[] = {1e-15, 2e-11, 4e-11, 1e-9};
        shape.options.baseline.offset_sd = (real_t)levels[i];
        shape.hop = 3;
        says(levels[i]);
        shape.options.baseline.slope_sd_per_s = (real_t)slopes[i];
        shape.hop = 0;
        shape.bend = 1e-2;
        says(slopes[i]);
        shape.options.baseline.slope_sd_per_s = REAL_C(0.0);
        shape.bend = 0;
    }
    plain();
    shape.options.baseline = (struct baseline){.offset = REAL_C(1e6), .slope_per_s = REAL_C(-1e6)};
    kept_line("# what is not looked at");
    says(1e6);
    shape.options.baseline = (struct baseline){.offset = REAL_C(0.0)};
    shape.part[0].gain = shape.noise = 0;
    says(0);
    says(0); /* nothing is left of the one before */
    plain();
    shape.start_dead = 8;
    grows("other places to begin from", &shape.start_lag, 0.3, 10, 5);
    shape.start_lag = 30;
    grows("other dead times to begin from", &shape.start_dead, 0.8, 10, 4);
}

/* ---- records of all lengths ---- */

static void lengths(void)
{
    single();
    shape.edge[0] = 3;
    shape.part[0] = (struct test_element){1, 3, 1};
    adds("few points", &shape.samples, 10, 1, 12);
    shape.samples = 40;
    adds("an edge at the end", &shape.edge[0], 35, 1, 5);
    shape.samples = 401; /* in blocks of two and four */
    adds("an edge at the end, in blocks", &shape.edge[0], 388, 1, 12);
    plain();
    for (unsigned i = 0; i < EDGES; i++)
        shape.edge[i] *= 7;
    grows("many samples", &shape.samples, 1700, 1.5, 6);
    plain();
    grows("inputs of all sizes", &shape.scale, 1e-7, 10, 8);
}

/* ---- a drift that turns ---- */

static void bends(void)
{
    plain();
    shape.options.bent = true;
    shape.drift = -2e-6;
    shape.bend = 2e-5;
    shape.samples = 200;
    shape.edge[0] = 20;
    shape.edge[1] = 80;
    shape.edge[2] = 140;
    shape.part[0].lag = 12;
    adds("a bend here and there", &shape.bend_at, 1, 33, 7);
    shape.bend = 0;
    shape.hop = 5e-3;
    adds("a hop at the beginning", &shape.bend_at, 1.5, 2, 2);
    adds("a hop at the end", &shape.bend_at, 195.5, 2, 2);
    shape.bend = 2e-5;
    shape.bend_at = 110;
    shape.hop = 2e-3;
    grows("a hop and a bend", &shape.noise, 1e-5, 2, 8);
    shape.noise = 1e-5;
    shape.bend = 1e-3;
    grows("a strong bend", &shape.part[0].lag, 1.5, 2, 6);
    shape.bend = 2e-5;
    shape.bend = 0;
    shape.hop = 0;
    shape.noise = 1e-4;
    grows("no bend", &shape.part[0].lag, 3, 4, 4);
    shape.bend = 1e-3;
    shape.samples = 36;
    shape.edge[0] = 5;
    shape.edge[1] = 15;
    shape.edge[2] = 25;
    shape.part[0] = (struct test_element){1, 3, 1};
    adds("a bend in a short record", &shape.bend_at, 3, 9, 4);
}

/* ---- the peak that a fit predicts ---- */

static void peaks(void)
{
    static const struct {
        double gain, lag, dead, slope, amplitude, after;
        unsigned flags;
    } cases[] = {{2, 40, 5, 0, 0.1, 20, 0},      {2, 40, 5, 1e-3, 0.1, 60, 0},
                 {-3, 25, 0, -1e-4, 0.2, 10, 0}, {1, 10, 5, 0, 0.1, 790, 0},
                 {1, 10, 5, 0, 0.1, 850, 0},     {1.5, 0, 5, 1e-3, -0.1, 30, 0},
                 {2, 40, 5, 1e-3, 0.1, 60, 1},   {2, 40, 5, 1e-3, 0.1, 0, 0}};
    kept_line("# peaks");
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        real_t peak, sd;
        struct fopdt_fit_result r = {.element = {.gain = (real_t)cases[i].gain,
                                                 .gain_sd = REAL_C(0.3),
                                                 .time_constant_s = (real_t)cases[i].lag,
                                                 .dead_time_s = (real_t)cases[i].dead,
                                                 .flags = (uint16_t)cases[i].flags},
                                     .covariance = {REAL_C(0.09), REAL_C(0.7), REAL_C(16.0),
                                                    REAL_C(0.02), REAL_C(0.3), REAL_C(0.5)},
                                     .slope_per_s = (real_t)cases[i].slope};
        TEST_ASSERT_EQUAL_INT(ERR_OK, guard_model_peak(&r, (real_t)cases[i].amplitude,
                                                       (real_t)cases[i].after, &peak, &sd));
        kept_line("%u: %.5g+-%.5g", i, (double)peak, (double)sd);
    }
}

static void what_fits_say_of_many_records_is_what_was_kept(void)
{
    kept_open(
        "reference/fit_cases.txt",
        "a threshold, a weight or a fall-back of the fit that changes by mistake moves a line");
    kept_line("what grows: gain sd T sd L sd flags, residual misfit correlation significance, "
              "plateau sd, moved, offset slope, evaluations");
    dips();
    swings();
    ends();
    lost();
    times();
    levels();
    known();
    lengths();
    bends();
    peaks();
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_fits_say_of_many_records_is_what_was_kept);
    return UNITY_END();
}
