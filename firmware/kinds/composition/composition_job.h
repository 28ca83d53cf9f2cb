/* The job that computes the gains of complete innovation between ticks, in pieces: the covariance of all mole fractions, and of what
 * nobody measures of the feed, is carried over a cycle, Frau (7.5), and every temperature and analysis that was present is worked in,
 * one after the other. The tick gives an order and takes the result; in between it leaves the job alone. For this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_JOB_H
#define REFLUX_COMPOSITION_COMPOSITION_JOB_H

#include "kinds/composition/composition_parts.h"

#if CONFIG_BLOCKS

struct composition_job;

/* Returns the bytes of the workspace for an enum composition_covariance. */
uint32_t composition_job_bytes(unsigned covariance, size_t stages, size_t m, size_t extras);

/* Makes a job without an order in the workspace. */
struct composition_job *composition_job_make(void *memory, const struct composition_model *model);

/* Gives an order, where the last one is done or `begins`. steps: of a cycle; begins: with what is known before any reading. Returns the
 * analyses that the job works in, bit i for analysis i, and by how much they were off in surprise[]. */
bool composition_job_order(struct composition_job *job, const struct composition_parts *p,
                           uint8_t steps, bool begins, real_t *surprise, uint8_t *analysed);

/* Does a piece; true while there is more. Main loop. */
bool composition_job_piece(struct composition_job *job, const struct composition_parts *p);

/* ---- the result ---- */

bool composition_job_is_done(const struct composition_job *job);
enum err composition_job_err(const struct composition_job *job);
/* Returns the gains [sensors][composition_model_length()]; behind them those of the analyses. */
const real_t *composition_job_gains(const struct composition_job *job);
/* Returns the expected variances [sensors], K2. */
const real_t *composition_job_spread(const struct composition_job *job);
const struct composition_certainty *composition_job_certainty(const struct composition_job *job);

#endif
#endif
