/* Several single loops on one plant, with or without a static decoupler, seen as one closed loop. */
#ifndef REFLUX_DESIGN_LOOPS_H
#define REFLUX_DESIGN_LOOPS_H

#include "design/names.h"
#include "design/tuning.h"
#include "interact/plant.h"

struct loops {
    struct pairs pairs;                 /* loop k holds output[k] with input[k] */
    struct tuning tuning[INTERACT_MAX]; /* of loop k; ti_s above 0 */
    real_t derivative_filter;           /* Td/N: N, 1 to 100 */
    real_t interval_s; /* sample interval of the loops, 0 to 1e6; half of it counts as dead time */
    const struct matrix *decoupler; /* u = D v, row and column k for loop k; NULL: none */
};

/* ERR_RANGE, ERR_NOT_FINITE: pairs outside the plant or twice, settings, decoupler of another size. */
MUST_CHECK enum err loops_check(const struct interact_plant *plant, const struct loops *loops,
                                struct interact_refusal *why);

/* s K (1 + 1/(Ti s) + Td s/(1 + Td s/N)) at s = i omega, omega above 0, with the action's sign. */
struct cplx loops_controller(const struct loops *loops, uint8_t k, real_t omega);

#endif
