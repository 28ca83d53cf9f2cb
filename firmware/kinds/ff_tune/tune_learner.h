/* The learner of a block of the kind `ff_tune`: feeds the estimator with samples, and measures how much moves meanwhile. The estimator stands
 * behind the state of the block, and is given with every call. */
#ifndef REFLUX_FF_TUNE_TUNE_LEARNER_H
#define REFLUX_FF_TUNE_TUNE_LEARNER_H

#include "kinds/ff_tune/tune_samples.h"

struct tune_learner;

/* The estimator begins with the model of a stage. */
void tune_learner_begin(struct tune_learner *l, const struct tune_context *c,
                        struct high_order *estimator, bool of_loop);
/* Learns from the last sample. locked: the work reads the estimator, which therefore learns nothing. */
void tune_learner_step(struct tune_learner *l, const struct tune_context *c,
                       const struct tune_samples *s, struct high_order *estimator, bool of_loop,
                       bool locked);

/* The estimator has learnt from the last sample. */
bool tune_learner_learns(const struct tune_learner *l);
/* Mean squares since the stage began: of the disturbance, of what moves the loop. */
real_t tune_learner_move_square(const struct tune_learner *l);
real_t tune_learner_loop_square(const struct tune_learner *l);
/* Samples since the responses were last asked for. */
uint32_t tune_learner_since_look(const struct tune_learner *l);
void tune_learner_looked(struct tune_learner *l);

#endif
