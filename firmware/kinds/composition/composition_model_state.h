/* State of the estimator's model. For its owner composition_model.c and for composition_block.h, which allocates it. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_MODEL_STATE_H
#define REFLUX_COMPOSITION_COMPOSITION_MODEL_STATE_H

#include "kinds/column/column.h"
#include "kinds/composition/covariance.h"
#include "model/column_implicit.h"

#if CONFIG_BLOCKS

/* A model that is linear around the profile and the inputs of the table. */
struct composition_linear {
    struct column_transition transition;
    /* [feed's extras][mole fractions]: rates by each extra of the feed, 1/s */
    real_t *push;
    /* s, of its steps; 0: not made yet */
    real_t h;
};

struct composition_model {
    struct column_table table;
    struct column column;
    struct column_inputs inputs;
    bool truncated[COLUMN_STAGES_MAX];
    real_t x[COLUMN_STATES_MAX], rates[COLUMN_STATES_MAX];
    struct column_blocks blocks;
    /* METHOD_KALMAN */
    struct composition_linear linear;
    /* Extra states (kinds/composition/covariance.h): the feed's mole fractions, as many as are integrated, the part by which the feed's
     * flow is larger than given, and the model's offset at the place of each analysis. */
    real_t extra[COVARIANCE_EXTRAS_MAX];
    /* s, of a step */
    real_t h;
    /* mole fractions kept within limits in the last step */
    uint16_t clipped;
    /* times the profile was taken again because there was no solution; saturates */
    uint16_t restarts;
    uint8_t between; /* enum column_between */
    uint8_t feed;    /* extras of the feed */
    uint8_t extras;  /* all of them */
    bool is_linear;
    bool has_feed; /* its mole fractions are the first extras */
    bool has_flow; /* its flow is the next one */
    bool solved;   /* the last step had a solution */
};

#endif
#endif
