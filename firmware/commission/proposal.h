/* The proposal as a configuration. */
#ifndef REFLUX_COMMISSION_PROPOSAL_H
#define REFLUX_COMMISSION_PROPOSAL_H

#include "commission/commission_state.h"

/* Writes the proposed loops and decoupler into *config, which holds the present configuration. Loops that drive a tested
 * manipulated variable, directly or through others, make room. ERR_STATE: there is no proposal; ERR_FULL: more loops
 * than there are places; ERR_CONFLICT: other channels or spans than those that were tested. */
MUST_CHECK enum err proposal_write(const struct commission *c, struct config *config);

/* Makes c->adoption ready for the loops of *config that are pairs of the proposal; main loop, before the trial is asked
 * for. ERR_UNKNOWN: a pair has no loop there; ERR_CONFLICT as above. */
MUST_CHECK enum err proposal_prepare_trial(struct commission *c, const struct supervisor *s,
                                           const struct config *config);

/* Loop of *config that is pair k of the proposal, or PLAN_NONE. */
uint8_t proposal_loop(const struct commission *c, const struct config *config, uint8_t k);

/* The proposal of a relay test into *config: the settings of its loop and nothing else. ERR_UNKNOWN: the loop is not
 * there any more, with its measurement and output. */
MUST_CHECK enum err by_relay_write(const struct commission *c, struct config *config);

#endif
