/* A column of two to four components and the step of column_implicit.h written once more, in double and with one full matrix:
 * derivatives are differences of balances summed up as the model's header says, flows and holdups held. */
#ifndef REFLUX_TESTS_DENSE_STEP_H
#define REFLUX_TESTS_DENSE_STEP_H

#include "model/column_implicit.h"
#include "test_columns.h"
#include "unity.h"

#include <math.h>
#include <string.h>

#define STAGES 10
#define TOP    (STAGES - 1)
#define MOST   4            /* components */
#define N_MOST (STAGES * 3) /* states */
#define FEED   3            /* from 0 */

static struct component components[MOST];
static struct column_config config;
static struct column column;
static struct column_fault fault;
static bool truncated[STAGES];
static real_t x[N_MOST], rates[N_MOST];

static inline size_t fractions(void)
{
    return config.components - 1;
}

static inline size_t states(void)
{
    return STAGES * fractions();
}

/* Different on every stage, light ones above. */
static inline void smooth_profile(void)
{
    size_t c = config.components;
    for (size_t s = 0; s < STAGES; s++) {
        double up = (double)s / TOP, raw[MOST], sum = 0;
        for (size_t j = 0; j < c; j++) {
            double heavy = (double)j / (double)(c - 1);
            raw[j] = 0.3 + 3 * up * (1 - heavy) + 3 * (1 - up) * heavy +
                     0.1 * (double)((7 * s + 5 * j) % 3);
            sum += raw[j];
        }
        for (size_t j = 0; j + 1 < c; j++)
            x[s * (c - 1) + j] = (real_t)(raw[j] / sum);
    }
}

static inline void make_column(size_t c, double efficiency, enum column_holdup holdup)
{
    struct column_inputs inputs = ternary_inputs();
    memcpy(components, test_components, sizeof test_components);
    components[3] = test_components[2];
    components[3].name = "heaviest";
    components[3].antoine[2] = REAL_C(-94.787);
    config = ternary_config(holdup);
    config.components = c;
    config.component = components;
    config.efficiency = (real_t)efficiency;
    for (size_t j = 0; j < MOST; j++)
        inputs.feed_fraction[j] = j < c ? REAL_C(1.0) / (real_t)c : REAL_C(0.0);
    memset(truncated, 0, sizeof truncated);
    TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, column_set_inputs(&column, &inputs, &fault), fault.field);
    smooth_profile();
}

static inline void rates_of_line(void)
{
    TEST_ASSERT_EQUAL(ERR_OK,
                      column_truncated_rates(&column, truncated, COLUMN_BETWEEN_LINE, x, rates));
}

/* ---- the same in double ---- */

static inline double own_pressure(size_t j, double t, double *slope)
{
    const real_t *a = components[j].antoine;
    double base = t + (double)a[2], p = exp((double)a[0] - (double)a[1] / base);
    *slope = p * (double)a[1] / (base * base);
    return p;
}

static inline void full_of(const double *at, size_t s, double *full)
{
    size_t m = fractions();
    full[m] = 1;
    for (size_t j = 0; j < m; j++) {
        full[j] = at[s * m + j];
        full[m] -= full[j];
    }
}

static inline double own_bubble_point(const double *at, size_t s)
{
    double full[MOST], t = 370, step = 1;
    full_of(at, s, full);
    for (int i = 0; i < 100 && fabs(step) > 1e-11; i++) {
        double sum = 0, slope = 0, by;
        for (size_t j = 0; j < config.components; j++) {
            sum += full[j] * own_pressure(j, t, &by);
            slope += full[j] * by;
        }
        step = (double)column.pressure[s] * log(sum / (double)column.pressure[s]) / slope * sum /
               (double)column.pressure[s];
        t -= step;
    }
    return t;
}

/* Vapours of all stages; of a truncated one each fraction goes with its own liquid. */
static inline void own_vapours(const double *at, double *w)
{
    size_t c = config.components;
    for (size_t s = 0; s < STAGES; s++) {
        double full[MOST], e = s == 0 ? 1 : (double)config.efficiency, unused;
        if (s == FEED)
            e = (double)column.feed_efficiency;
        full_of(at, s, full);
        double t = truncated[s] ? 0 : own_bubble_point(at, s);
        for (size_t j = 0; j < c; j++) {
            double k = truncated[s] ? (double)column.k[s * c + j]
                                    : own_pressure(j, t, &unused) / (double)column.pressure[s];
            w[s * c + j] = e * full[j] * k + (s == 0 ? 0 : (1 - e) * w[(s - 1) * c + j]);
        }
    }
}

