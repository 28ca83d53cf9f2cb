/* Monitor of the estimator: it reports temperatures that the model does not expect, and those that contradict each other. For this folder
 * alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_WATCH_H
#define REFLUX_COMPOSITION_COMPOSITION_WATCH_H

#include "kinds/composition/composition_sensors.h"

#if CONFIG_BLOCKS

struct composition_watch;

void composition_watch_set(struct composition_watch *w, const struct block_setup *setup);
/* Begins the means anew. */
void composition_watch_begin(struct composition_watch *w, const struct composition_sensors *all);
/* Waits until the means are filled again. */
void composition_watch_restart(struct composition_watch *w);
/* Takes the innovations of a step. */
void composition_watch_step(struct composition_watch *w, struct composition_sensors *all);
/* Returns the steps in the means. */
uint32_t composition_watch_steps(const struct composition_watch *w);

/* ---- numbers of inputs, or 0 ---- */

/* Returns the first sensor that draws the model by more than `most` K/h; none where that is 0. */
unsigned composition_watch_pulling(const struct composition_watch *w,
                                   const struct composition_sensors *all, real_t most);
/* Returns the first sensor whose squared innovations are larger than `most`; none where that is 0. to_one_side: or whose innovations
 * are off to one side for long. */
unsigned composition_watch_surprising(const struct composition_watch *w,
                                      const struct composition_sensors *all, real_t most,
                                      bool to_one_side);
/* Returns the sensor whose mean correction is farthest from the mean of its section, where they are more than `most` K/h apart; 0 where
 * fewer than two are in it. A wrong reading disagrees with those beside it; where all are wrong, or the feed is another, they agree. */
unsigned composition_watch_odd(const struct composition_watch *w,
                               const struct composition_sensors *all, size_t feed_stage,
                               real_t most);

/* Returns the ratio of innovations to those that the covariances predict, at least 1. */
real_t composition_watch_factor(const struct composition_watch *w,
                                const struct composition_sensors *all);

/* For the console. */
real_t composition_watch_pull(const struct composition_watch *w, unsigned k);
real_t composition_watch_square(const struct composition_watch *w, unsigned k);
real_t composition_watch_correlation(const struct composition_watch *w, unsigned k);

#endif
#endif
