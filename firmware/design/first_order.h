/* One lag and a dead time in place of an element of two lags and a zero, for the rules of design/tuning.h.
 *
 * Half rule: half of the shorter lag goes to the longer one, half to the dead time. A zero that makes the response begin the
 * wrong way adds its time to the dead time; one that makes it faster is cancelled against the lag next to it. Both are
 * Skogestad's, J. Process Control 13 (2003) 291, with tau_c equal to the dead time. He has no rule for underdamped elements.
 * Ours takes square_s2/T as the dead time and the rest of T as the lag: it meets the half rule where the lags become equal,
 * and with tau_c equal to the dead time the gain margin at the resonance is 2. */
#ifndef REFLUX_DESIGN_FIRST_ORDER_H
#define REFLUX_DESIGN_FIRST_ORDER_H

#include "design/double_symbols.h"
#include "interact/plant.h"

/* Returns the element itself where it has one lag. The gain differs from the element's where a zero is far slower than the
 * lags. element and shape as interact_check wants them. */
struct fopdt first_order_of(const struct fopdt *element, const struct interact_shape *shape);

#endif
