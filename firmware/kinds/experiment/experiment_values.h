/* The inner values of a block of the kind `experiment`. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_VALUES_H
#define REFLUX_EXPERIMENT_EXPERIMENT_VALUES_H

#include <stddef.h>

#include "kinds/experiment/experiment_stages.h"

/* Name and value of the i-th; NULL past the end. */
const char *experiment_value(const struct experiment_parts *p, size_t i, float *value);

#endif
