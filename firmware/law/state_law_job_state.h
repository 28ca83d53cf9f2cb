/* State of the job. It stands in a leased workspace. For its owner state_law_job.c and for who leases it. */
#ifndef REFLUX_LAW_STATE_LAW_JOB_STATE_H
#define REFLUX_LAW_STATE_LAW_JOB_STATE_H

#include "design/state_decoupler.h"
#include "law/state_law_found.h"

#if CONFIG_BLOCKS

enum state_law_phase {
    STATE_LAW_PHASE_SAMPLE,
    STATE_LAW_PHASE_DESIGN,
    STATE_LAW_PHASE_INPUTS, /* from states to inputs */
    STATE_LAW_PHASE_LOOP,   /* with the inputs alone */
    STATE_LAW_PHASE_OVER
};

struct state_law_job {
    uint8_t phase; /* enum state_law_phase */
    uint8_t inputs, loops;
    bool is_mv[BLOCK_INPUTS_MAX], of_stage[BLOCK_INPUTS_MAX];
    float left; /* %, allowed */
    /* Per second; states are what they are, inputs and outputs fractions of span. */
    struct state_model plant;
    /* the inputs that are states, by the plant's states; a row for each */
    struct matrix seen;
    struct state_model sampled;
    struct state_decoupler_goal goal;
    struct state_decoupler_config config;
    struct state_decoupler_work work;
    struct state_decoupler law;
    /* of the inputs that are states; F as these have it */
    struct matrix weights, from_inputs;
    struct state_law_found found;
};

#endif
#endif
