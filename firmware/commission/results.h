/* The next step after a finished fit or analysis: the test is repeated, the next input is tested, another round begins, or there is a
 * result. The phases COMMISSION_FITTING and COMMISSION_ANALYSING. Tick. */
#ifndef REFLUX_COMMISSION_RESULTS_H
#define REFLUX_COMMISSION_RESULTS_H

#include "supervise/supervisor.h"

struct commission;

/* The next input that is due, or the analysis. */
void commission_next_input(struct commission *c, struct supervisor *s);
/* A tick of waiting for a fit or for the analysis, and what comes of it. */
void commission_wait_for_job(struct commission *c, struct supervisor *s);

#endif
