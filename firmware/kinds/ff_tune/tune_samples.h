/* Samples of a block of the kind `ff_tune`: means over `period` of the measurements, of the setpoint and of what took effect of the MV. All of
 * them pass through the same high-pass. */
#ifndef REFLUX_FF_TUNE_TUNE_SAMPLES_H
#define REFLUX_FF_TUNE_TUNE_SAMPLES_H

#include "kinds/ff_tune/tune_results.h"
#include "kinds/ff_tune/tune_settings.h"

struct tune_samples;

/* Filters for these settings. */
void tune_samples_configure(struct tune_samples *s, const struct tune_context *c);
/* Forgets the past: the next sample is a first one. */
void tune_samples_begin(struct tune_samples *s);
/* Takes a step. move_square: mean square of the disturbance. Returns true when a sample is whole. */
bool tune_samples_take(struct tune_samples *s, const struct tune_context *c,
                       const struct block_io *io, real_t move_square);

/* The last sample behind the high-pass. */
real_t tune_sample(const struct tune_samples *s, enum tune_signal k);
/* Setpoint less measurement of it. */
real_t tune_sample_error(const struct tune_samples *s);
/* The same sample behind two lags more, for the models alone. */
num_t tune_sample_smooth(const struct tune_samples *s, enum tune_signal k);
/* Every reading of the last sample was good. */
bool tune_sample_is_good(const struct tune_samples *s);
/* Samples since the setpoint moved, since the disturbance moved much, since a reading was missing. */
uint16_t tune_since_setpoint(const struct tune_samples *s);
uint16_t tune_since_disturbance(const struct tune_samples *s);
uint16_t tune_since_bad(const struct tune_samples *s);

#endif
