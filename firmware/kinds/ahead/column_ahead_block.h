/* The state of a block of the kind `ahead`, allocated here. For column_ahead_kind.c alone, and for tests. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_BLOCK_H
#define REFLUX_AHEAD_COLUMN_AHEAD_BLOCK_H

#include "kinds/ahead/column_ahead_law_state.h"
#include "kinds/ahead/column_ahead_model_state.h"
#include "kinds/ahead/column_ahead_place_state.h"

#if CONFIG_BLOCKS

struct ahead {
    struct ahead_model m;
    struct ahead_law law;
    struct ahead_places places;
    const struct column_record *record;
    uint32_t checksum; /* of the table */
    real_t keep;       /* part of a miss that is believed in a step */
    real_t trust;
    real_t pole[AHEAD_LOOPS];
    real_t alarm[AHEAD_LOOPS];     /* fraction of span; 0: none */
    real_t bias[AHEAD_LOOPS];      /* SI: PV less what the model has at its place */
    real_t missed[AHEAD_LOOPS];    /* SI, added to predictions */
    real_t predicted[AHEAD_LOOPS]; /* SI: the PV in the next step */
    real_t before[AHEAD_LOOPS];    /* SI: the PV in the last step */
    /* part of steps in which no change would have been the better prediction */
    real_t worse[AHEAD_LOOPS];
    real_t doubt;
    uint16_t watched;           /* steps in them; saturates */
    real_t offset[AHEAD_LOOPS]; /* fraction of span: MV in effect less the loop's output */
    num_t given[AHEAD_LOOPS];
    bool observed;       /* in this step, by follow */
    bool has_prediction; /* of the next step */
    bool holds_next;     /* the next step gives what is in effect: new settings */
};

#endif
#endif
