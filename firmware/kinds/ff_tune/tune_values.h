/* The inner values of a block of the kind `ff_tune`. */
#ifndef REFLUX_FF_TUNE_TUNE_VALUES_H
#define REFLUX_FF_TUNE_TUNE_VALUES_H

#include <stddef.h>

#include "kinds/ff_tune/tune_stages.h"

/* Name and value of the i-th; NULL past the end. */
const char *tune_value(const struct tune_parts *p, size_t i, float *value);

#endif
