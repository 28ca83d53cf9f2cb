/* Guards the promise of docs/inside/proofs.md that tests notice nine in ten faults drawn from the code. Answers are compared with references
 * within bounds, and a changed threshold, weight or fall-back mostly stays within them. Here it moves a line.
 *
 * The lines are results of moments, the test for rest, the line guard and the settling time for many small records, five digits each. In a
 * family one number grows from case to case through the place where the answer, a flag or a verdict changes. test_moments.c,
 * test_steady.c, test_guard.c and test_settling.c check how right the answers are.
 *
 * Kept in reference/identify_cases.txt, which support/kept_transcript.h says how to write anew. */
#include <math.h>
#include <string.h>

#include "identify/guard.h"
#include "identify/moments.h"
#include "identify/settling.h"
#include "identify/steady.h"
#include "kept_transcript.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20261122u

void setUp(void) {}
void tearDown(void) {}

/* ---- moments ---- */

static struct moments moments;
static struct excitation input;

/* A double step, or one step, of 0.1 at sample 0, samples 2 s apart. */
static struct {
    struct test_element part[2]; /* summed up */
    double noise, drift, grows;  /* of a part that grows, in samples of its time */
    double late;                 /* nothing until here, then this much */
    double late_by;
    uint32_t samples, t1, t2; /* t2 0: one step */
    bool fast_only, best_only;
    double guess_s;
    struct baseline known;
} m;

static void plain_moments(void)
{
    memset(&m, 0, sizeof m);
    m.part[0] = (struct test_element){1.0, 30.0, 8.0};
    m.part[1].lag = 1.0;
    m.samples = 900;
    m.t1 = m.t2 = 150;
}

static double response(uint32_t k)
{
    double y = m.drift * k;
    for (unsigned n = 0; n < 2; n++)
        y += 0.1 * (m.t2 > 0 ? double_step_response(&m.part[n], m.t1, m.t2, k)
                             : step_response(&m.part[n], k));
    if (m.grows > 0)
        y += 1e-3 * expm1(k / m.grows);
    if (m.late > 0)
        y = k >= m.late ? m.late_by : 0.0;
    return y;
}

static void says_moments(double value)
{
    struct moments_config c = {.outputs = 1,
                               .alphas = moments_alphas_for(REAL_C(2.0), REAL_C(1000.0)),
                               .h_s = REAL_C(2.0),
                               .fastest = (real_t)MOMENTS_FASTEST,
                               .ratio = (real_t)MOMENTS_RATIO};
    struct random_source random = {SEED};
    struct identified e;
    uint32_t chosen = 0;
    real_t reference = REAL_C(0.3), raw = REAL_C(0.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, moments_init(&moments, &c));
    TEST_ASSERT_EQUAL_INT(ERR_OK, moments_begin(&moments, &reference));
    for (uint32_t k = 0; k < m.samples; k++) {
        real_t y = (real_t)(0.3 + response(k) + m.noise * normal(&random));
        TEST_ASSERT_EQUAL_INT(ERR_OK, moments_step(&moments, &y));
    }
    excitation_clear(&input);
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_move(&input, 0, REAL_C(0.1)));
    if (m.t2 > 0) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_move(&input, m.t1, REAL_C(-0.1)));
        TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_move(&input, m.t1 + m.t2, REAL_C(0.0)));
    }
    for (uint32_t i = 0; i <= moments.alphas; i++) {
        bool best = i == moments.alphas;
        if (!best && (i % 3 != 2 || m.best_only))
            continue;
        if (i != 2 && m.fast_only)
            continue;
        enum err err =
            best ? moments_element(&moments, 0, &input, &m.known, (real_t)m.guess_s, &e, &chosen)
                 : moments_at(&moments, i, 0, &input, &m.known, &e, &raw);
        if (err)
            kept_line("%.4g %u error %d", value, (unsigned)(best ? chosen : i), err);
        else
            kept_line("%.4g %s%u %.5g %.3g %.5g %.3g %.5g %.3g %x raw %.5g", value,
                      best ? "best " : "", (unsigned)(best ? chosen : i), (double)e.gain,
                      (double)e.gain_sd, (double)e.time_constant_s, (double)e.time_constant_sd_s,
                      (double)e.dead_time_s, (double)e.dead_time_sd_s, e.flags,
                      best ? 0.0 : (double)raw);
    }
}

