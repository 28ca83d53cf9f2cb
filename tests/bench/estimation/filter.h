/* A Kalman filter of the bench's column (column.h) as the kind `composition` runs it: ticks, and between them the job that finds gains. For
 * the image and for the host. */
#ifndef REFLUX_BENCH_FILTER_H
#define REFLUX_BENCH_FILTER_H

#include "kinds/composition/composition_job_state.h"

/* Makes the filter of a splitter. extras: 0; 2, where nobody measures the feed's composition; 3, nor its flow. The workspace is the caller's. False: there is
 * no such filter, or no room for it. */
bool filter_begin(size_t stages, enum composition_method method,
                  enum composition_covariance covariance, size_t extras, void *memory,
                  uint32_t bytes);

/* Does the block's work of a tick: takes gains where they are there, makes the step to t, asks for the next ones. */
enum err filter_tick(const float *t);
/* A piece of the job; true while there is more. */
bool filter_piece(void);
/* All of them. */
void filter_job(void);

/* enum composition_phase that the next piece does something of; PHASE_DONE before the first order. */
unsigned filter_phase(void);
/* It has its gains, and they are those of the last order. */
bool filter_is_well(void);
uint32_t filter_state_bytes(void);
uint32_t filter_workspace_bytes(void);

extern struct composition_block *const filter_block;

#endif
