#include "model/column_transition.h"

#include "model/column_inside.h"
#include "num/solve_small.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define M_MAX ((size_t)COLUMN_COMPONENTS_MAX - 1)
#define WIDTH (3 * M_MAX) /* a matrix and two more as its right sides */

/* One stage's equations, of what the stage above answers (its T) and the vapour from below:
 *
 *     (own + B G) d_s = (H/h) v_s + L r_(s+1) + (V_in - keep B) w_(s-1),   B = V_out - L T_(s+1)
 *
 * own: H/h and all that flows in, less V_out. Rows hold the matrix, then H/h, then the factor of w_(s-1). */
static ALWAYS_INLINE void stage_rows(size_t m, const struct column *column, size_t s, real_t h,
                                     real_t keep, const real_t *g, const real_t *t_above,
                                     real_t *rows)
{
    const struct column_config *config = column->config;
    bool top = s + 1 == config->stages;
    real_t liquid = top ? ZERO : column_downward(column->liquid[s + 1]);
    real_t vapour_in = s == 0 ? ZERO : column->vapour_flow[s - 1], out = column->vapour_flow[s];
    real_t feed = s + 1 == config->feed_stage ? column->flows.feed : ZERO;
    real_t gathers = column->holdup[s] / h, own = gathers + liquid + vapour_in + feed - out;
    real_t leaves[M_MAX * M_MAX];

    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            leaves[i * m + j] = (i == j ? out : ZERO) - (top ? ZERO : liquid * t_above[i * m + j]);
    for (size_t i = 0; i < m; i++) {
        real_t *row = &rows[i * WIDTH];
        for (size_t j = 0; j < m; j++) {
            real_t sum = i == j ? own : ZERO;
            for (size_t k = 0; k < m; k++)
                sum += leaves[i * m + k] * g[k * m + j];
            row[j] = sum;
            row[m + j] = i == j ? gathers : ZERO;
            row[2 * m + j] = (i == j ? vapour_in : ZERO) - keep * leaves[i * m + j];
        }
    }
}

/* Vapour leaving the stage by its own liquid: E dy/dx. Nothing leaves a condenser. */
static ALWAYS_INLINE void vapour_by_liquid(size_t m, const struct column *column, const real_t *x,
                                           size_t s, real_t efficiency, real_t *g)
{
    size_t c = m + 1;
    real_t full[COLUMN_COMPONENTS_MAX], unused[M_MAX];

    if (s + 1 == column->config->stages) {
        for (size_t i = 0; i < m * m; i++)
            g[i] = ZERO;
        return;
    }
    column_full_composition(column, x, s, full);
    vle_slopes(c, full, &column->k[s * c], &column->dk[s * c], unused, g);
    for (size_t i = 0; i < m * m; i++)
        g[i] *= efficiency;
}

static ALWAYS_INLINE enum err factor(size_t m, const struct column *column, const real_t *x,
                                     real_t h, struct column_transition *t)
{
    size_t stride = column_transition_stride(m), stages = column->config->stages;
    real_t rows[M_MAX * WIDTH];

    for (size_t s = stages; s-- > 0;) {
        real_t *p = &t->factors[s * stride], *by_vapour = p + m * m, *g = p + 2 * m * m;
        real_t efficiency = column_efficiency_of(column, s), keep = ONE - efficiency;
        vapour_by_liquid(m, column, x, s, efficiency, g);
        stage_rows(m, column, s, h, keep, g, by_vapour + stride, rows);
        if (!solve_small(m, 3 * m, WIDTH, rows))
            return ERR_RANGE;
        real_t all = ZERO;
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++) {
                p[i * m + j] = rows[i * WIDTH + m + j];
                by_vapour[i * m + j] = rows[i * WIDTH + 2 * m + j];
                all += real_abs(p[i * m + j]) + real_abs(by_vapour[i * m + j]);
            }
        if (!isfinite(all))
            return ERR_RANGE;
        p[3 * m * m] =
            s + 1 == stages ? ZERO : column_downward(column->liquid[s + 1]) * h / column->holdup[s];
        p[3 * m * m + 1] = keep;
    }
    return ERR_OK;
}

