/* Antoine's equation with three constants in place of a vapour pressure with more: what a table of a column may be made with, as
 * a model that is simpler than the plant. */
#ifndef REFLUX_HOST_SIM_ANTOINE_FIT_H
#define REFLUX_HOST_SIM_ANTOINE_FIT_H

#include "model/column.h"

/* "320-370", K, within the column's range of temperatures. False: what is wrong in err. */
bool antoine_range(const char *text, const struct column_config *c, double range[2], char *err,
                   size_t err_size);

/* ln(P/Pa) = A - B/(C + T) through the component's own pressure at both ends of the range and in its middle: constants A, B (K), C
 * (K). False: there is no such equation, since ln P is a straight line in T. */
bool antoine_fit(const struct component *p, const double range[2], double constants[3]);

#endif
