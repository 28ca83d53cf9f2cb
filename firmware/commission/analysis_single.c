#include "commission/analysis_single.h"

#include <stddef.h>
#include <string.h>

void analysis_single_loop(struct analysis *a, const struct tuning *tuning, real_t step,
                          const struct trial_loop *predicted, real_t horizon_s)
{
    memset(a, 0, offsetof(struct analysis, work));
    a->stage = ANALYSIS_DONE;
    a->config.step = step;
    a->plant.outputs = a->plant.inputs = 1;
    a->verdict = PAIRING_DETERMINED;
    a->probability = REAL_C(1.0);
    a->pairs.n = 1;
    a->loops.pairs = a->pairs;
    a->loops.tuning[0] = *tuning;
    a->loops.derivative_filter = REAL_C(8.0);
    a->decoupler = DECOUPLER_NOT_NEEDED;
    a->predicted[0] = *predicted;
    a->tried[0].iae = predicted->iae;
    a->tried[0].moved[0] = predicted->moved;
    a->horizon_s = horizon_s;
    a->designed = true;
}
