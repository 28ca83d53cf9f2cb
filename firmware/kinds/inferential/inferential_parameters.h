/* Parameters of the kind `inferential`, the settings of its loops, and their check. For this folder alone. */
#ifndef REFLUX_INFERENTIAL_INFERENTIAL_PARAMETERS_H
#define REFLUX_INFERENTIAL_INFERENTIAL_PARAMETERS_H

#include "kinds/inferential/inferential_gains.h"

#if CONFIG_BLOCKS

#define INFERENTIAL_PARAMETER_ROWS 20
#define INFERENTIAL_NONE           0xFFu

extern const struct block_parameter inferential_parameter_rows[INFERENTIAL_PARAMETER_ROWS];

MUST_CHECK enum err inferential_check(const struct block_setup *setup, struct block_fault *fault);

/* Settings of loop k that inferential_check() accepts. */
void inferential_config_of(const struct block_setup *setup, unsigned k,
                           struct inferential_config *out);

/* Returns which of the inputs is the secondary temperature of loop k, or INFERENTIAL_NONE. */
unsigned inferential_second(const struct block_setup *setup, unsigned k);

#endif
#endif
