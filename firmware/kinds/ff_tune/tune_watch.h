/* The watch over an element of a block of the kind `ff_tune` that acts: decaying sums of squares tell whether the loop is worse than without it,
 * and whether it does what was promised. */
#ifndef REFLUX_FF_TUNE_TUNE_WATCH_H
#define REFLUX_FF_TUNE_TUNE_WATCH_H

#include "kinds/ff_tune/tune_test.h"

struct tune_watch;

/* The element has other numbers, or none. */
void tune_watch_begin(struct tune_watch *w);
/* Takes a sample; d: its disturbance, rests: d rests. TUNE_WORSE: switch it off. */
enum tune_verdict tune_watch_step(struct tune_watch *w, const struct tune_context *c,
                                  const struct tune_shadows *s, const struct tune_test *test,
                                  real_t d, bool rests);
/* The part that the element takes off the squares of the loop, %; 0 before anything is known. */
float tune_improvement(const struct tune_watch *w, const struct tune_context *c);
/* The loop is no better than it was under feedback alone. */
bool tune_is_as_alone(const struct tune_watch *w);
/* The element has done less than half of what was promised for long enough. */
bool tune_does_too_little(const struct tune_watch *w, const struct tune_context *c);

/* It does too little: counts a change where another one is allowed, and begins to count anew. Returns whether it is. */
bool tune_watch_change(struct tune_watch *w);
void tune_watch_forget_changes(struct tune_watch *w);

#endif
