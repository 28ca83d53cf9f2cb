/* The state behind experiment_proposals.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_PROPOSALS_STATE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_PROPOSALS_STATE_H

#include <stdbool.h>
#include <stdint.h>

struct experiment_proposals {
    /* The settings as they were when it proposed last: twice the values left, and `known`. */
    uint8_t proposed;
    bool proposes, waits;
};

#endif
