#include "kinds/gmv/gmv_learner.h"

#include "base/assertion.h"
#include "kinds/gmv/gmv_learner_state.h"
#include "kinds/gmv/gmv_samples.h"

static struct rls *estimator(struct gmv_learner *l, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return (struct rls *)(void *)((char *)l + l->rls_offset[i]);
}

/* ---- settings ---- */

uint32_t gmv_learner_bytes(const struct gmv_shape *shape)
{
    uint32_t bytes = 0;
    for (unsigned i = 0; i < shape->loops; i++)
        bytes += rls_bytes(gmv_parameters(shape, i));
    return bytes;
}

uint32_t gmv_learner_init(struct gmv_learner *l, const struct gmv_config *c, unsigned i,
                          const num_t *theta, uint32_t offset)
{
    float p0[GMV_PARAMETERS];
    struct rls_settings s = gmv_rls_settings(c, i, p0);
    l->rls_offset[i] = offset;
    rls_init(estimator(l, i), &s, theta);
    return offset + rls_bytes(s.n);
}

void gmv_learner_retune(struct gmv_learner *l, const struct gmv_config *c)
{
    float p0[GMV_PARAMETERS];
    for (unsigned i = 0; i < c->shape.loops; i++) {
        struct rls_settings s = gmv_rls_settings(c, i, p0);
        rls_retune(estimator(l, i), &s);
    }
}

void gmv_learner_start_again(struct gmv_learner *l, unsigned i, const num_t *theta)
{
    rls_set(estimator(l, i), theta);
    rls_reset(estimator(l, i));
}

/* ---- a step ---- */

void gmv_learner_keep_prediction(const struct gmv_learner *l, struct gmv_samples *m,
                                 const struct gmv_sample *s, unsigned i)
{
    num_t phi[GMV_PARAMETERS];
    gmv_regressor(m, s, i, 1, phi);
    gmv_keep_prediction(m, i, rls_predict(gmv_learner_rls(l, i), phi));
}

static num_t product_with(const num_t *theta, const num_t *phi, unsigned n)
{
    num_wide_t sum = num_wide_zero();
    for (unsigned p = 0; p < n; p++)
        sum = num_wide_add(sum, theta[p], phi[p]);
    return num_from_wide(sum);
}

void gmv_learner_step(struct gmv_learner *l, struct gmv_samples *m, const struct gmv_sample *s,
                      unsigned i, const num_t *used, bool learns)
{
    struct gmv_predicted *predicted = &l->predicted[i];
    num_t phi[GMV_PARAMETERS], target;
    unsigned n = gmv_regression(m, s, i, phi, &target);
    predicted->measured = target;
    predicted->used = product_with(used, phi, n);
    predicted->standstill = gmv_standstill(m, i);
    num_t error = rls_step(estimator(l, i), phi, target, learns);
    predicted->estimated = num_sub(target, error);
    gmv_add_residual(m, i, error);
}
