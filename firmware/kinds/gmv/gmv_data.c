/* Data of the self-tuner: what was measured, what was applied, and the regressions made of it. docs/self-tuning.md, Model. */
#include <string.h>

#include "kinds/gmv/gmv_inside.h"

/* Folami (1989), 8.38. */
#define RESIDUAL_SHARE 0.8f

num_t gmv_taken(const struct gmv *g, const struct gmv_signal *s, unsigned steps, unsigned k)
{
    num_t value = gmv_ago(g, s, steps);
    return g->shape.form == GMV_INCREMENTAL ? num_sub(value, gmv_ago(g, s, steps + k)) : value;
}

num_t gmv_applied(const struct gmv_sample *s, unsigned j, unsigned steps)
{
    return applied_steps_ago(s->applied[j], steps, s->divisor);
}

num_t gmv_applied_taken(const struct gmv *g, const struct gmv_sample *s, unsigned j, unsigned steps,
                        unsigned k)
{
    num_t value = gmv_applied(s, j, steps);
    return g->shape.form == GMV_INCREMENTAL ? num_sub(value, gmv_applied(s, j, steps + k)) : value;
}

/* phi_i(t - steps), steps from 1 on: of u everything is known. */
static void regressor(const struct gmv *g, const struct gmv_sample *s, unsigned i, unsigned steps,
                      num_t *phi)
{
    const struct gmv_shape *shape = &g->shape;
    unsigned k = gmv_horizon(shape, i);
    for (unsigned a = 0; a < shape->na; a++)
        phi[a] = gmv_taken(g, &g->y[i], steps + a, k);
    for (unsigned j = 0; j < shape->loops; j++) {
        int place = gmv_place_of_u(shape, i, j);
        for (unsigned b = 0; b < shape->nb && place >= 0; b++)
            phi[(unsigned)place + b] =
                gmv_applied_taken(g, s, j, steps + gmv_behind(shape, i, j) + b, k);
    }
    phi += shape->na;
    for (unsigned j = 0; j < shape->loops; j++)
        phi += shape->delay[i][j] ? shape->nb : 0u;
    for (unsigned m = 0; m < shape->disturbances; m++)
        *phi++ = gmv_taken(g, &g->disturbance[m], steps + shape->disturbance_delay, k);
    for (unsigned c = 1; c <= shape->nc; c++)
        *phi++ = gmv_ago(g, &g->prediction[i], steps + c);
    if (gmv_place_of_bias(shape, i) >= 0)
        *phi = shape->bias == GMV_BIAS_ONE ? num_one() : gmv_ago(g, &g->residual[i], steps);
}

/* P of loop i, of a signal that was `before` a step ago. */
static num_t weighed(const struct gmv *g, unsigned i, num_t now, num_t before)
{
    return num_mul(g->p_scale[i], num_sub(now, num_mul(g->p[i], before)));
}

/* P y as the form takes y; in the explicit way the regression has no P. */
static num_t regressed(const struct gmv *g, unsigned i, unsigned steps)
{
    unsigned k = gmv_horizon(&g->shape, i);
    num_t now = gmv_taken(g, &g->y[i], steps, k);
    if (g->shape.way == GMV_EXPLICIT)
        return now;
    return weighed(g, i, now, gmv_taken(g, &g->y[i], steps + 1u, k));
}

num_t gmv_auxiliary(const struct gmv *g, unsigned i)
{
    return weighed(g, i, gmv_ago(g, &g->y[i], 0), gmv_ago(g, &g->y[i], 1));
}

num_t gmv_setpoint(const struct gmv *g, unsigned i)
{
    return g->weighs_setpoint[i] ? weighed(g, i, g->w[i], g->w_before[i])
                                 : accumulator_get(&g->setpoint[i]);
}

static void fill_signal(struct gmv_signal *s, num_t value)
{
    for (unsigned k = 0; k < GMV_KEPT; k++)
        s->at[k] = value;
}

/* Before it the plant was at rest here, as far as anybody knows; nothing is learnt from that. */
static void begin_data(struct gmv *g, const struct gmv_sample *s)
{
    for (unsigned i = 0; i < g->shape.loops; i++) {
        fill_signal(&g->y[i], s->y[i]);
        fill_signal(&g->prediction[i], num_zero());
        fill_signal(&g->residual[i], num_zero());
        accumulator_set(&g->setpoint[i], s->w[i]);
        g->w[i] = s->w[i];
    }
    for (unsigned m = 0; m < g->shape.disturbances; m++)
        fill_signal(&g->disturbance[m], s->disturbance[m]);
}

