/* Interaction of the proposed loops where they act: the relative gain of each pair at the frequency at which the gain of its own loop is
 * 1. At rest the loops may interact much, and little there, or the other way round. Main loop. */
#ifndef REFLUX_COMMISSION_ANALYSIS_CROSSOVER_H
#define REFLUX_COMMISSION_ANALYSIS_CROSSOVER_H

#include <stdint.h>

struct analysis;

/* Writes crossover and crossover_lambda of pair k, which is below pairs.n. There are settings; work is overwritten. */
void analysis_find_crossover(struct analysis *a, uint8_t k);

#endif
