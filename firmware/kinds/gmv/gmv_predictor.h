/* Prediction of P y a horizon ahead, as the parameters of a loop have it: directly in the implicit way, by the Diophantine equation
 * P = E A + z^-k F from A and B in the explicit way (Folami 1989, 8.25). */
#ifndef REFLUX_GMV_GMV_PREDICTOR_H
#define REFLUX_GMV_GMV_PREDICTOR_H

#include "kinds/gmv/gmv_shape.h"
#include "num/num.h"

struct gmv_samples;

/* P y(t) = known + sum over j and b of g[j][b] u_j(t - behind_j - b), b from 0, every signal as it is in the form. */
struct gmv_predictor {
    unsigned nf, ng, behind[GMV_LOOPS];
    num_t f[GMV_TERMS_MAX];
    num_t g[GMV_LOOPS][GMV_TERMS_MAX + GMV_DELAY_MAX];
    /* Disturbances, past predictions and bias, multiplied. */
    num_t rest;
};

/* theta: parameters of loop i. */
void gmv_predictor_fill(struct gmv_predictor *p, const struct gmv_shape *shape,
                        const struct gmv_samples *m, unsigned i, const num_t *theta);

#endif
