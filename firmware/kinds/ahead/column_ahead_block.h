/* The kind `ahead` as its files share it. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_BLOCK_H
#define REFLUX_AHEAD_COLUMN_AHEAD_BLOCK_H

#include "kinds/ahead/column_ahead_law.h"
#include "kinds/ahead/column_ahead_model.h"

#if CONFIG_BLOCKS

#define AHEAD_PARAMETERS 14
extern const struct block_parameter ahead_parameters[AHEAD_PARAMETERS];

/* What a signal is of the column: value in SI units = zero + span * fraction. */
struct ahead_place {
    real_t zero, span;
    uint8_t is;        /* enum ahead_input; of a PV AHEAD_TEMPERATURE or AHEAD_FRACTION */
    uint8_t stage;     /* from 0 */
    uint8_t component; /* from 0 */
};

struct ahead {
    struct ahead_model m;
    struct ahead_law law;
    struct ahead_place input[BLOCK_INPUTS_MAX], pv[AHEAD_LOOPS];
    const struct column_record *record;
    uint32_t checksum; /* of the table */
    uint8_t loops, inputs;
    uint8_t mv[AHEAD_LOOPS]; /* which input is the loop's */
    uint8_t basis;           /* enum ahead_basis */
    real_t keep;             /* part of a miss that is believed in a step */
    real_t trust;
    real_t pole[AHEAD_LOOPS];
    real_t far[AHEAD_LOOPS];    /* fraction of span; 0: none */
    real_t bias[AHEAD_LOOPS];   /* SI: PV less what the model has at its place */
    real_t missed[AHEAD_LOOPS]; /* SI, added to predictions */
    real_t said[AHEAD_LOOPS];   /* SI: the PV in the next step, as the last one predicted it */
    real_t before[AHEAD_LOOPS]; /* SI: the PV in the last step */
    real_t worse
        [AHEAD_LOOPS]; /* part of steps in which no change would have been the better prediction */
    real_t doubt;
    uint16_t watched;          /* steps in them; saturates */
    real_t apart[AHEAD_LOOPS]; /* fraction of span: MV in effect less the loop's output */
    num_t given[AHEAD_LOOPS];
    bool observed;   /* in this step, by follow */
    bool has_said;   /* there is a prediction */
    bool holds_next; /* the next step gives what is in effect: new settings */
};

static inline bool ahead_is_of_stage(uint8_t is)
{
    return is == AHEAD_TEMPERATURE || is == AHEAD_FRACTION;
}

MUST_CHECK enum err ahead_check(const struct block_setup *setup, struct block_fault *fault);
const char *ahead_describe(const void *state, size_t i, float *value);

/* ---- places (column_ahead_place.c) ---- */

/* What a signal of a stage is: K, or a mole fraction. */
real_t ahead_place_si(const struct ahead *b, const struct ahead_place *place, num_t fraction);
/* The PV of loop i by the model, at states x that were looked at last; SI. */
real_t ahead_target_of(const struct ahead *b, unsigned i, const real_t *x);
/* The column's inputs with the MVs of the loops where u[loops] has them, fractions of span. */
void ahead_drive_by(const struct ahead *b, const real_t *u, struct column_inputs *inputs);
/* Where the column is, an interval after the last time. */
MUST_CHECK enum err ahead_observe(struct ahead *b, const struct block_io *io);
/* The same, from wherever the model was. */
MUST_CHECK enum err ahead_find_column(struct ahead *b, const struct block_io *io);

#endif
#endif
