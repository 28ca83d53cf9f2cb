/* A first-order model with dead time from a frequency response (R. Siddha 2003, 4.4, reads it off at one frequency; the least squares are ours). */
#ifndef REFLUX_DESIGN_RESPONSE_FIT_H
#define REFLUX_DESIGN_RESPONSE_FIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "design/double_symbols.h"
#include "lti/fopdt.h"
#include "num/cmatrix.h"
#include "num/golden.h"

/* The model that has the least sum of squares of relative errors on a grid: for a given dead time gain and time constant are linear least
 * squares of g (1 + i w T) - K, weighted by the answer (Sanathanan and Koerner 1963); the dead time by a grid up to dead_most and golden section. */
struct response_fit {
    struct fopdt best; /* so far; its time constant may be 0 */
    real_t error;      /* of it: root mean square of |model/response - 1| */
    /* inner state */
    real_t square, dead_most;
    struct golden section;
    uint8_t tried;
};

/* n points at omega, rad/s above 0; dead_most, s. ERR_RANGE: fewer than three points, one that is 0, or dead_most below 0; ERR_NOT_FINITE. */
MUST_CHECK enum err response_fit_begin(struct response_fit *f, size_t n, const real_t *omega,
                                       const struct cplx *response, real_t dead_most);
/* The same points all the time. A dead time, about 300 n operations; 48 in all. True while there is more. */
bool response_fit_piece(struct response_fit *f, size_t n, const real_t *omega,
                        const struct cplx *response);
/* All pieces. ERR_RANGE also: no model came out. */
MUST_CHECK enum err fopdt_from_response(size_t n, const real_t *omega, const struct cplx *response,
                                        real_t dead_most, struct fopdt *model, real_t *error);

#endif
