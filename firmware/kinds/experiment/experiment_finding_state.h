/* The state behind experiment_finding.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_FINDING_STATE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_FINDING_STATE_H

#include "kinds/experiment/plant_model.h"

struct experiment_finding {
    struct plant_finding finding;
    bool begun, over;
};

#endif
