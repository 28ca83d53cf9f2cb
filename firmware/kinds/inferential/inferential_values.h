/* Inner values of a loop of the kind `inferential`, as `block N` shows them. For this folder alone. */
#ifndef REFLUX_INFERENTIAL_INFERENTIAL_VALUES_H
#define REFLUX_INFERENTIAL_INFERENTIAL_VALUES_H

#include <stddef.h>

#include "kinds/inferential/inferential.h"

#if CONFIG_BLOCKS

#define INFERENTIAL_VALUES 15

/* Returns the name of value i of loop k. */
const char *inferential_value(const struct inferential *l, unsigned k, size_t i, float *value);

#endif
#endif
