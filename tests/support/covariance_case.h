/* A made-up column of any number of stages, the transition of its mole fractions in float, and a dense covariance in double beside
 * which a filter's is held: P <- A P A' + Q and the update of one measurement as textbooks have them. */
#ifndef REFLUX_TESTS_COVARIANCE_CASE_H
#define REFLUX_TESTS_COVARIANCE_CASE_H

#include "kinds/composition/covariance.h"
#include "random_source.h"
#include "test_columns.h"

#include <math.h>
#include <string.h>

#define CASE_STATES COVARIANCE_STATES_MAX

struct covariance_case {
    struct component component[4];
    struct column_config config;
    struct column column;
    real_t x[COLUMN_STATES_MAX], rates[COLUMN_STATES_MAX];
    real_t numbers[COLUMN_STAGES_MAX * (3 * 9 + 2)];
    struct column_transition transition;
    size_t n, extras;
    real_t push[COVARIANCE_EXTRAS_MAX * COLUMN_STATES_MAX], keep[COVARIANCE_EXTRAS_MAX],
        grown[COVARIANCE_EXTRAS_MAX], noise[COLUMN_STATES_MAX];
    struct covariance_step step;
    double a[CASE_STATES][CASE_STATES]; /* the whole transition, in double, of the same factors */
    double p[CASE_STATES][CASE_STATES];
    struct random_source random;
};

/* -1 to 1 */
static inline double case_random(struct covariance_case *k)
{
    return (double)(random_next(&k->random) >> 11) / 9007199254740992.0 * 2 - 1;
}

static inline size_t case_all(const struct covariance_case *k)
{
    return k->n + k->extras;
}

/* Different on every stage, light ones above. */
static inline void case_profile(struct covariance_case *k)
{
    size_t c = k->config.components, top = k->config.stages - 1;
    for (size_t s = 0; s <= top; s++) {
        double up = (double)s / (double)top, raw[4], sum = 0;
        for (size_t j = 0; j < c; j++) {
            double heavy = (double)j / (double)(c - 1);
            raw[j] = 0.3 + 3 * up * (1 - heavy) + 3 * (1 - up) * heavy +
                     0.1 * (double)((7 * s + 5 * j) % 3);
            sum += raw[j];
        }
        for (size_t j = 0; j + 1 < c; j++)
            k->x[s * (c - 1) + j] = (real_t)(raw[j] / sum);
    }
}

/* d <- Phi d, by the factors, in double. magnitudes: of all of them, which bounds what rounding does on the way. */
static inline void case_apply(const struct column_transition *t, double *d, bool magnitudes)
{
    size_t m = t->m, stride = column_transition_stride(m);
    double w[3] = {0}, sum[3];
    for (size_t s = t->stages; s-- > 0;) {
        const real_t *p = t->factors + s * stride;
        for (size_t j = 0; j < m; j++)
            sum[j] =
                d[s * m + j] + (s + 1 < t->stages ? (double)p[3 * m * m] * d[s * m + m + j] : 0);
        for (size_t i = 0; i < m; i++) {
            d[s * m + i] = 0;
            for (size_t j = 0; j < m; j++)
                d[s * m + i] +=
                    (magnitudes ? fabs((double)p[i * m + j]) : (double)p[i * m + j]) * sum[j];
        }
    }
    for (size_t s = 0; s < t->stages; s++) {
        const real_t *by_vapour = t->factors + s * stride + m * m, *g = by_vapour + m * m;
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++)
                d[s * m + i] += (magnitudes ? fabs((double)by_vapour[i * m + j])
                                            : (double)by_vapour[i * m + j]) *
                                w[j];
        for (size_t i = 0; i < m; i++) {
            sum[i] = (double)g[m * m + 1] * w[i];
            for (size_t j = 0; j < m; j++)
                sum[i] +=
                    (magnitudes ? fabs((double)g[i * m + j]) : (double)g[i * m + j]) * d[s * m + j];
        }
        memcpy(w, sum, sizeof w);
    }
}

/* The whole transition, from the factors and what the extras push. */
static inline void case_dense(struct covariance_case *k)
{
    size_t all = case_all(k);
    double d[CASE_STATES];
    memset(k->a, 0, sizeof k->a);
    for (size_t j = 0; j < all; j++) {
        for (size_t i = 0; i < k->n; i++)
            d[i] = j < k->n ? i == j : (double)k->push[(j - k->n) * k->n + i];
        case_apply(&k->transition, d, false);
        for (size_t i = 0; i < k->n; i++)
            k->a[i][j] = d[i];
        if (j >= k->n)
            k->a[j][j] = (double)k->keep[j - k->n];
    }
}

