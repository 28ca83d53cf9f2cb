/* The kind `state_law` as its files share it. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_BLOCK_H
#define REFLUX_STATE_LAW_STATE_LAW_BLOCK_H

#include "kinds/state_law/state_law_job.h"

#if CONFIG_BLOCKS

/* In the order in which they come; the value of `stage`. */
enum state_law_stage {
    STATE_LAW_IDLE,
    STATE_LAW_ASKED, /* for the workspace */
    STATE_LAW_DESIGNS,
    STATE_LAW_DONE,
    STATE_LAW_REFUSED
};

struct state_law_block {
    struct state_law_settings s;
    struct block_signal input[BLOCK_INPUTS_MAX];
    uint8_t inputs, loops;
    uint8_t stage;
    uint8_t tells; /* enum state_law_event + 1, in the next step */
    const struct column_record *record;
    uint32_t checksum; /* of the table */
    uint32_t lease;
    struct state_law_job *job; /* in the workspace, while leased */
    float interval_s;
    struct state_law_found found;
    char refused[STATE_LAW_WORDS]; /* why */
    bool proposes, waits;
};

enum state_law_event { STATE_LAW_EVENT_MADE, STATE_LAW_EVENT_REFUSED, STATE_LAW_EVENTS };

#define STATE_LAW_PARAMETERS (12 + STATE_LAW_LOOPS * (STATE_LAW_LOOPS + STATE_FEEDBACK_INPUTS))
extern const struct block_parameter state_law_parameters[STATE_LAW_PARAMETERS];
MUST_CHECK enum err state_law_check(const struct block_setup *setup, struct block_fault *fault);

/* ---- proposals ---- */

void state_law_propose(struct state_law_block *b, struct block_proposal *room);

const char *state_law_describe(const void *state, size_t i, float *value);

#endif
#endif
