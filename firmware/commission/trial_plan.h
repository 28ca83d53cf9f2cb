/* The trial of a proposal, planned: its measurements, its loops and their setpoint steps. Main loop, before the trial is asked for. */
#ifndef REFLUX_COMMISSION_TRIAL_PLAN_H
#define REFLUX_COMMISSION_TRIAL_PLAN_H

#include "supervise/supervisor.h"

struct commission;

/* Makes the adoption ready for the loops of *config that are pairs of the proposal. ERR_UNKNOWN: a pair has no loop there;
 * ERR_CONFLICT: other channels or spans than those that were tested. */
MUST_CHECK enum err proposal_prepare_trial(struct commission *c, const struct supervisor *s,
                                           const struct config *config);

#endif
