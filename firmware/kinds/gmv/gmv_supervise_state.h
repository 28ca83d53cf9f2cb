#ifndef REFLUX_GMV_GMV_SUPERVISE_STATE_H
#define REFLUX_GMV_GMV_SUPERVISE_STATE_H

#include "kinds/gmv/gmv_burst_state.h"
#include "kinds/gmv/gmv_cycle_state.h"
#include "kinds/gmv/gmv_record_state.h"
#include "kinds/gmv/gmv_supervise.h"

struct gmv_supervise {
    struct gmv_supervise_config config;
    struct gmv_status status;
    /* The operator has frozen learning; has asked to adopt. */
    bool frozen, adopt_asked;
    /* Loops whose models have passed, a bit each. */
    uint8_t tested;
    /* Number of entries of given_up_step. */
    uint8_t given_up;
    bool is_quiet[GMV_LOOPS];
    /* The last trial is of this window. */
    bool has_outcome;
    /* Steps in this state. */
    uint32_t elapsed;
    /* Steps for which the estimated g_ii,0 has been wrong. */
    uint32_t wrong[GMV_LOOPS];
    /* Steps without a move; steps until no bad reading is among the regressors. */
    uint32_t still[GMV_LOOPS], spoilt[GMV_LOOPS];
    /* The window of a test or a check: steps still to go; steps for which a test has waited for setpoints to rest. */
    uint32_t left, overtime;
    uint32_t samples[GMV_LOOPS];
    /* Sums of squares of the prediction errors. */
    float model_squares[GMV_LOOPS], standstill_squares[GMV_LOOPS];
    struct gmv_burst burst[GMV_LOOPS];
    struct gmv_cycle cycle[GMV_LOOPS];
    struct gmv_record record[GMV_LOOPS];
    /* Steps for which an MV has been pushed against a limit that its loop needs it to leave. */
    uint32_t jammed[GMV_LOOPS];
    /* All steps; those of the last returns to the PI. */
    uint32_t steps, given_up_step[GMV_TRIES_MOST];
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
    return s->record;
}

/* The operator's verb: freezes learning. */
static inline void gmv_supervise_freeze(struct gmv_supervise *s)
{
    s->frozen = true;
}

/* The next judgement asks whether the parameters are known well enough. */
static inline bool gmv_supervise_needs_excitation(const struct gmv_supervise *s)
{
    return s->status.state == GMV_TUNING && !s->status.testing &&
           s->elapsed + 1u >= s->config.tune_steps;
}

#endif
