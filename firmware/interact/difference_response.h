/* Frequency response of a plant in discrete time, on the unit circle: z = exp(i omega h). */
#ifndef REFLUX_INTERACT_DIFFERENCE_RESPONSE_H
#define REFLUX_INTERACT_DIFFERENCE_RESPONSE_H

#include "interact/double_symbols.h"
#include "lti/difference_model.h"
#include "num/cmatrix.h"

/* response[i][j] = B_ij/A_ii at z = exp(i omega h), h the model's period; outputs x inputs. omega, rad/s, 0 to pi/h: beyond, the
 * curves run back. Error of an element at most (na + nb + 8) REAL_EPSILON (sum |b| + |response| (1 + sum |a|))/|A_ii|.
 * ERR_RANGE, ERR_NOT_FINITE: the model (difference_check) or omega; ERR_SINGULAR: a pole of the plant lies there. */
MUST_CHECK enum err difference_response(const struct difference_model *model, real_t omega,
                                        struct cmatrix *response);

#endif
