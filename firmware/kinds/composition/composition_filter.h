/* Complete innovation as the tick sees it: the lease of the workspace for kinds/composition/composition_job.h, orders and results. The
 * lease lasts for as long as the filter runs; without it the last gains go on, and before there are any each temperature moves its
 * own mole fraction (METHOD_REKF). For this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_FILTER_H
#define REFLUX_COMPOSITION_COMPOSITION_FILTER_H

#include "kinds/composition/composition_job.h"

#if CONFIG_BLOCKS

/* ---- in the tick ---- */

/* The state may have been moved: sets the gains' place anew. */
void composition_filter_relocate(struct composition_filter *f, const real_t *gains);
/* The next order begins with what is known before any reading; the result of the last order is dropped. */
void composition_filter_begin(struct composition_filter *f);
/* Gains of a steady state are computed again. */
void composition_filter_forget_steady(struct composition_filter *f);
/* New settings: the same, and of a steady state the covariance too. */
void composition_filter_retune(struct composition_filter *f,
                               const struct composition_settings *settings);
/* Ends the lease, since the state is about to be another. */
void composition_filter_end(struct composition_filter *f);
/* Keeps the lease, in every step. */
void composition_filter_keep(const struct composition_parts *p, bool working);
/* A step is over: asks for the next gains. Returns the steps after which they are taken, 0: none. */
uint8_t composition_filter_order(const struct composition_parts *p);
/* Takes the job's result, in the declared step. */
void composition_filter_take(const struct composition_parts *p);
/* Gives the workspace up; takes it again. The latter returns who has it, or NULL. */
void composition_filter_decline(struct composition_filter *f);
const char *composition_filter_resume(struct composition_filter *f);

/* ---- main loop ---- */

/* Does a piece of the job; true while there is more. */
bool composition_filter_work(const struct composition_parts *p);

/* ---- what it has ---- */

/* NULL: none yet */
const real_t *composition_filter_gain(const struct composition_filter *f);
/* Returns the standard deviation of point k, as the covariance has it. */
real_t composition_filter_sd(const struct composition_filter *f, unsigned k);
/* True: it finds the corrections of analyses. */
bool composition_filter_takes_analyses(const struct composition_filter *f);
/* True: points are not to be relied on, because the feed is not to be expected, or there are no gains yet. */
bool composition_filter_is_unsure(const struct composition_parts *p);
/* True: it ought to have the workspace and has not. */
bool composition_filter_lacks_workspace(const struct composition_parts *p);
/* Value i of those for the console and its name; NULL: there are no more. */
#define COMPOSITION_FILTER_VALUES 4
const char *composition_filter_describe(const struct composition_filter *f, size_t i, float *value);

#endif
#endif
