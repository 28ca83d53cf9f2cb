/* Combines several tests of one input to one element. Main loop and tick. */
#ifndef REFLUX_COMMISSION_COMBINE_H
#define REFLUX_COMMISSION_COMBINE_H

#include <stdbool.h>
#include <stdint.h>

#include "identify/shape_found.h"

/* Adds a test to an element.
 *   Both known: parameters are weighted by their variances where both tests have the same kind of shape. Of two kinds only the
 *   gains are, and the surer shape stays. The other plausible shape is that of the surer test. A ramp and a shape that comes to
 *   rest contradict each other, so the later counts.
 *   Later test slow: it counts, because the element may be larger than the earlier one said.
 *   Later test unknown: it counts unless the element is known.
 *   Later test without a response: it counts where the element is not known and the later test was longer, or none was seen
 *   before either.
 * The lag of a ramp must be above 0. */
void combine_shapes(struct shape_found *sum, const struct shape_found *next, bool longer);

#endif