static inline void own_rates(const double *at, double *out)
{
    size_t c = config.components, m = c - 1;
    double w[STAGES * MOST];
    own_vapours(at, w);
    for (size_t s = 0; s < STAGES; s++)
        for (size_t j = 0; j < m; j++) {
            double here = at[s * m + j], sum = 0;
            if (s < TOP)
                sum -= (double)column.vapour_flow[s] * (w[s * c + j] - here) -
                       (double)column.liquid[s + 1] * (at[(s + 1) * m + j] - here);
            if (s > 0)
                sum += (double)column.vapour_flow[s - 1] * (w[(s - 1) * c + j] - here);
            if (s == FEED)
                sum += (double)column.flows.feed * ((double)column.inputs.feed_fraction[j] - here);
            out[s * m + j] = sum / (double)column.holdup[s];
        }
}

static inline void solve_dense(double a[N_MOST][N_MOST + 1], size_t n)
{
    for (size_t p = 0; p < n; p++) {
        size_t best = p;
        for (size_t i = p; i < n; i++)
            if (fabs(a[i][p]) > fabs(a[best][p]))
                best = i;
        for (size_t j = p; j <= n; j++) {
            double kept = a[p][j];
            a[p][j] = a[best][j];
            a[best][j] = kept;
        }
        for (size_t i = 0; i < n; i++) {
            double part = i == p ? 0 : a[i][p] / a[p][p];
            for (size_t j = p; i != p && j <= n; j++)
                a[i][j] -= part * a[p][j];
        }
    }
    for (size_t i = 0; i < n; i++)
        a[i][n] /= a[i][i];
}

#define DIFFERENCE 1e-5

/* dT/dx_j of a stage. */
static inline double own_slope(const double *at, size_t s, size_t j)
{
    double moved[N_MOST];
    memcpy(moved, at, sizeof moved);
    moved[s * fractions() + j] += DIFFERENCE;
    double above = own_bubble_point(moved, s);
    moved[s * fractions() + j] -= 2 * DIFFERENCE;
    return (above - own_bubble_point(moved, s)) / (2 * DIFFERENCE);
}

/* Adds the draw of stage s to its row. */
static inline void add_pull(double a[N_MOST][N_MOST + 1], const double *at, double h,
                            const struct column_pull *p)
{
    size_t m = fractions(), row = p->stage * m + p->component;
    double own = own_slope(at, p->stage, p->component);
    for (size_t j = 0; j < m; j++)
        a[row][p->stage * m + j] += h * (double)p->gain * own_slope(at, p->stage, j) / own;
    a[row][states()] += h * ((double)p->gain * (double)p->deviation + (double)p->rate) / own;
}

/* d of (I - h J) d = h (f + p), algebraic where the last but one fraction follows from a given temperature. */
static inline void dense_step(double h, const struct column_pull *pull, size_t pulls, double *d)
{
    static double a[N_MOST][N_MOST + 1];
    size_t n = states(), m = fractions();
    double at[N_MOST] = {0}, up[N_MOST], down[N_MOST];
    for (size_t i = 0; i < n; i++)
        at[i] = (double)x[i];
    for (size_t j = 0; j < n; j++) {
        double kept = at[j];
        at[j] = kept + DIFFERENCE;
        own_rates(at, up);
        at[j] = kept - DIFFERENCE;
        own_rates(at, down);
        at[j] = kept;
        for (size_t i = 0; i < n; i++)
            a[i][j] = (i == j ? 1 : 0) - h * (up[i] - down[i]) / (2 * DIFFERENCE);
    }
    for (size_t i = 0; i < n; i++)
        a[i][n] = h * (double)rates[i];
    for (size_t k = 0; k < pulls; k++)
        add_pull(a, at, h, &pull[k]);
    for (size_t s = 0; s < STAGES; s++) {
        double *row = a[s * m + m - 1];
        const real_t *k = &column.k[s * (m + 1)];
        if (!truncated[s])
            continue;
        memset(row, 0, sizeof a[0]);
        for (size_t j = 0; j < m; j++)
            row[s * m + j] = (double)k[j] - (double)k[m];
    }
    solve_dense(a, n);
    for (size_t i = 0; i < n; i++)
        d[i] = a[i][n];
}

static inline double largest_of(const double *v, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(v[i]));
    return most;
}

#endif
