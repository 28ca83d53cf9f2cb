/* The proposal as a configuration. Main loop. */
#ifndef REFLUX_COMMISSION_PROPOSAL_H
#define REFLUX_COMMISSION_PROPOSAL_H

#include "base/error.h"
#include "exchange/config.h"

struct commission;

/* Writes the proposed loops and decoupler into *config, which holds the present configuration. Loops that drive a tested
 * manipulated variable, directly or through others, make room. Of a relay test it writes the settings of its loop and nothing
 * else. ERR_STATE: there is no proposal; ERR_FULL: more loops than there are places; ERR_CONFLICT: other channels or spans than
 * those that were tested; ERR_UNKNOWN: the loop of a relay test is gone, or has another measurement or output. */
MUST_CHECK enum err proposal_write(const struct commission *c, struct config *config);

#endif