void gmv_take(struct gmv *g, const struct gmv_sample *s)
{
    if (g->steps == 0)
        begin_data(g, s);
    g->newest = (g->newest + 1u) % GMV_KEPT;
    g->steps += g->steps < UINT32_MAX;
    for (unsigned i = 0; i < g->shape.loops; i++) {
        num_t away = num_sub(s->w[i], accumulator_get(&g->setpoint[i]));
        g->y[i].at[g->newest] = s->y[i];
        g->w_before[i] = g->w[i];
        g->w[i] = s->w[i];
        accumulator_add_product(&g->setpoint[i], g->r_share[i], away);
        g->prediction[i].at[g->newest] = num_zero();
        g->residual[i].at[g->newest] = gmv_ago(g, &g->residual[i], 1);
    }
    for (unsigned m = 0; m < g->shape.disturbances; m++)
        g->disturbance[m].at[g->newest] = s->disturbance[m];
}

static num_t product_with(const struct gmv *g, unsigned i, const num_t *phi)
{
    num_wide_t sum = num_wide_zero();
    for (unsigned p = 0; p < gmv_parameters(&g->shape, i); p++)
        sum = num_wide_add(sum, g->used[i][p], phi[p]);
    return num_from_wide(sum);
}

/* What was predicted a step ago, now that it is known what was applied of the MVs. */
static void note_prediction(struct gmv *g, const struct gmv_sample *s, unsigned i)
{
    num_t phi[GMV_PARAMETERS];
    regressor(g, s, i, 1, phi);
    g->prediction[i].at[(g->newest - 1u) % GMV_KEPT] = rls_predict(gmv_rls(g, i), phi);
}

/* phi_i(t - horizon) and what it should give, both averaged over the data filter. */
static num_t filtered_regression(const struct gmv *g, const struct gmv_sample *s, unsigned i,
                                 num_t *phi)
{
    unsigned n = gmv_parameters(&g->shape, i), m = g->shape.average, k = gmv_horizon(&g->shape, i);
    num_t one[GMV_PARAMETERS], share = num_from_float(1.0f / (float)m), target = regressed(g, i, 0);
    memset(phi, 0, GMV_PARAMETERS * sizeof phi[0]);
    memset(one, 0, sizeof one);
    regressor(g, s, i, k, phi);
    if (m == 1)
        return target;
    for (unsigned d = 1; d < m; d++) {
        regressor(g, s, i, k + d, one);
        for (unsigned p = 0; p < n; p++)
            phi[p] = num_add(phi[p], one[p]);
        target = num_add(target, regressed(g, i, d));
    }
    for (unsigned p = 0; p < n; p++)
        phi[p] = num_mul(phi[p], share);
    return num_mul(target, share);
}

uint8_t gmv_learn(struct gmv *g, const struct gmv_sample *s, uint8_t learn)
{
    bool whole = g->steps > gmv_reach(&g->shape);
    for (unsigned i = 0; i < g->shape.loops; i++) {
        num_t phi[GMV_PARAMETERS];
        unsigned k = gmv_horizon(&g->shape, i);
        if (g->shape.nc)
            note_prediction(g, s, i);
        if (!whole)
            continue;
        num_t target = filtered_regression(g, s, i, phi);
        struct gmv_predicted *told = &g->predicted[i];
        told->measured = target;
        told->used = product_with(g, i, phi);
        told->standstill = g->shape.form == GMV_INCREMENTAL ? num_zero() : regressed(g, i, k);
        num_t error = rls_step(gmv_rls_of(g, i), phi, target, learn & (1u << i));
        told->estimated = num_sub(target, error);
        if (g->shape.bias == GMV_BIAS_RESIDUALS)
            g->residual[i].at[g->newest] = num_add(g->residual[i].at[g->newest],
                                                   num_mul(num_from_float(RESIDUAL_SHARE), error));
    }
    return (uint8_t)(whole ? (1u << g->shape.loops) - 1u : 0u);
}

struct gmv_predicted gmv_predicted(const struct gmv *g, unsigned i)
{
    return g->predicted[i];
}