static void grows(const char *what, void (*says)(double), double *number, double from, double times,
                  unsigned n)
{
    kept_line("# %s", what);
    for (double x = from; n > 0; n--, x *= times) {
        *number = x;
        says(x);
    }
}

static void of_moments(void)
{
    kept_line("moments, by what grows: alpha, gain sd T sd L sd flags raw T");
    plain_moments();
    m.known = (struct baseline){
        .noise_sd = REAL_C(1e-3), .offset_sd = REAL_C(1e-4), .slope_sd_per_s = REAL_C(1e-7)};
    grows("lags", says_moments, &m.part[0].lag, 0.02, 6, 7);
    m.fast_only = true;
    grows("lags that are long there", says_moments, &m.part[0].lag, 100, 1.3, 8);
    m.fast_only = false;
    m.part[0].lag = 20;
    grows("dead times", says_moments, &m.part[0].dead, 0.3, 5, 5);
    m.part[0].lag = 0;
    grows("dead times alone", says_moments, &m.part[0].dead, 0.3, 1.6, 5);
    plain_moments();
    m.noise = 1e-3;
    m.known.noise_sd = REAL_C(1e-3);
    grows("gains in noise", says_moments, &m.part[0].gain, 0.01, 1.6, 6);
    plain_moments();
    m.part[0].lag = 10;
    m.best_only = true;
    m.known.noise_sd = REAL_C(1e-3);
    grows("small gains", says_moments, &m.part[0].gain, 0.003, 1.3, 10);
    m.known = (struct baseline){.offset_sd = REAL_C(1e-3)};
    grows("small gains, level not known", says_moments, &m.part[0].gain, 0.1, 1.4, 8);
    m.known = (struct baseline){.slope_sd_per_s = REAL_C(1e-5)};
    grows("small gains, drift not known", says_moments, &m.part[0].gain, 0.1, 1.4, 8);
    plain_moments();
    m.part[0] = (struct test_element){1, 40, 0};
    m.known.noise_sd = REAL_C(1e-3);
    grows("jumps first", says_moments, &m.part[1].gain, 0.05, 3, 5);
    m.best_only = true;
    grows("jumps a little", says_moments, &m.part[1].gain, 2e-4, 1.6, 9);
    m.best_only = false;
    m.fast_only = true;
    m.part[1].gain = 0.05;
    grows("jumps, then slow", says_moments, &m.part[0].lag, 40, 2, 8);
    plain_moments();
    m.part[0] = (struct test_element){1, 40, 2};
    m.part[1] = (struct test_element){0, 5, 0};
    grows("the wrong way first", says_moments, &m.part[1].gain, -0.05, 3, 4);
    plain_moments();
    m.t2 = 0;
    m.samples = 150;
    m.part[0].gain = 0.0;
    m.part[1] = (struct test_element){0.01, 10, 0};
    grows("grows", says_moments, &m.grows, 5, 1.7, 6);
    plain_moments();
    m.drift = 1e-5;
    m.known = (struct baseline){.offset = REAL_C(1e-3), .slope_per_s = REAL_C(5e-6)};
    kept_line("# short double steps");
    static const uint32_t lengths[] = {1, 2, 5, 8, 20, 32, 80, 128};
    for (unsigned i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        m.t1 = m.t2 = lengths[i];
        says_moments(m.t1);
    }
    kept_line("# short double steps and a guess that is long");
    m.guess_s = 700;
    m.best_only = true;
    for (unsigned i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        m.t1 = m.t2 = lengths[i];
        says_moments(m.t1);
    }
    plain_moments();
    kept_line("# few samples");
    for (m.samples = 5; m.samples < 500; m.samples += m.samples)
        says_moments(m.samples);
    plain_moments();
    m.best_only = true;
    m.part[0] = (struct test_element){1, 40, 0};
    m.part[1].gain = 0.45;
    grows("guesses", says_moments, &m.guess_s, 0.001, 20, 7);
    plain_moments();
    m.t2 = 0;
    m.late_by = 1e9;
    m.fast_only = true;
    grows("nothing for long", says_moments, &m.late, 355, 1.008, 9);
}

/* ---- rest ---- */

