/* Interaction of the proposed loops where they act: the relative gain of each pair at the frequency at which the gain of its own loop is
 * 1. At rest the loops may interact much, and little there, or the other way round. Main loop. */
#ifndef REFLUX_COMMISSION_ANALYSIS_CROSSOVER_H
#define REFLUX_COMMISSION_ANALYSIS_CROSSOVER_H

#include <stdint.h>

#include "base/error.h"

struct analysis;

/* Begins with pair k, which is below pairs.n. There are settings; work is overwritten. Then analysis_crossover_step() until it is not
 * ERR_BUSY: crossover and crossover_lambda of the pair are written then. */
void analysis_crossover_begin(struct analysis *a, uint8_t k);
MUST_CHECK enum err analysis_crossover_step(struct analysis *a, uint8_t k);

#endif
