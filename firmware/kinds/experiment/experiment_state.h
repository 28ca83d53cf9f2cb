/* The state of a block of the kind `experiment`: a place for each of its parts, which their own files know. Only the kind includes this. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_STATE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_STATE_H

#include "kinds/experiment/experiment_context.h"
#include "kinds/experiment/experiment_law_state.h"
#include "kinds/experiment/experiment_lease_state.h"
#include "kinds/experiment/experiment_loops_state.h"
#include "kinds/experiment/experiment_model_state.h"
#include "kinds/experiment/experiment_proposals_state.h"
#include "kinds/experiment/experiment_record_state.h"
#include "kinds/experiment/experiment_stages.h"
#include "kinds/experiment/experiment_stages_state.h"

struct plant_experiment {
    struct experiment_context context;
    struct experiment_lease lease;
    struct experiment_stages stages;
    struct experiment_record record;
    struct experiment_model model;
    struct experiment_loops loops;
    struct experiment_proposals proposals;
    struct experiment_law law;
    float coefficients[];
};

NOT_INLINE struct experiment_parts experiment_parts_of(struct plant_experiment *e);

#endif
