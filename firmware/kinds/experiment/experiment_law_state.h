/* The state behind experiment_law.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_LAW_STATE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_LAW_STATE_H

#include "kinds/experiment/experiment_lease_state.h"
#include "law/state_law_found.h"

enum experiment_law_stage {
    EXPERIMENT_LAW_NONE,
    /* waits for the workspace */
    EXPERIMENT_LAW_ASKED,
    EXPERIMENT_LAW_WORKS,
    EXPERIMENT_LAW_DONE,
    EXPERIMENT_LAW_REFUSED
};

struct experiment_law {
    /* The settings of the block that keeps the law, but for what is found, when the job began. */
    uint8_t goal[offsetof(struct state_law_settings, si)];
    /* enum experiment_law_stage */
    uint8_t stage;
    bool proposes, waits;
    struct experiment_lease lease;
    struct state_law_found found;
    char words[STATE_LAW_WORDS];
};

#endif
