/* The kind `ahead` as its files share it. Within control. */
#ifndef REFLUX_CONTROL_COLUMN_AHEAD_BLOCK_H
#define REFLUX_CONTROL_COLUMN_AHEAD_BLOCK_H

#include "control/column_ahead_law.h"
#include "control/column_ahead_model.h"

#if CONFIG_BLOCKS

#define AHEAD_PARAMETERS 13
extern const struct block_parameter ahead_parameters[AHEAD_PARAMETERS];

struct ahead {
    struct ahead_model m;
    struct ahead_settings s;
    struct block_signal pv[AHEAD_LOOPS], input[BLOCK_INPUTS_MAX];
    struct ahead_law law;
    uint32_t checksum; /* of the table */
    const struct column_record *record;
    uint8_t loops, inputs;
    real_t keep; /* part of a miss that is believed in a step */
    real_t pole[AHEAD_LOOPS];
    real_t span[AHEAD_LOOPS];   /* of the PV, SI; of the sign of its factor */
    real_t bias[AHEAD_LOOPS];   /* SI: PV less what the model has at its place */
    real_t missed[AHEAD_LOOPS]; /* SI, added to predictions */
    real_t said[AHEAD_LOOPS];   /* SI: the PV in the next step, as the last one predicted it */
    real_t apart[AHEAD_LOOPS];  /* fraction of span: MV in effect less the loop's output */
    num_t given[AHEAD_LOOPS];
    bool observed;   /* in this step, by follow */
    bool has_said;   /* there is a prediction */
    bool holds_next; /* the next step gives what is in effect: new settings */
};

MUST_CHECK enum err ahead_check(const struct block_setup *setup, struct block_fault *fault);
const char *ahead_describe(const void *state, size_t i, float *value);

#endif
#endif
