/* Guards the promise of docs/inside/proofs.md that tests notice nine in ten faults drawn from the code. Answers are compared with references
 * within bounds, and a changed threshold, weight or fall-back mostly stays within them. Here it moves a line.
 *
 * The lines are how each test of an input ended and the model that start-up makes of it, six digits each: a double step from rest to rest
 * on first-order and other plants, without noise and with one seed of it, drifts, limits that are near, amplitudes and halves that are
 * given, lost samples, and a second test joined to the first. The plant's own numbers stand beside. test_experiment.c and test_model.c
 * check how right the model is.
 *
 * Kept in reference/model_cases.txt, which support/kept_transcript.h says how to write anew. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commission/limits.h"
#include "commission/model.h"
#include "commission_space.h"
#include "experiment_bench.h"
#include "kept_transcript.h"

#define SEED 20261122u

static struct commission c;

void setUp(void)
{
    memset(&c, 0, sizeof c);
    commission_lease(&c);
}
void tearDown(void) {}

struct plant_case {
    const char *name;
    uint8_t outputs;
    struct test_element element[3];
    double noise, drift;
    double (*other)(unsigned j, uint32_t k); /* instead of the elements */
    unsigned lost;                           /* of so many samples one; 0: none */
    /* 0: those of the bench */
    double amplitude, limit, blank, dead;
    uint32_t half, half_most;
    bool line_guard;
};

/* The steps so far, as the bench has put them in. */
static double stepped(const struct test_element *e, uint32_t k)
{
    double y = 0.0;
    for (unsigned i = 0; i < bench.edges; i++)
        y += bench.change[i] * step_response(e, k - bench.edge[i]);
    return y;
}

/* A fast part and a slow tail. */
static double tailed(unsigned j, uint32_t k)
{
    static const struct test_element fast = {0.5, 15, 4}, slow = {0.3, 150, 4};
    return (j ? -1.0 : 1.0) * (stepped(&fast, k) + stepped(&slow, k));
}

/* A gain that is larger up than down. */
static double curved(unsigned j, uint32_t k)
{
    static const struct test_element e = {1.0, 30, 8};
    double y = stepped(&e, k);
    return j ? 0.5 * y : y + 8.0 * y * y;
}

static double integrating(unsigned j, uint32_t k)
{
    static const struct test_element slow = {40.0, 20000, 5}, lag = {0.6, 30, 5};
    return stepped(j ? &lag : &slow, k);
}

/* Wrong way first. */
static double inverse(unsigned j, uint32_t k)
{
    static const struct test_element fast = {-0.4, 8, 2}, slow = {1.2, 40, 2};
    return (j ? 0.3 : 1.0) * (stepped(&fast, k) + stepped(&slow, k));
}

/* A drift that turns in the middle of the test. */
static double turning(unsigned j, uint32_t k)
{
    static const struct test_element e = {0.8, 40, 10};
    double after = k > 700 ? k - 700.0 : 0.0;
    return (j ? -0.5 : 1.0) * stepped(&e, k) + 4e-6 * after;
}

static double swinging(unsigned j, uint32_t k)
{
    double y = 0.0;
    for (unsigned i = 0; i < bench.edges; i++) {
        double t = k - bench.edge[i] - 3.0;
        if (t > 0)
            y += bench.change[i] * (1.0 - exp(-t / 60.0) * cos(t / 12.0));
    }
    return j ? 0.4 * y : y;
}

/* Time in samples of one second; Wood and Berry 1973 in tenths of a minute. */
#define WOOD_BERRY_R                                                                               \
    {                                                                                              \
        {1.6, 167, 10},                                                                            \
        {                                                                                          \
            0.66, 109, 70                                                                          \
        }                                                                                          \
    }
#define WOOD_BERRY_S                                                                               \
    {                                                                                              \
        {-2.3625, 210, 30},                                                                        \
        {                                                                                          \
            -1.94, 144, 30                                                                         \
        }                                                                                          \
    }

