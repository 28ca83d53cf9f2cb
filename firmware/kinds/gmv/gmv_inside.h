/* What the files of the self-tuner share: its state, and its data as they look back. */
#ifndef REFLUX_GMV_GMV_INSIDE_H
#define REFLUX_GMV_GMV_INSIDE_H

#include "kinds/gmv/gmv.h"

/* Steps that are kept of a signal: horizon, terms, difference and data filter, one after the other, are 8 + 4 + 8 + 7 at
 * most, and one more for P. A power of two. */
#define GMV_KEPT 32u

struct gmv_signal {
    num_t at[GMV_KEPT];
};

struct gmv {
    struct gmv_shape shape;
    uint32_t steps;  /* since the data began */
    uint32_t newest; /* place in the signals, below GMV_KEPT */
    struct gmv_signal y[GMV_LOOPS], disturbance[GMV_DISTURBANCES];
    struct gmv_signal residual[GMV_LOOPS];   /* m_i */
    struct gmv_signal prediction[GMV_LOOPS]; /* made at that time */
    num_t p[GMV_LOOPS], p_scale[GMV_LOOPS];  /* p and 1/(1 - p) */
    struct coefficient r_share[GMV_LOOPS];   /* 1 - r */
    struct accumulator setpoint[GMV_LOOPS];  /* R w, of R with a time constant */
    bool weighs_setpoint[GMV_LOOPS];         /* R is P */
    num_t w[GMV_LOOPS], w_before[GMV_LOOPS]; /* of the last two gmv_take */
    num_t lambda[GMV_LOOPS], determinant;
    num_t used[GMV_LOOPS][GMV_PARAMETERS];
    struct gmv_predicted predicted[GMV_LOOPS];
    uint32_t rls_at[GMV_LOOPS]; /* bytes from the beginning of this */
};

/* A signal `steps` steps ago, 0 being the last gmv_take. */
static inline num_t gmv_ago(const struct gmv *g, const struct gmv_signal *s, unsigned steps)
{
    return s->at[(g->newest - steps) % GMV_KEPT];
}

/* The same, or in the incremental form its change over `k` steps. */
num_t gmv_taken(const struct gmv *g, const struct gmv_signal *s, unsigned steps, unsigned k);
/* What was applied of MV j `steps` steps ago, 1 and more. */
num_t gmv_applied(const struct gmv_sample *s, unsigned j, unsigned steps);
num_t gmv_applied_taken(const struct gmv *g, const struct gmv_sample *s, unsigned j, unsigned steps,
                        unsigned k);
/* Horizon of loop i's regression: its delay, or 1 in the explicit way. */
unsigned gmv_horizon(const struct gmv_shape *shape, unsigned i);
/* From u_j's entry in phi(t) to its first one, steps: k_ij - k_i; in the explicit way k_ij - 1. */
unsigned gmv_behind(const struct gmv_shape *shape, unsigned i, unsigned j);

/* P y(t) = what is known + sum over j and b of g[j][b] u_j(t - behind_j - b), b from 0, everything as it is in the form. */
struct gmv_predictor {
    unsigned nf, ng, behind[GMV_LOOPS];
    num_t f[GMV_TERMS_MAX];
    num_t g[GMV_LOOPS][GMV_TERMS_MAX + GMV_DELAY_MAX];
    num_t rest; /* disturbances, past predictions, bias: already multiplied */
};
/* Of loop i with the parameters in use. */
void gmv_predict(const struct gmv *g, unsigned i, struct gmv_predictor *p);

#endif
