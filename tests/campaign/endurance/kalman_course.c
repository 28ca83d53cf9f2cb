#include "kalman.h"

#include <string.h>

#include "column.h"

static const struct {
    real_t sensor_sd, begin_sd, extra_sd, noise_sd; /* noise_sd: of a fraction, over an hour */
} kinds[KALMAN_KINDS] = {
    [KALMAN_PLAIN] = {0.2f, 0.05f, 0.1f, 0.02f},
    [KALMAN_STIFF] = {1e-3f, 1, 1, 0.02f},
    [KALMAN_QUIET] = {1e-3f, 1, 1, 0},
};

#define ANALYSIS_EVERY 20
#define NOISY          8 /* fractions a step, going round */

static struct composition_block estimator;

static double uniform(struct kalman_course *c)
{
    return (double)(random_next(&c->random) >> 11) / 9007199254740992.0;
}

/* Numbered from 1. */
static size_t sensor_stage(const struct kalman_course *c, size_t k)
{
    static const size_t tall[KALMAN_SENSORS] = {5, 30, 31, 33},
                        small[KALMAN_SENSORS] = {2, 9, 10, 11};
    return c->stages == 37 ? tall[k] : small[k];
}

static bool take_variant(struct kalman_course *c, struct kalman_variant *v)
{
    static real_t work[2 * 37];
    struct composition_block *e = &estimator;
    v->transition.factors = v->numbers;
    if (column_rates(&e->model.column, e->model.x, work) != ERR_OK ||
        column_transition_make(&e->model.column, e->model.x, BENCH_STEP_S, &v->transition) !=
            ERR_OK)
        return false;
    memset(v->push, 0, sizeof v->push);
    for (size_t j = 0; j < 2; j++)
        column_feed_slopes(&e->model.column, e->model.x, j, v->push + j * c->n);
    column_feed_flow_slope(&e->model.column, e->model.x, v->push + 2 * c->n, work);
    for (size_t i = 0; i < 3 * c->n; i++)
        v->push[i] *= BENCH_STEP_S;
    for (size_t k = 0; k < KALMAN_SENSORS; k++) {
        size_t s = sensor_stage(c, k) - 1;
        real_t full[3], dy[4];
        for (size_t j = 0; j < 3; j++)
            full[j] = column_fraction(&e->model.column, e->model.x, s, j);
        vle_slopes(3, full, &e->model.column.k[3 * s], &e->model.column.dk[3 * s], v->slope[k], dy);
    }
    memset(v->a, 0, sizeof v->a);
    for (size_t j = 0; j < c->all; j++) {
        for (size_t i = 0; i < c->n; i++)
            work[i] = j < c->n ? (real_t)(i == j) : v->push[(j - c->n) * c->n + i];
        column_transition_apply(&v->transition, work);
        memcpy(v->a[j], work, c->n * sizeof *work);
        if (j >= c->n)
            v->a[j][j] = c->keep[j - c->n];
    }
    return true;
}

bool kalman_begin(struct kalman_course *c, enum kalman_kind kind, size_t stages, uint64_t seed)
{
    bool quiet = kinds[kind].noise_sd == 0;
    memset(c, 0, sizeof *c);
    c->kind = kind;
    c->stages = stages;
    c->n = 2 * stages;
    c->all = c->n + KALMAN_EXTRAS;
    c->random.state = seed;
    for (size_t e = 0; e < KALMAN_EXTRAS;
         e++) { /* known to begin_sd without measurements, in the long run */
        c->keep[e] = quiet ? 1 : 0.9995f;
        c->grown[e] = quiet ? 0 : (1 - 0.9995f * 0.9995f) * 0.01f;
    }
    for (size_t i = 0; i < c->n; i++)
        c->noise[i] = kinds[kind].noise_sd * kinds[kind].noise_sd * BENCH_STEP_S / 3600 *
                      (real_t)c->n / NOISY;
    for (size_t i = 0; i < c->all; i++) {
        real_t sd = i < c->n ? kinds[kind].begin_sd : kinds[kind].extra_sd;
        c->begin[i] = sd * sd;
    }
    if (!bench_begin(&estimator, stages, METHOD_REKF, ALL_STAGES))
        return false;
    for (size_t v = 0; v < KALMAN_VARIANTS; v++) {
        real_t readings[BENCH_SENSORS];
        for (unsigned k = 0; k < 50; k++) {
            bench_next(&estimator, readings);
            if (whole_step(&estimator, readings) != ERR_OK)
                return false;
        }
        if (!take_variant(c, &c->variant[v]))
            return false;
    }
    return true;
}

static struct covariance_measurement *add_measurement(struct kalman_course *c)
{
    size_t k = c->measurements++;
    c->taken[k] = (struct covariance_measurement){.slope = c->slopes[k], .extra = KALMAN_EXTRAS};
    return &c->taken[k];
}

/* One of the working points; each thermometer is there three times out of four, and its slope moves by 5 %. */
void kalman_next(struct kalman_course *c)
{
    c->actual = &c->variant[random_below(&c->random, KALMAN_VARIANTS)];
    c->step = (struct covariance_step){.transition = &c->actual->transition,
                                       .extras = KALMAN_EXTRAS,
                                       .push = c->actual->push,
                                       .keep = c->keep,
                                       .grown = c->grown,
                                       .noise = c->noise,
                                       .noise_first = c->t * NOISY % c->n,
                                       .noise_count = NOISY};
    c->measurements = 0;
    for (size_t k = 0; k < KALMAN_SENSORS; k++) {
        if (uniform(c) < 0.25)
            continue;
        struct covariance_measurement *z = add_measurement(c);
        z->first = 2 * (sensor_stage(c, k) - 1);
        z->count = 2;
        for (size_t j = 0; j < 2; j++)
            c->slopes[z - c->taken][j] = c->actual->slope[k][j] * (real_t)(0.95 + 0.1 * uniform(c));
        z->variance = kinds[c->kind].sensor_sd * kinds[c->kind].sensor_sd;
    }
    if (c->t++ % ANALYSIS_EVERY == 0) {
        struct covariance_measurement *z = add_measurement(c);
        z->first = c->n - 1;
        z->count = 1;
        c->slopes[z - c->taken][0] = 1;
        z->extra = KALMAN_EXTRAS - 1;
        z->extra_slope = 1;
        z->variance = 1e-6f;
    }
}
