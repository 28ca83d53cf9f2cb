/* What a loop's parameters say of P y a horizon ahead: as they are in the implicit way, by the Diophantine equation
 * P = E A + z^-k F from A and B in the explicit way (Folami 1989, 8.25). */
#include "kinds/gmv/gmv_inside.h"

static num_t coefficient_of_p(const struct gmv *g, unsigned i, unsigned at)
{
    if (at > 1)
        return num_zero();
    return at == 0 ? g->p_scale[i] : num_neg(num_mul(g->p[i], g->p_scale[i]));
}

/* Disturbances, past predictions and bias, each times its parameter and `sum`. */
static num_t known_rest(const struct gmv *g, unsigned i, num_t sum)
{
    const struct gmv_shape *shape = &g->shape;
    unsigned k = shape->delay[i][i];
    int disturbance = gmv_place_of_disturbance(shape, i), noise = gmv_place_of_noise(shape, i),
        bias = gmv_place_of_bias(shape, i);
    num_wide_t rest = num_wide_zero();
    for (unsigned m = 0; m < shape->disturbances; m++)
        rest = num_wide_add(rest, g->used[i][(unsigned)disturbance + m],
                            gmv_taken(g, &g->disturbance[m], shape->disturbance_delay, k));
    for (unsigned c = 0; c < shape->nc && shape->way == GMV_IMPLICIT; c++)
        rest = num_wide_add(rest, g->used[i][(unsigned)noise + c],
                            gmv_ago(g, &g->prediction[i], 1u + c));
    if (bias >= 0)
        rest =
            num_wide_add(rest, g->used[i][bias],
                         shape->bias == GMV_BIAS_ONE ? num_one() : gmv_ago(g, &g->residual[i], 0));
    return num_mul(num_from_wide(rest), sum);
}

static void predict_implicit(const struct gmv *g, unsigned i, struct gmv_predictor *p)
{
    const struct gmv_shape *shape = &g->shape;
    for (unsigned a = 0; a < shape->na; a++)
        p->f[a] = g->used[i][a];
    for (unsigned j = 0; j < shape->loops; j++) {
        int place = gmv_place_of_u(shape, i, j);
        p->behind[j] = place >= 0 ? gmv_behind(shape, i, j) : 0;
        for (unsigned b = 0; b < shape->nb; b++)
            p->g[j][b] = place >= 0 ? g->used[i][(unsigned)place + b] : num_zero();
    }
    p->rest = known_rest(g, i, num_one());
}

/* The next coefficient of E, or of F: what P still lacks at that power. used[0..na) are -a_1, ..., -a_na. */
static num_t lacking(const struct gmv *g, unsigned i, const num_t *e, unsigned terms, unsigned at)
{
    num_wide_t sum = num_wide_add(num_wide_zero(), coefficient_of_p(g, i, at), num_one());
    for (unsigned l = 0; l < terms && l < at; l++)
        if (at - l <= g->shape.na)
            sum = num_wide_add(sum, e[l], g->used[i][at - l - 1u]);
    return num_from_wide(sum);
}

static void predict_explicit(const struct gmv *g, unsigned i, struct gmv_predictor *p)
{
    const struct gmv_shape *shape = &g->shape;
    unsigned k = shape->delay[i][i];
    num_t e[GMV_DELAY_MAX], sum = num_zero();
    for (unsigned l = 0; l < k; l++) {
        e[l] = lacking(g, i, e, l, l);
        sum = num_add(sum, e[l]);
    }
    for (unsigned a = 0; a < shape->na; a++)
        p->f[a] = lacking(g, i, e, k, k + a);
    p->ng = shape->nb + k - 1u;
    for (unsigned j = 0; j < shape->loops; j++) {
        int place = gmv_place_of_u(shape, i, j);
        p->behind[j] = place >= 0 ? (unsigned)shape->delay[i][j] - k : 0;
        for (unsigned b = 0; b < p->ng; b++) {
            num_wide_t product = num_wide_zero();
            for (unsigned l = 0; l < k && place >= 0; l++)
                if (b >= l && b - l < shape->nb)
                    product = num_wide_add(product, e[l], g->used[i][(unsigned)place + b - l]);
            p->g[j][b] = num_from_wide(product);
        }
    }
    p->rest = known_rest(g, i, sum);
}

void gmv_predict(const struct gmv *g, unsigned i, struct gmv_predictor *p)
{
    p->nf = g->shape.na;
    p->ng = g->shape.nb;
    if (g->shape.way == GMV_EXPLICIT)
        predict_explicit(g, i, p);
    else
        predict_implicit(g, i, p);
}
