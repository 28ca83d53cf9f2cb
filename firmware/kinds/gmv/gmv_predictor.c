#include "kinds/gmv/gmv_predictor.h"

#include "base/assertion.h"
#include "kinds/gmv/gmv_samples.h"

static num_t coefficient_of_p(const struct gmv_filter *filter, unsigned power)
{
    if (power > 1)
        return num_zero();
    return power == 0 ? filter->p_scale : num_neg(num_mul(filter->p, filter->p_scale));
}

/* Disturbances, past predictions and bias, each times its parameter and `sum`. */
static num_t known_rest(const struct gmv_shape *shape, const struct gmv_samples *m, unsigned i,
                        const num_t *theta, num_t sum)
{
    unsigned k = shape->delay[i][i];
    int disturbance = gmv_place_of_disturbance(shape, i), noise = gmv_place_of_noise(shape, i),
        bias = gmv_place_of_bias(shape, i);
    num_wide_t rest = num_wide_zero();
    for (unsigned n = 0; n < shape->disturbances; n++)
        rest = num_wide_add(rest, theta[(unsigned)disturbance + n],
                            gmv_disturbance_term(m, n, shape->disturbance_delay, k));
    for (unsigned c = 0; c < shape->nc && shape->way == GMV_IMPLICIT; c++)
        rest = num_wide_add(rest, theta[(unsigned)noise + c], gmv_prediction_ago(m, i, 1u + c));
    if (bias >= 0)
        rest = num_wide_add(rest, theta[bias],
                            shape->bias == GMV_BIAS_ONE ? num_one() : gmv_residual_ago(m, i, 0));
    return num_mul(num_from_wide(rest), sum);
}

static void predict_implicit(struct gmv_predictor *p, const struct gmv_shape *shape,
                             const struct gmv_samples *m, unsigned i, const num_t *theta)
{
    for (unsigned a = 0; a < shape->na; a++)
        p->f[a] = theta[a];
    for (unsigned j = 0; j < shape->loops; j++) {
        int place = gmv_place_of_u(shape, i, j);
        p->behind[j] = place >= 0 ? gmv_behind(shape, i, j) : 0;
        for (unsigned b = 0; b < shape->nb; b++)
            p->g[j][b] = place >= 0 ? theta[(unsigned)place + b] : num_zero();
    }
    p->rest = known_rest(shape, m, i, theta, num_one());
}

/* Returns the next coefficient of E, or of F: P less E A at that power. theta[0..na) are -a_1, ..., -a_na. */
static num_t lacking(const struct gmv_filter *filter, const num_t *theta, unsigned na,
                     const num_t *e, unsigned terms, unsigned power)
{
    num_wide_t sum = num_wide_add(num_wide_zero(), coefficient_of_p(filter, power), num_one());
    for (unsigned l = 0; l < terms && l < power; l++)
        if (power - l <= na)
            sum = num_wide_add(sum, e[l], theta[power - l - 1u]);
    return num_from_wide(sum);
}

static void predict_explicit(struct gmv_predictor *p, const struct gmv_shape *shape,
                             const struct gmv_samples *m, unsigned i, const num_t *theta)
{
    unsigned k = shape->delay[i][i];
    struct gmv_filter filter = gmv_samples_filter(m, i);
    num_t e[GMV_DELAY_MAX], sum = num_zero();
    for (unsigned l = 0; l < k; l++) {
        e[l] = lacking(&filter, theta, shape->na, e, l, l);
        sum = num_add(sum, e[l]);
    }
    for (unsigned a = 0; a < shape->na; a++)
        p->f[a] = lacking(&filter, theta, shape->na, e, k, k + a);
    p->ng = shape->nb + k - 1u;
    for (unsigned j = 0; j < shape->loops; j++) {
        int place = gmv_place_of_u(shape, i, j);
        p->behind[j] = place >= 0 ? (unsigned)shape->delay[i][j] - k : 0;
        for (unsigned b = 0; b < p->ng; b++) {
            num_wide_t product = num_wide_zero();
            for (unsigned l = 0; l < k && place >= 0; l++)
                if (b >= l && b - l < shape->nb)
                    product = num_wide_add(product, e[l], theta[(unsigned)place + b - l]);
            p->g[j][b] = num_from_wide(product);
        }
    }
    p->rest = known_rest(shape, m, i, theta, sum);
}

void gmv_predictor_fill(struct gmv_predictor *p, const struct gmv_shape *shape,
                        const struct gmv_samples *m, unsigned i, const num_t *theta)
{
    REFLUX_ASSERT(i < shape->loops && shape->na <= GMV_TERMS_MAX && shape->nb <= GMV_TERMS_MAX &&
                  shape->delay[i][i] <= GMV_DELAY_MAX);
    p->nf = shape->na;
    p->ng = shape->nb;
    if (shape->way == GMV_EXPLICIT)
        predict_explicit(p, shape, m, i, theta);
    else
        predict_implicit(p, shape, m, i, theta);
}