/* Extras: the unknown part of each fraction of the feed, of its flow, then offsets. */
static inline bool case_extras(struct covariance_case *k, size_t extras, double h)
{
    static real_t work[COLUMN_STATES_MAX];
    size_t m = k->config.components - 1;
    k->extras = extras;
    memset(k->push, 0, sizeof k->push);
    for (size_t e = 0; e < extras; e++) {
        real_t *row = k->push + e * k->n;
        if (e < m)
            column_feed_slopes(&k->column, k->x, e, row);
        else if (e == m)
            column_feed_flow_slope(&k->column, k->x, row, work);
        for (size_t i = 0; i < k->n; i++)
            row[i] *= (real_t)h;
        k->keep[e] = REAL_C(1.0) - REAL_C(0.02) * (real_t)e;
        k->grown[e] = e % 2 ? REAL_C(1e-7) : REAL_C(0.0);
    }
    k->step = (struct covariance_step){.transition = &k->transition,
                                       .extras = extras,
                                       .push = k->push,
                                       .keep = k->keep,
                                       .grown = k->grown,
                                       .noise = k->noise};
    case_dense(k);
    return true;
}

/* c: components, 2 to 4. False: the model has no such column. */
static inline bool case_begin(struct covariance_case *k, size_t stages, size_t c, double efficiency,
                              size_t extras, double h)
{
    struct column_inputs inputs = ternary_inputs();
    struct column_fault fault;
    memset(k, 0, sizeof *k);
    k->random.state = 1000 * stages + 100 * c + extras;
    memcpy(k->component, test_components, sizeof test_components);
    k->component[3] = test_components[2];
    k->component[3].antoine[2] = REAL_C(-94.787);
    k->config = ternary_config(COLUMN_HOLDUP_MOLAR);
    k->config.stages = stages;
    k->config.feed_stage = stages / 2;
    k->config.components = c;
    k->config.component = k->component;
    k->config.efficiency = (real_t)efficiency;
    for (size_t j = 0; j < 4; j++)
        inputs.feed_fraction[j] = j < c ? 1 / (real_t)c : 0;
    if (column_init(&k->column, &k->config, &fault) != ERR_OK ||
        column_set_inputs(&k->column, &inputs, &fault) != ERR_OK)
        return false;
    case_profile(k);
    k->n = k->column.n_fractions;
    k->transition.factors = k->numbers;
    return column_rates(&k->column, k->x, k->rates) == ERR_OK &&
           column_transition_make(&k->column, k->x, (real_t)h, &k->transition) == ERR_OK &&
           case_extras(k, extras, h);
}

/* P <- A (P + N) A' + G. */
static inline void case_carry(struct covariance_case *k)
{
    static double ap[CASE_STATES][CASE_STATES];
    size_t all = case_all(k);
    for (size_t i = 0; i < k->step.noise_count; i++) {
        size_t at = (k->step.noise_first + i) % k->n;
        k->p[at][at] += (double)k->noise[at];
    }
    for (size_t i = 0; i < all; i++) {
        memset(ap[i], 0, sizeof ap[i]);
        for (size_t l = 0; l < all; l++)
            for (size_t j = 0; j < all && k->a[i][l] != 0; j++)
                ap[i][j] += k->a[i][l] * k->p[l][j];
    }
    for (size_t i = 0; i < all; i++)
        for (size_t j = i; j < all; j++) {
            double sum = 0;
            for (size_t l = 0; l < all; l++)
                sum += ap[i][l] * k->a[j][l];
            k->p[i][j] = k->p[j][i] = sum;
        }
    for (size_t e = 0; e < k->extras; e++)
        k->p[k->n + e][k->n + e] += (double)k->grown[e];
}

static inline double case_slope(const struct covariance_case *k,
                                const struct covariance_measurement *z, size_t i)
{
    double slope = i >= z->first && i < z->first + z->count ? (double)z->slope[i - z->first] : 0;
    return i == k->n + z->extra && z->extra < k->extras ? (double)z->extra_slope : slope;
}

/* P h' in gain; returns h P h'. */
static inline double case_project(const struct covariance_case *k,
                                  const struct covariance_measurement *z, double *gain)
{
    double variance = 0;
    for (size_t i = 0; i < case_all(k); i++) {
        gain[i] = 0;
        for (size_t j = 0; j < case_all(k); j++)
            gain[i] += k->p[i][j] * case_slope(k, z, j);
        variance += case_slope(k, z, i) * gain[i];
    }
    return variance;
}

/* The update; gain P h'/alpha. Returns alpha. */
static inline double case_take(struct covariance_case *k, const struct covariance_measurement *z,
                               double *gain)
{
    double alpha = case_project(k, z, gain) + (double)z->variance;
    for (size_t i = 0; i < case_all(k); i++)
        for (size_t j = 0; j <= i; j++)
            k->p[i][j] = k->p[j][i] = k->p[i][j] - gain[i] * gain[j] / alpha;
    for (size_t i = 0; i < case_all(k); i++)
        gain[i] /= alpha;
    return alpha;
}

#endif
