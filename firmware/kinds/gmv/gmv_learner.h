/* Learner of the self-tuner: an estimator for each loop, and how well the last predictions did. */
#ifndef REFLUX_GMV_GMV_LEARNER_H
#define REFLUX_GMV_GMV_LEARNER_H

#include "kinds/gmv/gmv_config.h"
#include "kinds/gmv/gmv_sample.h"

struct gmv_learner;
struct gmv_samples;

/* Bytes of all estimators of a shape. */
uint32_t gmv_learner_bytes(const struct gmv_shape *shape);
/* Places the estimators behind the learner, the first one `offset` bytes from its beginning, and gives them settings. theta: start
 * values of a loop. */
uint32_t gmv_learner_init(struct gmv_learner *l, const struct gmv_config *c, unsigned i,
                          const num_t *theta, uint32_t offset);
void gmv_learner_retune(struct gmv_learner *l, const struct gmv_config *c);
/* Estimates are theta, the covariance is p0. */
void gmv_learner_start_again(struct gmv_learner *l, unsigned i, const num_t *theta);

/* Takes a step of loop i whose regression is complete. used: its parameters in use. learns: its estimator may learn from the step. */
void gmv_learner_step(struct gmv_learner *l, struct gmv_samples *m, const struct gmv_sample *s,
                      unsigned i, const num_t *used, bool learns);
/* Keeps what the estimator predicted a step ago, where past predictions are among the terms. */
void gmv_learner_keep_prediction(const struct gmv_learner *l, struct gmv_samples *m,
                                 const struct gmv_sample *s, unsigned i);

#endif
