/* The state behind experiment_model.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_MODEL_STATE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_MODEL_STATE_H

#include "kinds/experiment/experiment_found.h"
#include "kinds/experiment/plant_experiment.h"

struct experiment_model {
    struct experiment_found found[EXPERIMENT_MOST];
};

#endif
