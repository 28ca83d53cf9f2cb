/* The state of a block of the kind `state_law`. For its owner state_law_kind.c and for tests. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_BLOCK_H
#define REFLUX_STATE_LAW_STATE_LAW_BLOCK_H

#include "kinds/column/column.h"
#include "law/state_law_found.h"

#if CONFIG_BLOCKS

/* In the order in which they come; the value of `stage`. */
enum state_law_stage {
    STATE_LAW_IDLE,
    STATE_LAW_ASKED, /* for the workspace */
    STATE_LAW_DESIGNS,
    STATE_LAW_DONE,
    STATE_LAW_REFUSED
};

enum state_law_event { STATE_LAW_EVENT_MADE, STATE_LAW_EVENT_REFUSED, STATE_LAW_EVENTS };

struct state_law_column;

struct state_law_block {
    struct state_law_settings s;
    struct block_signal input[BLOCK_INPUTS_MAX];
    uint8_t inputs, loops;
    uint8_t stage; /* enum state_law_stage */
    uint8_t event; /* enum state_law_event + 1, raised in the next step; 0: none */
    const struct column_record *record;
    uint32_t checksum; /* of the table */
    uint32_t lease;
    struct state_law_column *job; /* in the workspace, while leased */
    float interval_s;
    struct state_law_found found;
    char refused[STATE_LAW_WORDS]; /* the reason */
    bool proposes, waits;
};

#endif
#endif
