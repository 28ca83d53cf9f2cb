/* Parameters of the kind `ahead`, and the check of settings. For this folder alone. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_PARAMETERS_H
#define REFLUX_AHEAD_COLUMN_AHEAD_PARAMETERS_H

#include "kinds/ahead/column_ahead.h"

#if CONFIG_BLOCKS

#define AHEAD_PARAMETERS 14
extern const struct block_parameter ahead_parameters[AHEAD_PARAMETERS];

MUST_CHECK enum err ahead_check(const struct block_setup *setup, struct block_fault *fault);

#endif
#endif
