/* The gains of complete innovation, found between ticks: the covariance of all mole fractions, and of what nobody measures of the feed, is
 * carried over a cycle, Frau (7.5), and every temperature and analysis that was there is worked in, one after the other. It stands in
 * the board's workspace, which is leased for as long as the filter runs; without it the last gains go on, and before there are any
 * each temperature moves its own mole fraction (METHOD_REKF). For this folder alone.
 *
 * The tick hands over an order and takes the result in a declared tick; in between it leaves the workspace alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_JOB_H
#define REFLUX_COMPOSITION_COMPOSITION_JOB_H

#include "base/workspace.h"
#include "kinds/composition/composition_block.h"

#if CONFIG_BLOCKS

/* Numbers that the state needs behind its struct: gains, and the factors of a linear model. 0 for other methods. */
size_t composition_numbers(const struct block_setup *setup);
/* Bytes of the workspace that an enum composition_covariance takes. */
uint32_t composition_job_bytes(unsigned covariance, size_t stages, size_t m, size_t extras);

/* A step is over: asks for the next gains where there is something to find. Returns the steps after which they are taken, 0: none. */
uint8_t composition_order(struct composition_block *b);
/* The declared step: the job's result. */
void composition_take_gains(struct composition_block *b);
/* A piece of the job; true while there is more. Main loop. */
bool composition_job_piece(struct composition_block *b);
/* The next order begins with what is known before any reading; what was ordered says nothing of the estimate any more. */
void composition_begin_filter(struct composition_block *b);
/* Gains of a steady state are looked for again. */
void composition_forget_steady(struct composition_block *b);
/* The state is about to be another. */
void composition_end_lease(struct composition_block *b);
/* In every step. */
void composition_keep_lease(struct composition_block *b, bool working);
/* Whether complete innovation says itself that its points are not to be relied on: a feed that is not to be expected, no gains yet. */
bool composition_is_unsure(const struct composition_block *b);
/* It ought to have the workspace and has not. */
bool composition_lacks_workspace(const struct composition_block *b);
/* What another has the workspace for, or NULL. */
const char *composition_workspace_holder(void);

#endif
#endif
