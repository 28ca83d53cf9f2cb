/* A law that was found becomes settings by a proposal: only the values that change. */
#ifndef REFLUX_LAW_STATE_LAW_PROPOSAL_H
#define REFLUX_LAW_STATE_LAW_PROPOSAL_H

#include "block/proposal.h"
#include "law/state_law_found.h"

#if CONFIG_BLOCKS

/* Puts the values in which `wanted` differs from the law in `settings`, made_s included. block: index of the one with the law,
 * PROPOSED_SELF of its own. */
void state_law_put_values(const struct state_law_settings *settings,
                          const struct state_law_found *wanted, float made_s, unsigned loops,
                          uint8_t block, struct block_proposal *room);

#endif
#endif
