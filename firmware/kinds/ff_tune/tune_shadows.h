/* Two shadows on the same data: the loop without its feedforward, and with the candidate in its place. So a candidate is tested before it acts,
 * and one that acts is compared with feedback alone without being switched off. */
#ifndef REFLUX_FF_TUNE_TUNE_SHADOWS_H
#define REFLUX_FF_TUNE_TUNE_SHADOWS_H

#include "kinds/ff_tune/tune_results.h"
#include "kinds/ff_tune/tune_samples.h"

struct tune_shadows;

/* The shadows have this model from now on. */
void tune_shadows_take(struct tune_shadows *s, const struct tune_model *model);
/* The shadow without feedforward begins at rest; so does the other, at the disturbance d. */
void tune_shadows_begin(struct tune_shadows *s, const struct tune_context *c);
void tune_candidate_begin(struct tune_shadows *s, const struct tune_context *c, real_t d);
/* Takes a sample. candidate: NULL while none is tested. */
void tune_shadows_step(struct tune_shadows *s, const struct tune_context *c,
                       const struct tune_samples *samples,
                       const struct feedforward_shape *candidate);

const struct tune_errors *tune_shadows_errors(const struct tune_shadows *s);
const struct tune_model *tune_shadows_model(const struct tune_shadows *s);
/* Samples in which the closed loop forgets. */
uint32_t tune_forgets_in(const struct tune_shadows *s, const struct tune_context *c);
/* The candidate's shadow has forgotten that it began at rest. */
bool tune_candidate_is_warm(const struct tune_shadows *s, const struct tune_context *c);
/* The loop of the model is not stable, without feedforward or with the candidate. */
bool tune_shadow_is_lost(const struct tune_shadows *s);
bool tune_candidate_is_lost(const struct tune_shadows *s);

#endif
