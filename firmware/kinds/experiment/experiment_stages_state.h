/* The state behind experiment_stages.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_STAGES_STATE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_STAGES_STATE_H

#include <stdbool.h>
#include <stdint.h>

struct experiment_stages {
    /* Pieces of work until the next step. */
    uint16_t pieces;
    uint8_t stage, reason, verdict, at_fault;
    /* It asked for the test signal in the last step. */
    bool asked_signal;
    /* enum experiment_event + 1, of this step */
    uint8_t event;
};

#endif
