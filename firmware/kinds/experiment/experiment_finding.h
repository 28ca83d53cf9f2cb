/* The search for a model in the record of an experiment, in the workspace: between ticks, in pieces. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_FINDING_H
#define REFLUX_EXPERIMENT_EXPERIMENT_FINDING_H

#include "kinds/experiment/experiment_context.h"
#include "kinds/experiment/experiment_record.h"
#include "kinds/experiment/plant_model.h"

struct experiment_finding;

/* Nothing was searched yet. */
void experiment_finding_reset(struct experiment_finding *f);
/* A piece. True while there is more. */
bool experiment_finding_piece(struct experiment_finding *f, const struct experiment_context *c,
                              const struct experiment_rows *rows);
bool experiment_finding_is_over(const struct experiment_finding *f);
/* The search itself, with the outputs that are done. */
const struct plant_finding *experiment_finding_result(const struct experiment_finding *f);

#endif
