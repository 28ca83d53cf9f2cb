/* Proposals of a block of the kind `ff_tune`: its candidate for the element, or a gain of 0. The same numbers are settings of the block, so that it
 * knows what the element has. */
#ifndef REFLUX_FF_TUNE_TUNE_PROPOSALS_H
#define REFLUX_FF_TUNE_TUNE_PROPOSALS_H

#include "kinds/ff_tune/feedforward_search.h"
#include "kinds/ff_tune/tune_settings.h"
#include "kinds/ff_tune/tune_stage.h"

struct tune_proposals;

/* A stage begins: its proposal has not been handed over. */
void tune_proposals_begin(struct tune_proposals *p);
/* The block begins without a past. */
void tune_proposals_forget(struct tune_proposals *p);
/* Switches the element off, whatever the stage. */
void tune_silence(struct tune_proposals *p);
bool tune_is_silencing(const struct tune_proposals *p);
/* A gain of 0 was proposed, and nobody has decided on it. */
bool tune_off_waits(const struct tune_proposals *p);

/* In every step. rests: samples since the disturbance moved much. Returns false when the proposal of this stage was refused, or rejected. */
bool tune_propose(struct tune_proposals *p, const struct tune_context *c, struct block_io *io,
                  enum tune_stage stage, const struct feedforward_shape *candidate, uint16_t rests);

#endif
