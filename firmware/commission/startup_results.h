/* Tells which results of start-up there are. Main loop; the tick asks only for the proposal. */
#ifndef REFLUX_COMMISSION_STARTUP_RESULTS_H
#define REFLUX_COMMISSION_STARTUP_RESULTS_H

#include <stdbool.h>

struct commission;

/* There is a proposal. */
bool commission_has_proposal(const struct commission *c);
/* Tests, model and analysis are still in the workspace, and will be until the main loop next asks for something. If not, they are
 * gone or may be overwritten while somebody reads them. */
bool commission_keeps(const struct commission *c);
/* Among them is a result of the analysis or of a relay test. */
bool commission_has_results(const struct commission *c);
/* There was such a result, and what is outside the workspace belongs to it. */
bool commission_had_results(const struct commission *c);

#endif
