/* The disturbance of a block of the kind `ff_tune`: its mean square of late, and whether it rests. */
#ifndef REFLUX_FF_TUNE_TUNE_DISTURBANCE_H
#define REFLUX_FF_TUNE_TUNE_DISTURBANCE_H

#include "kinds/ff_tune/tune_settings.h"

struct tune_disturbance;

/* Nothing has moved yet. */
void tune_disturbance_begin(struct tune_disturbance *d);
/* Takes the disturbance of a sample, behind the high-pass. Called once for each sample. */
void tune_disturbance_look(struct tune_disturbance *d, const struct tune_context *c, real_t x);
/* An element was found with a disturbance of that mean square. */
void tune_disturbance_learnt(struct tune_disturbance *d, real_t square);

/* Samples since it moved last; 0: it moves. */
uint32_t tune_disturbance_still(const struct tune_disturbance *d);
/* Mean square of late, in any stage. */
real_t tune_disturbance_square(const struct tune_disturbance *d);
/* Mean square of a reading when the disturbance rested last. */
real_t tune_disturbance_noise(const struct tune_disturbance *d);

/* A mean square so small that nothing moves. */
bool tune_stands_still(real_t square);

#endif
