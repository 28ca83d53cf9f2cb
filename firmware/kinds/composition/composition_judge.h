/* Quality of the estimates, and the events of the kind. For this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_JUDGE_H
#define REFLUX_COMPOSITION_COMPOSITION_JUDGE_H

#include "base/channel.h"
#include "kinds/composition/composition_parts.h"

#if CONFIG_BLOCKS

enum {
    EVENT_LOST,
    EVENT_ALONE,
    EVENT_PULL,
    EVENT_NIS,
    EVENT_APART,
    EVENT_NO_STATE,
    EVENT_NO_INPUT,
    EVENT_NO_BOIL,
    COMPOSITION_EVENTS
};

void composition_judge_begin(struct composition_judge *j);
/* Waits until the estimate has settled again. */
void composition_judge_restart(struct composition_judge *j);
/* number: of the first missing input that is no temperature, or 0. */
void composition_judge_put_missing(struct composition_judge *j, unsigned number);

/* True: the estimate has had the time to find its plant. */
bool composition_judge_is_settled(const struct composition_parts *p);
/* Counts a step. A section that was not seen for a while is found again as slowly as it was lost, at most as slowly as in the
 * beginning. */
void composition_judge_count(const struct composition_parts *p, bool failed);
/* True: a temperature draws in this step; it is remembered. */
bool composition_judge_sees(const struct composition_parts *p);
/* Raises the events, and returns the quality of the estimates. err: of the step. */
enum quality composition_judge_step(const struct composition_parts *p, struct block_io *io,
                                    enum err err);
/* An analysis is late or rejected; input: its number. */
void composition_judge_put_analysis(const struct composition_parts *p, struct block_io *io,
                                    unsigned input);

/* True: nothing in the section of point k moves the model or is compared by an analysis. */
bool composition_judge_is_unseen(const struct composition_parts *p, unsigned k);
/* Complete innovation: returns the standard deviation of point k, corrected by the innovations and with the model's
 * lasting error. */
real_t composition_judge_sd(const struct composition_parts *p, unsigned k);
/* True: it is too large. */
bool composition_judge_is_unsure(const struct composition_parts *p, unsigned k);

#endif
#endif
