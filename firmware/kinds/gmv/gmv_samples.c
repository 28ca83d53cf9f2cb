#include "kinds/gmv/gmv_samples.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/gmv/gmv_samples_state.h"
#include "num/real.h"

/* Folami (1989), 8.38. */
#define RESIDUAL_SHARE 0.8f

static num_t value_ago(const struct gmv_samples *m, const struct gmv_signal *s, unsigned steps)
{
    return s->value[(m->newest - steps) % GMV_KEPT];
}

static num_t term_ago(const struct gmv_samples *m, const struct gmv_signal *s, unsigned steps,
                      unsigned k)
{
    num_t value = value_ago(m, s, steps);
    return m->shape.form == GMV_INCREMENTAL ? num_sub(value, value_ago(m, s, steps + k)) : value;
}

num_t gmv_pv_term(const struct gmv_samples *m, unsigned i, unsigned steps, unsigned k)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return term_ago(m, &m->y[i], steps, k);
}

num_t gmv_disturbance_term(const struct gmv_samples *m, unsigned n, unsigned steps, unsigned k)
{
    REFLUX_ASSERT(n < GMV_DISTURBANCES);
    return term_ago(m, &m->disturbance[n], steps, k);
}

num_t gmv_prediction_ago(const struct gmv_samples *m, unsigned i, unsigned steps)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return value_ago(m, &m->prediction[i], steps);
}

num_t gmv_residual_ago(const struct gmv_samples *m, unsigned i, unsigned steps)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return value_ago(m, &m->residual[i], steps);
}

num_t gmv_applied(const struct gmv_sample *s, unsigned j, unsigned steps)
{
    REFLUX_ASSERT(j < GMV_LOOPS && s->applied[j]);
    return applied_steps_ago(s->applied[j], steps, s->divisor);
}

num_t gmv_applied_term(const struct gmv_samples *m, const struct gmv_sample *s, unsigned j,
                       unsigned steps, unsigned k)
{
    num_t value = gmv_applied(s, j, steps);
    return m->shape.form == GMV_INCREMENTAL ? num_sub(value, gmv_applied(s, j, steps + k)) : value;
}

bool gmv_samples_complete(const struct gmv_samples *m)
{
    return m->steps > gmv_reach(&m->shape);
}

struct gmv_filter gmv_samples_filter(const struct gmv_samples *m, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return (struct gmv_filter){m->p[i], m->p_scale[i], m->weighs_setpoint[i]};
}

/* ---- regressions ---- */

void gmv_regressor(const struct gmv_samples *m, const struct gmv_sample *s, unsigned i,
                   unsigned steps, num_t *phi)
{
    REFLUX_ASSERT(i < m->shape.loops && gmv_parameters(&m->shape, i) <= GMV_PARAMETERS);
    const struct gmv_shape *shape = &m->shape;
    unsigned k = gmv_horizon(shape, i);
    for (unsigned a = 0; a < shape->na; a++)
        phi[a] = gmv_pv_term(m, i, steps + a, k);
    for (unsigned j = 0; j < shape->loops; j++) {
        int place = gmv_place_of_u(shape, i, j);
        for (unsigned b = 0; b < shape->nb && place >= 0; b++)
            phi[(unsigned)place + b] =
                gmv_applied_term(m, s, j, steps + gmv_behind(shape, i, j) + b, k);
    }
    phi += shape->na;
    for (unsigned j = 0; j < shape->loops; j++)
        phi += shape->delay[i][j] ? shape->nb : 0u;
    for (unsigned n = 0; n < shape->disturbances; n++)
        *phi++ = gmv_disturbance_term(m, n, steps + shape->disturbance_delay, k);
    for (unsigned c = 1; c <= shape->nc; c++)
        *phi++ = gmv_prediction_ago(m, i, steps + c);
    if (gmv_place_of_bias(shape, i) >= 0)
        *phi = shape->bias == GMV_BIAS_ONE ? num_one() : gmv_residual_ago(m, i, steps);
}

/* P of loop i, of a signal with the value `before` a step earlier. */
static num_t weighed(const struct gmv_samples *m, unsigned i, num_t value, num_t before)
{
    return num_mul(m->p_scale[i], num_sub(value, num_mul(m->p[i], before)));
}

/* P y as the form takes y; in the explicit way the regression has no P. */
static num_t regressed(const struct gmv_samples *m, unsigned i, unsigned steps)
{
    unsigned k = gmv_horizon(&m->shape, i);
    num_t value = gmv_pv_term(m, i, steps, k);
    if (m->shape.way == GMV_EXPLICIT)
        return value;
    return weighed(m, i, value, gmv_pv_term(m, i, steps + 1u, k));
}

num_t gmv_standstill(const struct gmv_samples *m, unsigned i)
{
    return m->shape.form == GMV_INCREMENTAL ? num_zero()
                                            : regressed(m, i, gmv_horizon(&m->shape, i));
}

