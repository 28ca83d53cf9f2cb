/* Parameters of the kind `state_law`, and the check of settings. For this folder alone. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_PARAMETERS_H
#define REFLUX_STATE_LAW_STATE_LAW_PARAMETERS_H

#include "law/state_law_settings.h"

#if CONFIG_BLOCKS

#define STATE_LAW_PARAMETERS (12 + STATE_LAW_LOOPS * (STATE_LAW_LOOPS + STATE_FEEDBACK_INPUTS))
extern const struct block_parameter state_law_parameters[STATE_LAW_PARAMETERS];

MUST_CHECK enum err state_law_check_settings(const struct block_setup *setup,
                                             struct block_fault *fault);

#endif
#endif
