/* Parameters of the kind `experiment` and their checks. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_SETTINGS_H
#define REFLUX_EXPERIMENT_EXPERIMENT_SETTINGS_H

#include "kinds/experiment/experiment_context.h"

#define EXPERIMENT_PARAMETERS                                                                      \
    (21 + EXPERIMENT_KEPT * (DIFFERENCE_A_MOST + EXPERIMENT_KEPT * DIFFERENCE_B_MOST))
extern const struct block_parameter experiment_parameter_rows[EXPERIMENT_PARAMETERS];

MUST_CHECK enum err experiment_check(const struct block_setup *setup, struct block_fault *fault);
uint32_t experiment_ticks(const struct block_setup *setup);
/* Samples of the record. */
uint32_t experiment_samples(const struct experiment_settings *s);
/* Sets all of *c. */
void experiment_context_take(struct experiment_context *c, const struct block_setup *setup);

#endif