unsigned gmv_regression(const struct gmv_samples *m, const struct gmv_sample *s, unsigned i,
                        num_t *phi, num_t *target)
{
    unsigned n = gmv_parameters(&m->shape, i), steps = m->shape.average,
             k = gmv_horizon(&m->shape, i);
    num_t one[GMV_PARAMETERS], share = num_from_float(1.0f / (float)steps),
                               sum = regressed(m, i, 0);
    memset(phi, 0, GMV_PARAMETERS * sizeof phi[0]);
    memset(one, 0, sizeof one);
    gmv_regressor(m, s, i, k, phi);
    *target = sum;
    if (steps == 1)
        return n;
    for (unsigned d = 1; d < steps; d++) {
        gmv_regressor(m, s, i, k + d, one);
        for (unsigned p = 0; p < n; p++)
            phi[p] = num_add(phi[p], one[p]);
        sum = num_add(sum, regressed(m, i, d));
    }
    for (unsigned p = 0; p < n; p++)
        phi[p] = num_mul(phi[p], share);
    *target = num_mul(sum, share);
    return n;
}

num_t gmv_weighed_pv(const struct gmv_samples *m, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return weighed(m, i, value_ago(m, &m->y[i], 0), value_ago(m, &m->y[i], 1));
}

num_t gmv_weighed_setpoint(const struct gmv_samples *m, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return m->weighs_setpoint[i] ? weighed(m, i, m->w[i], m->w_before[i])
                                 : accumulator_get(&m->setpoint[i]);
}

/* ---- a sample ---- */

static void fill_signal(struct gmv_signal *s, num_t value)
{
    for (unsigned k = 0; k < GMV_KEPT; k++)
        s->value[k] = value;
}

/* Takes the plant to have been at rest here before the first sample; nothing is learnt from that. */
static void fill_samples(struct gmv_samples *m, const struct gmv_sample *s)
{
    for (unsigned i = 0; i < m->shape.loops; i++) {
        fill_signal(&m->y[i], s->y[i]);
        fill_signal(&m->prediction[i], num_zero());
        fill_signal(&m->residual[i], num_zero());
        accumulator_set(&m->setpoint[i], s->w[i]);
        m->w[i] = s->w[i];
    }
    for (unsigned n = 0; n < m->shape.disturbances; n++)
        fill_signal(&m->disturbance[n], s->disturbance[n]);
}

void gmv_samples_take(struct gmv_samples *m, const struct gmv_sample *s)
{
    REFLUX_ASSERT(m->shape.loops <= GMV_LOOPS && m->shape.disturbances <= GMV_DISTURBANCES);
    if (m->steps == 0)
        fill_samples(m, s);
    m->newest = (uint8_t)((m->newest + 1u) % GMV_KEPT);
    m->steps += m->steps < UINT32_MAX;
    for (unsigned i = 0; i < m->shape.loops; i++) {
        num_t away = num_sub(s->w[i], accumulator_get(&m->setpoint[i]));
        m->y[i].value[m->newest] = s->y[i];
        m->w_before[i] = m->w[i];
        m->w[i] = s->w[i];
        accumulator_add_product(&m->setpoint[i], m->r_share[i], away);
        m->prediction[i].value[m->newest] = num_zero();
        m->residual[i].value[m->newest] = gmv_residual_ago(m, i, 1);
    }
    for (unsigned n = 0; n < m->shape.disturbances; n++)
        m->disturbance[n].value[m->newest] = s->disturbance[n];
}

void gmv_keep_prediction(struct gmv_samples *m, unsigned i, num_t prediction)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    m->prediction[i].value[(m->newest - 1u) % GMV_KEPT] = prediction;
}

void gmv_add_residual(struct gmv_samples *m, unsigned i, num_t error)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    num_t *residual = &m->residual[i].value[m->newest];
    if (m->shape.bias == GMV_BIAS_RESIDUALS)
        *residual = num_add(*residual, num_mul(num_from_float(RESIDUAL_SHARE), error));
}

/* ---- settings ---- */

static float decay_per_step(float tau_s, float interval_s)
{
    return tau_s > 0 ? real_exp(-interval_s / tau_s) : 0;
}

void gmv_samples_configure(struct gmv_samples *m, const struct gmv_config *c)
{
    m->shape = c->shape;
    for (unsigned i = 0; i < c->shape.loops; i++) {
        float p = decay_per_step(c->tau_p_s[i], c->interval_s);
        m->p[i] = num_from_float(p);
        m->p_scale[i] = num_from_float(1 / (1 - p));
        m->weighs_setpoint[i] = c->tau_r_s[i] < 0;
        m->r_share[i] = coefficient_from_float(1 - decay_per_step(c->tau_r_s[i], c->interval_s));
    }
}
