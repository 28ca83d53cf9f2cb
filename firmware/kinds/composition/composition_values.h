/* Values that `block N` shows of the kind `composition`. For this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_VALUES_H
#define REFLUX_COMPOSITION_COMPOSITION_VALUES_H

#include "kinds/composition/composition_parts.h"

#if CONFIG_BLOCKS

/* Returns the name of value i; NULL: there are no more. */
const char *composition_values(const struct composition_parts *p, size_t i, float *value);

#endif
#endif
