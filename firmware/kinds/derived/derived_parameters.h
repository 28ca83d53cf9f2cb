/* Parameters of the kind `derived`, and their check. For this folder alone.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_DERIVED_DERIVED_PARAMETERS_H
#define REFLUX_DERIVED_DERIVED_PARAMETERS_H

#include "kinds/derived/derived.h"

#if CONFIG_BLOCKS

#define DERIVED_PARAMETER_ROWS 14

extern const struct block_parameter derived_parameter_rows[DERIVED_PARAMETER_ROWS];

MUST_CHECK enum err derived_check(const struct block_setup *setup, struct block_fault *fault);

#endif
#endif
