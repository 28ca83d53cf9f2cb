/* The parts of a block of the kind `composition`, as functions that need several of them get them. For this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_PARTS_H
#define REFLUX_COMPOSITION_COMPOSITION_PARTS_H

#include "kinds/composition/composition_analysis.h"
#include "kinds/composition/composition_model.h"
#include "kinds/composition/composition_sensors.h"
#include "kinds/composition/composition_watch.h"

#if CONFIG_BLOCKS

struct composition_filter;
struct composition_judge;

/* Standard deviations, mole fraction or K. */
struct composition_certainty {
    real_t sd[BLOCK_POINTS_MAX]; /* of the points */
    real_t least, most;          /* of the mole fractions */
};

struct composition_parts {
    const struct composition_settings *settings;
    struct composition_model *model;
    struct composition_sensors *sensors;
    struct composition_watch *watch;
    struct composition_analyses *analyses;
    struct composition_filter *filter;
    struct composition_judge *judge;
    real_t *gains; /* [sensors][composition_model_length()], memory of complete innovation */
    uint8_t inputs, points;
};

#endif
#endif
