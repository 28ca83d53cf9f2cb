/* What the structure of the plant adds to the single loops of a proposal: inner loops of cascades, and feedforwards from one
 * manipulated variable to another. Parts of proposal.c. */
#ifndef REFLUX_COMMISSION_PROPOSAL_STRUCTURE_H
#define REFLUX_COMMISSION_PROPOSAL_STRUCTURE_H

#include "commission/analysis_structure.h"
#include "commission/commission_state.h"

/* Loop of *config on measurement `pv` that drives `out`, or PLAN_NONE. */
uint8_t proposal_find_loop(const struct config *config, const char *pv, const char *out);
/* Loop of *config that is the inner one of pair k, or PLAN_NONE; also where the pair is to have none. */
uint8_t proposal_inner_loop(const struct commission *c, const struct config *config, uint8_t k);

/* Adds them to *config, in which pair k has loop place[k]. ERR_FULL: more loops than there are places. Feedforwards that find
 * none are left out, the weakest first. */
MUST_CHECK enum err proposal_add_structure(const struct commission *c, struct config *config,
                                           const uint8_t *place);

/* The inner loops behind the n pairs of c->adoption, and setpoint steps no larger than they can follow. ERR_UNKNOWN: *config
 * has not all of them. */
MUST_CHECK enum err proposal_prepare_inner(struct commission *c, const struct supervisor *s,
                                           const struct config *config);

/* The names of pair k in *config. */
const char *proposal_measurement_name(const struct commission *c, const struct config *config,
                                      uint8_t k);
const char *proposal_output_name(const struct commission *c, const struct config *config,
                                 uint8_t k);
/* ... of its inner loop's measurement; empty: it has none. */
const char *proposal_inner_name(const struct commission *c, const struct config *config, uint8_t k);
/* The loop at place i gets the name of its measurement; where that is taken, of its output as well. */
void proposal_name_loop(struct config *config, uint8_t i, const char *pv, const char *out);
/* Place i of the decoupler belongs to no other loop. */
void proposal_decouple_alone(struct config *config, uint8_t i);
/* Settings of the firmware for those of the design. */
struct loop_config proposal_settings(const struct tuning *t, real_t derivative_filter);

#endif
