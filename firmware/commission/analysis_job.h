/* The analysis (analysis.h) as a task of the background: it begins with the elements that the tests have found. Begins in the
 * tick; the pieces run in the main loop. */
#ifndef REFLUX_COMMISSION_ANALYSIS_JOB_H
#define REFLUX_COMMISSION_ANALYSIS_JOB_H

#include "exchange/config.h"
#include "num/real.h"

struct analysis_job;
struct commission;

/* The analysis takes the place of the last test in memory. Tick. */
void analysis_job_begin(struct commission *c, const struct config *config, real_t h_s);
/* A piece of it. True while there is more to do. Main loop. */
bool analysis_job_piece(struct commission *c);

#endif
