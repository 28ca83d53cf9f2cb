/* Blocks that automatic start-up proposes. */
#ifndef REFLUX_PLAN_PLAN_BLOCKS_H
#define REFLUX_PLAN_PLAN_BLOCKS_H

#include "exchange/plan.h"

/* Returns true if the compensator of this build accepts such a matrix for the first `loops` loops. */
bool plan_accepts_matrix(const float d[DECOUPLER_MAX][DECOUPLER_MAX], uint8_t loops);

#endif
