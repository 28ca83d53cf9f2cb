/* Samples of the self-tuner: signals as they look back, the filters P and R, and the regressions made of them.
 * docs/methods/self-tuning.md, Model. */
#ifndef REFLUX_GMV_GMV_SAMPLES_H
#define REFLUX_GMV_GMV_SAMPLES_H

#include "kinds/gmv/gmv_config.h"
#include "kinds/gmv/gmv_sample.h"

struct gmv_samples;

/* Settings: all of them, or new ones for the same loops and terms. */
void gmv_samples_configure(struct gmv_samples *m, const struct gmv_config *c);
void gmv_samples_take(struct gmv_samples *m, const struct gmv_sample *s);
/* There are as many samples as a regression reaches back. */
bool gmv_samples_complete(const struct gmv_samples *m);
struct gmv_filter gmv_samples_filter(const struct gmv_samples *m, unsigned i);

/* Values `steps` steps ago, 0 being the last sample; in the incremental form their changes over `k` steps. */
num_t gmv_pv_term(const struct gmv_samples *m, unsigned i, unsigned steps, unsigned k);
num_t gmv_disturbance_term(const struct gmv_samples *m, unsigned n, unsigned steps, unsigned k);
/* The same of the applied MV j, steps from 1 on. */
num_t gmv_applied_term(const struct gmv_samples *m, const struct gmv_sample *s, unsigned j,
                       unsigned steps, unsigned k);
/* The applied MV j itself. */
num_t gmv_applied(const struct gmv_sample *s, unsigned j, unsigned steps);
num_t gmv_prediction_ago(const struct gmv_samples *m, unsigned i, unsigned steps);
num_t gmv_residual_ago(const struct gmv_samples *m, unsigned i, unsigned steps);

/* R w and P y of the last sample. */
num_t gmv_weighed_setpoint(const struct gmv_samples *m, unsigned i);
num_t gmv_weighed_pv(const struct gmv_samples *m, unsigned i);

/* phi_i(t - steps), steps from 1 on: all of its MVs have been applied. */
void gmv_regressor(const struct gmv_samples *m, const struct gmv_sample *s, unsigned i,
                   unsigned steps, num_t *phi);
/* phi_i(t - horizon) and its target, averaged over the data filter. Returns the number of parameters. */
unsigned gmv_regression(const struct gmv_samples *m, const struct gmv_sample *s, unsigned i,
                        num_t *phi, num_t *target);
/* Target of the regression as it was a horizon ago; 0 in the incremental form. */
num_t gmv_standstill(const struct gmv_samples *m, unsigned i);
/* Keeps the prediction made a step ago; adds the share of an error to the residual of this step, where the bias is made of residuals. */
void gmv_keep_prediction(struct gmv_samples *m, unsigned i, num_t prediction);
void gmv_add_residual(struct gmv_samples *m, unsigned i, num_t error);

#endif
