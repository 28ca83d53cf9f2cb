/* A banded covariance (kinds/composition/covariance_band.h) on a column that is drawn, and measurements of it. */
#ifndef REFLUX_TESTS_BAND_BENCH_H
#define REFLUX_TESTS_BAND_BENCH_H

#include "kinds/composition/covariance_band.h"
#include "random_source.h"
#include "unity.h"

#include <math.h>
#include <string.h>

#define MANY    40 /* stages */
#define M_MOST  3
#define Q_MOST  COVARIANCE_EXTRAS_MAX
#define AT_ONCE 2000 /* numbers: all of them */
#define SENSORS 4

static struct random_source source;
static struct covariance_band band;
static real_t memory[4000], factors[MANY * (3 * M_MOST * M_MOST + 2)];
static real_t push[Q_MOST * MANY * 2], keep[Q_MOST], grown[Q_MOST], noise[MANY * M_MOST];
static real_t variance[MANY * M_MOST + Q_MOST], gain[MANY * M_MOST + Q_MOST];
static struct column_transition transition = {.factors = factors};
static struct covariance_step step;

static inline double uniform(void)
{
    return (double)(random_next(&source) >> 11) / 9007199254740992.0 * 2 - 1;
}

static inline double between(double lo, double hi)
{
    return lo + (hi - lo) * (uniform() + 1) / 2;
}

/* A column like others: flows of about the holdup in a step, memory of vapours or none. */
static inline void draw_transition(size_t stages, size_t m, double memory_of_vapour)
{
    transition.stages = stages;
    transition.m = m;
    for (size_t s = 0; s < stages; s++) {
        real_t *of = &factors[s * column_transition_stride(m)];
        double liquid = between(0.2, 0.8), vapour = between(0.2, 0.8);
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++) {
                double own = i == j;
                of[i * m + j] = (real_t)((own + 0.1 * uniform()) / (1 + liquid + vapour));
                of[m * m + i * m + j] =
                    (real_t)(vapour * (own + 0.1 * uniform()) / (1 + liquid + vapour));
                of[2 * m * m + i * m + j] =
                    (real_t)((1 - memory_of_vapour) * (1.2 * own + 0.3 * uniform()));
            }
        of[3 * m * m] = s + 1 < stages ? (real_t)liquid : 0;
        of[3 * m * m + 1] = s == 0 ? 0 : (real_t)memory_of_vapour;
    }
}

static inline void draw_step(size_t stages, size_t m, size_t q)
{
    size_t n = stages * m;
    for (size_t e = 0; e < q; e++) {
        keep[e] = (real_t)(e % 3 == 2 ? 1 : between(0.6, 1));
        grown[e] = (real_t)(e % 3 == 2 ? 0 : between(0, 0.1));
        for (size_t i = 0; i < n; i++)
            push[e * n + i] = e % 3 == 1 && i / m != 1 ? 0 : (real_t)(0.3 * uniform());
    }
    for (size_t i = 0; i < n; i++)
        noise[i] = (real_t)between(0.02, 0.1);
    step = (struct covariance_step){.transition = &transition,
                                    .extras = q,
                                    .push = push,
                                    .keep = keep,
                                    .grown = grown,
                                    .noise = noise,
                                    .noise_first = 0,
                                    .noise_count = n};
}

static inline void bench_band(size_t stages, size_t m, size_t q)
{
    draw_transition(stages, m, 0.2);
    draw_step(stages, m, q);
    for (size_t i = 0; i < stages * m + q; i++)
        variance[i] = (real_t)between(0.1, 1);
    TEST_ASSERT_TRUE(covariance_band_bytes(stages, m, q) <= sizeof memory);
    TEST_ASSERT_EQUAL(ERR_OK, covariance_band_begin(&band, stages, m, q, variance, memory));
}

static inline const real_t *at_stage(size_t s)
{
    return &band.blocks[s * covariance_band_stride(band.m, band.extras)];
}

static inline struct covariance_measurement draw_measurement(real_t *slope)
{
    struct covariance_measurement z = {.slope = slope, .extra = band.extras};
    size_t stage = random_below(&source, (uint32_t)band.stages);
    for (size_t i = 0; i < band.m; i++)
        slope[i] = (real_t)uniform();
    z.first = stage * band.m + random_below(&source, (uint32_t)band.m);
    z.count = 1 + random_below(&source, (uint32_t)(band.m - z.first % band.m));
    if (band.extras > 0 && random_below(&source, 3) == 0) {
        z.extra = random_below(&source, (uint32_t)band.extras);
        z.extra_slope = (real_t)uniform();
    }
    z.variance = (real_t)between(0.1, 1);
    return z;
}

#endif
