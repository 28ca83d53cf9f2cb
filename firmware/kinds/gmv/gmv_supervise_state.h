#ifndef REFLUX_GMV_GMV_SUPERVISE_STATE_H
#define REFLUX_GMV_GMV_SUPERVISE_STATE_H

#include "kinds/gmv/gmv_gate_state.h"
#include "kinds/gmv/gmv_monitors_state.h"
#include "kinds/gmv/gmv_supervise.h"

struct gmv_supervise {
    struct gmv_status status;
    /* The operator has asked to adopt. */
    bool adopt_asked;
    /* The last trial is of this window. */
    bool has_outcome;
    /* Loops whose models have passed, a bit each. */
    uint8_t tested_loops;
    /* Number of entries of return_step. */
    uint8_t returns;
    struct gmv_supervise_config config;
    /* Steps in this state. */
    uint32_t elapsed;
    /* The window of a test or a check: steps still to go; steps for which a test has waited for setpoints to rest. */
    uint32_t steps_left, overtime;
    uint32_t samples[GMV_LOOPS];
    /* Sums of squares of the prediction errors. */
    float model_squares[GMV_LOOPS], standstill_squares[GMV_LOOPS];
    /* All steps; those of the last returns to the PI. */
    uint32_t steps, return_step[GMV_TRIES_MOST];
    struct gmv_gate gate;
    struct gmv_monitors monitors;
};

static inline const struct gmv_status *gmv_supervise_status(const struct gmv_supervise *s)
{
    return &s->status;
}

static inline const struct gmv_supervise_config *
gmv_supervise_settings(const struct gmv_supervise *s)
{
    return &s->config;
}

/* Records of the PIs, one for each loop. */
static inline const struct gmv_record *gmv_supervise_records(const struct gmv_supervise *s)
{
    return gmv_monitors_records(&s->monitors);
}

/* The operator's verb: freezes learning. */
static inline void gmv_supervise_freeze(struct gmv_supervise *s)
{
    gmv_gate_freeze(&s->gate);
}

/* The next judgement asks whether the parameters are known well enough. */
static inline bool gmv_supervise_needs_excitation(const struct gmv_supervise *s)
{
    return s->status.state == GMV_TUNING && !s->status.testing &&
           s->elapsed + 1u >= s->config.tune_steps;
}

/* The operator's verb: lets frozen and quiet loops learn. */
static inline void gmv_supervise_thaw(struct gmv_supervise *s)
{
    gmv_gate_thaw(&s->gate);
}

/* Mean information of a sample of each loop. */
static inline const float *gmv_supervise_information(const struct gmv_supervise *s)
{
    return gmv_gate_information(&s->gate);
}

#endif
