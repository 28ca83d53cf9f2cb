/* Parameters of the kind `composition`, and the check of settings. For this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_PARAMETERS_H
#define REFLUX_COMPOSITION_COMPOSITION_PARAMETERS_H

#include "kinds/composition/composition_settings.h"

#if CONFIG_BLOCKS

#define COMPOSITION_PARAMETER_ROWS 36
extern const struct block_parameter composition_parameter_rows[COMPOSITION_PARAMETER_ROWS];

MUST_CHECK enum err composition_check(const struct block_setup *setup, struct block_fault *fault);

#endif
#endif