static struct {
    double noise, climb, swing, period, floor, motion, variance; /* climb: of all the window */
    uint32_t block, samples;
} r;

static void says_rest(double value)
{
    static struct steady steady;
    struct steady_config c = {
        1, r.block, REAL_C(2.0), (real_t)r.floor, (real_t)r.motion, (real_t)r.variance};
    struct random_source random = {SEED};
    struct steady_result s;
    double window = 16.0 * r.block;
    TEST_ASSERT_EQUAL_INT(ERR_OK, steady_init(&steady, &c));
    for (uint32_t k = 0; k < r.samples; k++) {
        real_t y = (real_t)(0.4 + r.climb * k / window +
                            r.swing * sin(6.283185307179586 * k / (r.period * window)) +
                            r.noise * normal(&random));
        TEST_ASSERT_EQUAL_INT(ERR_OK, steady_step(&steady, &y));
    }
    TEST_ASSERT_EQUAL_INT(ERR_OK, steady_look(&steady, 0, &s));
    kept_line("%.4g: %d mean %.5g %.3g level %.6g slope %.4g %.3g noise %.4g ratio %.4g age %.5g",
              value, s.state, (double)s.mean, (double)s.mean_sd, (double)s.level,
              (double)s.slope_per_s, (double)s.slope_sd_per_s, (double)s.noise_sd,
              (double)s.variance_ratio, (double)s.age_s);
}

static void plain_rest(void)
{
    memset(&r, 0, sizeof r);
    r.noise = 1e-3;
    r.period = 0.3;
    r.floor = 7e-5;
    r.motion = 3;
    r.variance = 4;
    r.block = 10;
    r.samples = 183;
}

static void of_rest(void)
{
    plain_rest();
    grows("climbs of several deviations", says_rest, &r.climb, 2e-3, 1.1, 8);
    r.motion = 0.1;
    grows("climbs that are just significant", says_rest, &r.climb, 2e-4, 1.25, 9);
    r.noise = 0;
    grows("climbs without noise", says_rest, &r.climb, 1e-6, 4, 8);
    plain_rest();
    grows("swings", says_rest, &r.swing, 5e-4, 1.25, 6);
    plain_rest();
    grows("noises about the floor", says_rest, &r.noise, 2e-5, 1.5, 6);
    plain_rest();
    kept_line("# short of a window");
    for (r.samples = 5; r.samples < 30; r.samples += 5)
        says_rest(r.samples);
    kept_line("# windows");
    for (r.block = 1; r.block < 50; r.block = 2 * r.block + 1)
        for (r.samples = 15 * r.block; r.samples < 36 * r.block; r.samples += 7 * r.block - 1)
            says_rest(r.block);
}

/* ---- the line guard ---- */

static struct {
    struct test_element element;
    double limit, noise, said, dead, share, blank;
} g;

static void says_guard(double value)
{
    static struct guard guard;
    struct guard_config c = {.outputs = 2,
                             .h_s = REAL_C(2.0),
                             .blanking_s = (real_t)g.blank,
                             .noise_share = (real_t)g.share};
    c.output[0] =
        (struct guard_output){REAL_C(0.0), (real_t)(0.8 * g.limit), REAL_C(0.0), REAL_C(0.0)};
    c.output[1] =
        (struct guard_output){REAL_C(0.4), (real_t)g.limit, (real_t)g.said, (real_t)g.dead};
    struct random_source random = {SEED};
    char text[350] = "";
    int trip = -1, first = -1;
    unsigned k, at = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, guard_init(&guard, &c));
    for (k = 0; k < 1500; k++) {
        real_t y[2] = {(real_t)step_response(&g.element, k),
                       (real_t)(0.4 + step_response(&g.element, k) + g.noise * normal(&random))};
        struct guard_prediction p;
        TEST_ASSERT_EQUAL_INT(ERR_OK, guard_step(&guard, y, &trip));
        if (trip >= 0 && at == 0) {
            at = k;
            first = trip;
        }
        if (k != 2 && k != 4 && k != 17 && k != 90 && k != 1499)
            continue;
        TEST_ASSERT_EQUAL_INT(ERR_OK, guard_predict(&guard, 1, &p));
        size_t end = strlen(text);
        snprintf(text + end, sizeof text - end, " | %.4g %.4g %.4g %.3g %u", (double)p.source,
                 (double)p.predicted, (double)p.slope_per_s, (double)p.sd, (unsigned)p.window);
    }
    kept_line("%.4g: %u by %d last %d%s", value, at, first, trip, text);
}