static const struct plant_case cases[] = {
    {"Wood-Berry R", 2, WOOD_BERRY_R, .noise = 0},
    {"Wood-Berry S", 2, WOOD_BERRY_S, .noise = 0},
    {"Wood-Berry R with noise", 2, WOOD_BERRY_R, .noise = 3e-4},
    {"Wood-Berry S with noise", 2, WOOD_BERRY_S, .noise = 3e-4},
    {"Wood-Berry S, noise and drift", 2, WOOD_BERRY_S, .noise = 1e-3, .drift = 2e-6},
    {"fast and slow", 3, {{0.8, 4, 1}, {-0.5, 90, 20}, {0.002, 30, 0}}, .noise = 2e-4},
    {"no lag and no response", 3, {{0.5, 0, 3}, {0, 1, 0}, {0.3, 2, 12}}, .noise = 1e-4},
    {"large gain near its limit", 2, {{3.5, 60, 15}, {0.6, 30, 5}}, .limit = 0.1},
    {"cut by the model's guard", 2, {{20, 80, 25}, {0.6, 40, 5}}, .limit = 0.15, .noise = 1e-4},
    {"cut by the line's guard", 2, {{20, 80, 25}, {0.6, 40, 5}}, .limit = 0.15, .line_guard = true},
    {"blanked, with a dead time known",
     2,
     {{12, 80, 25}, {0.6, 40, 5}},
     .limit = 0.15,
     .line_guard = true,
     .blank = 20,
     .dead = 25,
     .noise = 2e-4},
    {"past its limit at once", 2, {{40, 6, 0}, {0.6, 40, 5}}, .limit = 0.1},
    {"an amplitude given", 2, {{0.4, 30, 5}, {-0.2, 50, 9}}, .amplitude = 0.04, .noise = 3e-4},
    {"a half given", 2, {{0.4, 30, 5}, {-0.9, 80, 9}}, .half = 120, .noise = 2e-4},
    {"halves too short", 2, {{0.4, 300, 5}, {-0.9, 500, 40}}, .half_most = 150, .noise = 1e-4},
    {"one sample in ten lost", 2, {{0.9, 50, 12}, {-0.3, 25, 4}}, .lost = 10, .noise = 1e-4},
    {"grows out of the noise", 2, {{0.3, 20, 5}, {0.1, 40, 2}}, .noise = 1e-3},
    {"hidden by the noise", 2, {{0.02, 20, 5}, {0.01, 40, 2}}, .noise = 4e-3},
    {"fast drift", 2, {{0.8, 40, 10}, {-0.5, 20, 3}}, .noise = 2e-4, .drift = 1e-5},
    {"turning drift", 2, .other = turning, .noise = 1e-4},
    {"fast part and slow tail", 2, .other = tailed, .noise = 1e-4},
    {"curved", 2, .other = curved, .noise = 1e-4},
    {"integrating", 2, .other = integrating, .half_most = 600, .noise = 1e-4},
    {"wrong way first", 2, .other = inverse, .noise = 1e-4},
    {"swinging", 2, .other = swinging, .noise = 1e-4},
};

#define CASES (sizeof cases / sizeof cases[0])

static void set_up(const struct plant_case *p, unsigned seed)
{
    bench_begin(SEED + seed);
    memcpy(bench.element, p->element, sizeof p->element);
    bench.noise = p->noise;
    bench.drift = p->drift;
    bench.other = p->other;
    config.outputs = p->outputs;
    config.amplitude = (real_t)p->amplitude;
    config.blank_s = (real_t)p->blank;
    config.line_guard = p->line_guard;
    config.half = p->half;
    if (p->half_most > 0)
        config.half_most = p->half_most;
    for (unsigned j = 0; j < p->outputs; j++) {
        config.dead_time_s[j] = (real_t)p->dead;
        if (p->limit > 0)
            config.limit[j] = (real_t)p->limit;
    }
}

/* Prints a shape with its deviations, and the next plausible one. */
static void says(const char *what, const struct shape_found *f)
{
    static const char *const kinds[] = {"unknown",       "no response", "one lag", "two lags",
                                        "two with zero", "integrating", "slow",    "perhaps slow"};
    struct shape other;
    double weight = (double)shape_found_other(f, &other);
    kept_line("%s %s gain %.6g sd %.6g lag %.6g sd %.6g dead %.6g sd %.6g", what, kinds[f->kind],
              (double)f->shape.gain, (double)f->sd[SHAPE_GAIN], (double)f->shape.lag_s,
              (double)f->sd[SHAPE_LAG], (double)f->shape.dead_time_s, (double)f->sd[SHAPE_DEAD]);
    if (f->parameters > 3)
        kept_line("  square %.6g sd %.6g", (double)f->shape.square_s2, (double)f->sd[SHAPE_SQUARE]);
    if (f->parameters > 4)
        kept_line("  zero %.6g sd %.6g", (double)f->shape.zero_s, (double)f->sd[SHAPE_ZERO]);
    if (weight > 0.0)
        kept_line("  or %.3g gain %.4g lag %.4g dead %.4g square %.4g zero %.4g", weight,
                  (double)other.gain, (double)other.lag_s, (double)other.dead_time_s,
                  (double)other.square_s2, (double)other.zero_s);
}

