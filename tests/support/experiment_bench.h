/* One double step on a plant of first-order elements, in double, noise and all; for the tests of firmware/commission.
 * Times in samples of 1 s. */
#ifndef REFLUX_TESTS_EXPERIMENT_BENCH_H
#define REFLUX_TESTS_EXPERIMENT_BENCH_H

#include "commission/experiment.h"
#include "commission/experiment_state.h"
#include "step_records.h"
#include "unity.h"

#define BENCH_EDGES 64

struct experiment_bench {
    struct test_element element[CHANNEL_MAX];
    double noise, drift; /* standard deviation, per sample */
    double extra[CHANNEL_MAX];
    double (*other)(unsigned j, uint32_t k); /* instead of the elements */
    struct random_source random;
    uint32_t k;                    /* samples taken */
    uint32_t look_takes, look_age; /* samples */
    unsigned edges;
    double level, edge[BENCH_EDGES], change[BENCH_EDGES];
    real_t last[CHANNEL_MAX];
};

static struct experiment_bench bench;
static struct experiment experiment;
static struct experiment_config config;

static inline void bench_begin(uint64_t seed)
{
    memset(&bench, 0, sizeof bench);
    bench.random.state = seed;
    bench.look_takes = 2;
    config = (struct experiment_config){.outputs = 1,
                                        .h_s = 1,
                                        .window = 60,
                                        .noise_floor = REAL_C(7e-5),
                                        .amplitude_first = REAL_C(0.02),
                                        .amplitude_max = REAL_C(0.25),
                                        .noise_multiple = 20,
                                        .half_least = 60,
                                        .half_most = 5000};
    for (unsigned j = 0; j < CHANNEL_MAX; j++)
        config.limit[j] = REAL_C(0.2);
}

static inline double bench_output(unsigned j)
{
    double y = 0.5 + bench.drift * bench.k + bench.extra[j];
    if (bench.other)
        return y + bench.other(j, bench.k);
    for (unsigned i = 0; i < bench.edges; i++)
        y += bench.change[i] * step_response(&bench.element[j], bench.k - bench.edge[i]);
    return y;
}

/* The background, which takes as long as it takes. */
static inline void bench_look(void)
{
    if (!experiment.interim_fitting) {
        bench.look_age = 0;
        return;
    }
    if (bench.look_age++ < bench.look_takes)
        return;
    while (interim_fit_run(&experiment.interim_fit))
        ;
    experiment_take_interim_fit(&experiment);
}

/* The next sample of every output, given to the experiment or lost on the way. */
static inline enum err bench_sample(bool lost)
{
    enum err err;
    real_t y[CHANNEL_MAX];
    for (unsigned j = 0; j < config.outputs; j++)
        y[j] = (real_t)(bench_output(j) +
                        (bench.noise > 0.0 ? bench.noise * normal(&bench.random) : 0.0));
    err = lost ? experiment_missed(&experiment) : experiment_step(&experiment, y);
    memcpy(bench.last, y, sizeof y);
    bench_look();
    if ((double)experiment.level != bench.level) {
        TEST_ASSERT_FALSE_MESSAGE(lost, "the output was moved where it could not be");
        TEST_ASSERT_TRUE(bench.edges < BENCH_EDGES);
        bench.edge[bench.edges] = bench.k;
        bench.change[bench.edges++] = (double)experiment.level - bench.level;
        bench.level = (double)experiment.level;
    }
    bench.k++;
    return err;
}

static inline void bench_start(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, experiment_begin(&experiment, &config));
}

/* To the end, or for `most` samples. */
static inline void bench_run_for(uint32_t most)
{
    for (uint32_t n = 0; n < most && experiment.phase < EXPERIMENT_DONE; n++)
        TEST_ASSERT_EQUAL_INT(ERR_OK, bench_sample(false));
}

static inline void bench_run(void)
{
    bench_start();
    bench_run_for(1000000);
    TEST_ASSERT_TRUE(experiment.phase >= EXPERIMENT_DONE);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)experiment.level);
}

/* To the beginning of a phase. */
static inline void bench_run_to(enum experiment_phase phase)
{
    for (uint32_t n = 0; n < 1000000 && experiment.phase < phase; n++)
        TEST_ASSERT_EQUAL_INT(ERR_OK, bench_sample(false));
    TEST_ASSERT_EQUAL_INT(phase, experiment.phase);
}

#endif