enum err column_transition_make(const struct column *column, const real_t *x, real_t h,
                                struct column_transition *t)
{
    size_t m = column->config->components - 1;

    t->stages = column->config->stages;
    t->m = m;
    return m == 2 ? factor(2, column, x, h, t) : factor(m, column, x, h, t);
}

static ALWAYS_INLINE void carry_deviations(size_t m, const struct column_transition *t, real_t *v)
{
    size_t stride = column_transition_stride(m);
    real_t sum[M_MAX], vapour[M_MAX] = {ZERO};

    for (size_t s = t->stages; s-- > 0;) {
        const real_t *p = &t->factors[s * stride];
        real_t *here = &v[s * m], liquid = p[3 * m * m];
        for (size_t j = 0; j < m; j++)
            sum[j] = s + 1 < t->stages ? here[j] + liquid * here[m + j] : here[j];
        for (size_t i = 0; i < m; i++) {
            here[i] = ZERO;
            for (size_t j = 0; j < m; j++)
                here[i] += p[i * m + j] * sum[j];
        }
    }
    for (size_t s = 0; s < t->stages; s++) {
        const real_t *by_vapour = &t->factors[s * stride + m * m], *g = by_vapour + m * m;
        real_t *here = &v[s * m], keep = g[m * m + 1];
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++)
                here[i] += by_vapour[i * m + j] * vapour[j];
        for (size_t i = 0; i < m; i++) {
            vapour[i] *= keep;
            for (size_t j = 0; j < m; j++)
                vapour[i] += g[i * m + j] * here[j];
        }
    }
}

void column_transition_apply(const struct column_transition *t, real_t *v)
{
    if (t->m == 2)
        carry_deviations(2, t, v);
    else
        carry_deviations(t->m, t, v);
}

void column_feed_slopes(const struct column *column, const real_t *x, size_t j, real_t *slope)
{
    size_t feed = column->config->feed_stage - 1, m = column->config->components - 1;
    (void)x;

    for (size_t i = 0; i < column->n_fractions; i++)
        slope[i] = ZERO;
    slope[feed * m + j] = column->flows.feed / column->holdup[feed];
}

real_t column_feed_moles_slope(const struct column *column, size_t j)
{
    const struct column_config *config = column->config;
    const struct column_inputs *in = &column->inputs;
    const struct component *own = &config->component[j],
                           *last = &config->component[config->components - 1];
    size_t c = config->components;

    if (in->feed_basis == COLUMN_FLOW_MASS)
        return (last->molar_mass - own->molar_mass) /
               mixture_molar_mass(config->component, c, in->feed_fraction);
    if (in->feed_basis == COLUMN_FLOW_VOLUME)
        return (component_molar_volume(last, in->feed_temperature) -
                component_molar_volume(own, in->feed_temperature)) /
               mixture_molar_volume(config->component, c, in->feed_fraction, in->feed_temperature);
    return ZERO;
}

static void rates_with_feed(struct column *column, const real_t *x, real_t part, real_t *rates)
{
    column_flows_with_feed(column, x, part);
    column_balances(column, x, rates);
}

void column_feed_flow_slope(struct column *column, const real_t *x, real_t *slope, real_t *work)
{
    real_t scale = ONE / (REAL_C(2.0) * COLUMN_FLOW_PART);

    rates_with_feed(column, x, ONE + COLUMN_FLOW_PART, slope);
    rates_with_feed(column, x, ONE - COLUMN_FLOW_PART, work);
    for (size_t i = 0; i < column->n_fractions; i++)
        slope[i] = (slope[i] - work[i]) * scale;
    column_flows_with_feed(column, x, ONE);
}
