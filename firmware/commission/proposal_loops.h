/* The pairs of a proposal and the loops of a configuration that are theirs: shared by the files of the proposal. Main loop. */
#ifndef REFLUX_COMMISSION_PROPOSAL_LOOPS_H
#define REFLUX_COMMISSION_PROPOSAL_LOOPS_H

#include "commission/tested_input.h"
#include "design/tuning.h"
#include "exchange/config.h"

struct commission;

/* The tested input of pair k. */
const struct tested_input *proposal_input(const struct commission *c, uint8_t k);
/* The names of pair k in *config. */
const char *proposal_measurement_name(const struct commission *c, const struct config *config,
                                      uint8_t k);
const char *proposal_output_name(const struct commission *c, const struct config *config,
                                 uint8_t k);
/* The name of the measurement of its inner loop; empty: it has none. */
const char *proposal_inner_name(const struct commission *c, const struct config *config, uint8_t k);

/* Loop of *config on measurement `pv` that drives `out`, or PLAN_NONE. */
uint8_t proposal_find_loop(const struct config *config, const char *pv, const char *out);
/* Loop of *config that is pair k, or PLAN_NONE. */
uint8_t proposal_loop(const struct commission *c, const struct config *config, uint8_t k);
/* Loop of *config that is the inner one of pair k, or PLAN_NONE; also where the pair is to have none. */
uint8_t proposal_inner_loop(const struct commission *c, const struct config *config, uint8_t k);

/* The loop at place i gets the name of its measurement; where that is taken, of its output as well. */
void proposal_name_loop(struct config *config, uint8_t i, const char *pv, const char *out);
/* Place i of the decoupler belongs to no other loop. */
void proposal_decouple_alone(struct config *config, uint8_t i);
/* Settings of the firmware for those of the design. */
struct loop_config proposal_settings(const struct tuning *t, real_t derivative_filter);

#endif