static void plain_guard(void)
{
    memset(&g, 0, sizeof g);
    g.element = (struct test_element){0.2, 60, 10};
    g.limit = 0.1;
    g.share = 0.05;
}

static void of_the_guard(void)
{
    kept_line("guard, by what grows: trips at, prediction at five samples");
    plain_guard();
    grows("limits", says_guard, &g.limit, 0.02, 1.4, 8);
    g.limit = 0.15;
    g.noise = 1e-5;
    grows("noises that are said", says_guard, &g.said, 2e-5, 1.5, 18);
    g.said = 3e-3;
    grows("shares", says_guard, &g.share, 0.003, 2, 8);
    plain_guard();
    g.said = g.noise = 2e-3;
    grows("dead times", says_guard, &g.dead, 3, 2.5, 6);
    plain_guard();
    g.said = g.noise = 1e-3;
    grows("limits in noise", says_guard, &g.limit, 0.02, 1.3, 8);
    plain_guard();
    g.element = (struct test_element){0.2, 1, 0};
    grows("at once", says_guard, &g.limit, 0.01, 2, 4);
    plain_guard();
    g.element.gain = -0.3;
    grows("waits", says_guard, &g.blank, 60, 1.5, 4);
}

/* ---- settling ---- */

static struct {
    struct test_element element;
    double noise, ramp; /* ramp: over the last quarter */
    uint32_t before, samples;
} s;

static void says_settling(double value)
{
    static struct record record;
    struct random_source random = {SEED};
    struct settling t;
    real_t reference = REAL_C(0.4);
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(&record, 1, 2));
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_begin(&record, &reference));
    for (uint32_t k = 0; k < s.samples; k++) {
        double ramp = fmax(0.0, (double)k / s.samples - 0.75) * 4.0 * s.ramp;
        real_t y = (real_t)(0.4 + step_response(&s.element, (double)k - s.before) + ramp +
                            s.noise * normal(&random));
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(&record, &y));
        if (k == s.before)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(&record, REAL_C(0.1)));
    }
    enum err err = settling_from_record(&record, 0, &t);
    if (err)
        kept_line("%.4g error %d", value, err);
    else
        kept_line("%.4g: %.5g t %.5g omega %.4g noise %.4g of %u", value, (double)t.change,
                  (double)t.t_98_s, (double)t.omega_per_s, (double)t.noise_sd, (unsigned)t.mean_of);
}

static void plain_settling(void)
{
    s.element = (struct test_element){0.2, 12, 3};
    s.noise = 1e-5;
    s.ramp = 0.0;
    s.before = 20;
    s.samples = 128;
}

static void of_settling(void)
{
    plain_settling();
    grows("settling in noise", says_settling, &s.noise, 6e-4, 1.08, 20);
    plain_settling();
    grows("ramps", says_settling, &s.ramp, 5e-4, 1.25, 9);
    s.noise = 5e-4;
    grows("ramps in noise", says_settling, &s.ramp, 2e-3, 1.15, 12);
    plain_settling();
    grows("lags", says_settling, &s.element.lag, 0.1, 1.7, 11);
    plain_settling();
    s.element.gain = -0.05;
    kept_line("# samples before");
    for (s.before = 1; s.before < 8; s.before++)
        says_settling(s.before);
    s.element = (struct test_element){0.2, 1, 0};
    kept_line("# short records");
    for (s.before = 6, s.samples = 20; s.samples < 30; s.samples++)
        says_settling(s.samples);
    s.element = (struct test_element){0.2, 60, 3};
    s.before = 43;
    kept_line("# blocks");
    for (s.samples = 120; s.samples < 1400; s.samples += 150)
        says_settling(s.samples);
}

static void what_many_records_say_is_what_was_kept(void)
{
    kept_open("reference/identify_cases.txt",
              "a threshold, a weight or a fall-back of moments, rest, guard or settling that "
              "changes by mistake moves a line");
    of_moments();
    of_rest();
    of_the_guard();
    of_settling();
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_many_records_say_is_what_was_kept);
    return UNITY_END();
}
