/* Generalised minimum variance self-tuning of one loop or two: samples, regressions and control law, without supervision
 * (kinds/gmv/gmv_kind.c has that). Equations and sources: docs/methods/self-tuning.md.
 *
 * A step of the block:  gmv_take (measurements)  ->  gmv_learn (one regression per loop)  ->  gmv_solve (the MVs).
 * All signals are num_t fractions of span. The applied values of the MVs are looked up in their histories.
 *
 * gmv.c has the law, over two parts: gmv_samples.c and gmv_learner.c. */
#ifndef REFLUX_GMV_GMV_H
#define REFLUX_GMV_GMV_H

#include "kinds/gmv/gmv_config.h"
#include "kinds/gmv/gmv_sample.h"

/* Lives in the caller's memory, aligned for everything; may be moved between calls. */
struct gmv;
struct gmv_predictor;

uint32_t gmv_bytes(const struct gmv_shape *shape);
/* Settings that gmv_check accepts. Starts without a past. */
void gmv_init(struct gmv *g, const struct gmv_config *c);
/* New settings with the same gmv_bytes, loops and terms: samples, estimates and parameters in use go on. */
void gmv_retune(struct gmv *g, const struct gmv_config *c);
const struct gmv_shape *gmv_shape(const struct gmv *g);
/* Starts the samples anew (estimates stay): before the first step, and after a gap. */
void gmv_begin(struct gmv *g);

void gmv_take(struct gmv *g, const struct gmv_sample *s);
/* Bit i of `learn`: loop i's estimator may learn from this step. Returns the loops whose regression was complete, a bit each: their
 * errors are of this step. */
uint8_t gmv_learn(struct gmv *g, const struct gmv_sample *s, uint8_t learn);

/* The law with the parameters in use. acting: a bit for each member that is free; the MVs of the others stay at `fixed`. u: of every
 * member. */
struct gmv_range {
    num_t lo[GMV_LOOPS], hi[GMV_LOOPS], fixed[GMV_LOOPS];
};
enum gmv_solved {
    GMV_SOLVED,
    /* The determinant was too small. */
    GMV_ONE_BY_ONE,
    /* u is unchanged. */
    GMV_NO_NUMBER
};
enum gmv_solved gmv_solve(struct gmv *g, const struct gmv_sample *s, uint8_t acting,
                          const struct gmv_range *range, num_t *u);

/* Parameters in use: gmv_solve takes these. */
num_t gmv_used(const struct gmv *g, unsigned i, unsigned p);
void gmv_use(struct gmv *g, unsigned i, unsigned p, num_t value);
/* Starts estimates and parameters in use again from theta, with the covariance p0. */
void gmv_start_again(struct gmv *g, const float theta[GMV_LOOPS][GMV_PARAMETERS]);
/* Prediction of loop i with the parameters in use (kinds/gmv/gmv_predictor.h). */
void gmv_predict(const struct gmv *g, unsigned i, struct gmv_predictor *p);
/* g_ii,0 of the law with the parameters in use. */
float gmv_own_gain(const struct gmv *g, unsigned i);
/* Loop i's weight in use. */
num_t gmv_lambda(const struct gmv *g, unsigned i);
void gmv_set_lambda(struct gmv *g, unsigned i, num_t lambda);
num_t gmv_determinant(const struct gmv *g);

/* Filters of loop i. */
struct gmv_filter gmv_filter(const struct gmv *g, unsigned i);

/* Loop i's estimator. */
const struct rls *gmv_rls(const struct gmv *g, unsigned i);
/* g_ii,0 as it is estimated. */
float gmv_estimated_gain(const struct gmv *g, unsigned i);
/* Returns whether the estimated g_ii,0 differs from 0 by as many standard deviations, and loop i's parameters of the PV are known to 1
 * within as many. */
bool gmv_is_excited(const struct gmv *g, unsigned i, float deviations);
/* Puts loop i's estimates in use. */
void gmv_use_estimates(struct gmv *g, unsigned i);
/* Moves loop i's parameters in use towards the estimates, each by `speed` times its size, or times `least`, at most. */
void gmv_approach_estimates(struct gmv *g, unsigned i, num_t speed, num_t least);
/* Predictions of the last gmv_learn with a complete regression. */
struct gmv_predicted gmv_predicted(const struct gmv *g, unsigned i);

#endif
