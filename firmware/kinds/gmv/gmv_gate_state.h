#ifndef REFLUX_GMV_GMV_GATE_STATE_H
#define REFLUX_GMV_GMV_GATE_STATE_H

#include "base/assertion.h"
#include "kinds/gmv/gmv_gate.h"

struct gmv_gate {
    /* The operator has frozen learning. */
    bool frozen;
    bool is_quiet[GMV_LOOPS];
    /* Steps without a move; steps until no bad reading is among the regressors. */
    uint32_t still_steps[GMV_LOOPS], spoilt_steps[GMV_LOOPS];
    /* Mean information of a sample. */
    float information[GMV_LOOPS];
};

static inline void gmv_gate_freeze(struct gmv_gate *g)
{
    g->frozen = true;
}

/* A bad reading is among the regressors of loop i. */
static inline bool gmv_gate_spoilt(const struct gmv_gate *g, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return g->spoilt_steps[i] != 0;
}

/* Mean information of a sample of each loop. */
static inline const float *gmv_gate_information(const struct gmv_gate *g)
{
    return g->information;
}

#endif
