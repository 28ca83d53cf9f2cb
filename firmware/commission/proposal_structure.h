/* Additions to the single loops of a proposal by the structure of the plant: inner loops of cascades, and feedforwards from one
 * manipulated variable to another. Main loop. */
#ifndef REFLUX_COMMISSION_PROPOSAL_STRUCTURE_H
#define REFLUX_COMMISSION_PROPOSAL_STRUCTURE_H

#include "base/error.h"
#include "exchange/config.h"

struct commission;

/* Adds them to *config, in which pair k has loop place[k]. ERR_FULL: more loops than there are places. Feedforwards that find
 * none are left out, the weakest first. */
MUST_CHECK enum err proposal_add_structure(const struct commission *c, struct config *config,
                                           const uint8_t *place);

#endif