/* Prints how the experiment ended. */
static void says_experiment(void)
{
    const struct experiment *x = &experiment;
    const struct excitation *u = &x->record.input;
    kept_line("phase %d failure %d culprit %u flags %d%d%d%d%d worst %.6g of %u predicted %.6g",
              x->phase, x->failure, x->culprit, x->cut, x->one_sided, x->at_longest, x->small,
              x->returned, (double)x->limits.worst, x->limits.worst_output, (double)x->predicted);
    kept_line("amplitude %.6g half %u samples %u points %u of %u edges %u", (double)x->amplitude,
              (unsigned)x->half, (unsigned)x->samples, (unsigned)x->record.points,
              (unsigned)x->record.block, (unsigned)u->edges);
}

static void fit_of_the_test(const struct plant_case *p, unsigned round)
{
    c.outputs.n = config.outputs;
    c.inputs.n = 1;
    c.work->experiment = experiment;
    model_begin_fit(&c);
    while (model_piece(&c))
        ;
    kept_line("# %s, fit %u", p->name, round);
    kept_line("error %d", c.model.error);
    if (c.model.error)
        return;
    for (uint8_t j = 0; j < c.outputs.n; j++) {
        kept_line("output %u is gain %.6g T %.6g L %.6g", j, p->element[j].gain, p->element[j].lag,
                  p->element[j].dead);
        says("fitted", interim_fit_shape(experiment_interim_fit(&c.work->experiment), j));
        kept_line("flags %x climbs %.6g unseen %.6g", c.model.fitted[j].flags,
                  (double)c.model.climbs[j], (double)model_unseen(&experiment, &c.model.fitted[j]));
    }
    model_keep(&c);
    c.inputs.input[0].rounds++;
    for (uint8_t j = 0; j < c.outputs.n; j++) {
        const struct element *e = &c.work->element[j][0];
        says("kept", &e->found);
        kept_line("flags %x", e->flags);
        kept_line("moments %.6g %.6g %.6g flags %x asymmetry %d plateau %.6g",
                  (double)e->moments.gain, (double)e->moments.time_constant_s,
                  (double)e->moments.dead_time_s, e->moments_flags, e->asymmetry,
                  (double)e->plateau_gain);
    }
}

static void analysis_of_the_tests(void)
{
    static struct config settings;
    settings.test.confidence = 0.95f;
    analysis_job_begin(&c, &settings, REAL_C(1.0));
    const struct analysis *a = &c.work->analysis;
    kept_line("plant %u by %u", a->plant.outputs, a->plant.inputs);
    for (uint8_t j = 0; j < c.outputs.n; j++) {
        const struct fopdt *e = &a->plant.element[j][0];
        kept_line("element %.6g sd %.6g T %.6g L %.6g square %.6g zero %.6g flags %x",
                  (double)e->gain, (double)a->plant.gain_sd[j][0], (double)e->time_constant_s,
                  (double)e->dead_time_s, (double)a->plant.shape[j][0].square_s2,
                  (double)a->plant.shape[j][0].zero_s + 0.0, a->flags[j][0]); /* no -0 */
    }
}

static void run(const struct plant_case *p)
{
    bench_start();
    for (uint32_t n = 0; n < 60000 && experiment.phase < EXPERIMENT_DONE; n++) {
        bool lost = p->lost > 0 && n > 300 && n % p->lost == 0;
        TEST_ASSERT_EQUAL_INT(ERR_OK, bench_sample(lost));
    }
}

static void the_models_of_small_plants_are_those_kept(void)
{
    kept_open("reference/model_cases.txt", "a threshold, a weight or a fall-back of a test or its "
                                           "model that changes by mistake moves a line");
    for (unsigned i = 0; i < CASES; i++) {
        memset(&c, 0, sizeof c);
        commission_lease(&c);
        for (unsigned round = 1; round <= 2; round++) {
            set_up(&cases[i], 100 * i + round);
            run(&cases[i]);
            kept_line("# %s, test %u", cases[i].name, round);
            says_experiment();
            if (experiment.phase == EXPERIMENT_DONE)
                fit_of_the_test(&cases[i], round);
        }
        analysis_of_the_tests();
    }
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_models_of_small_plants_are_those_kept);
    return UNITY_END();
}
