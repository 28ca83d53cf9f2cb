/* Several single loops on one plant, with or without a static decoupler, seen as one closed loop. */
#ifndef REFLUX_DESIGN_LOOPS_H
#define REFLUX_DESIGN_LOOPS_H

#include "design/names.h"
#include "design/tuning.h"
#include "interact/plant.h"

struct loops {
    struct pairs pairs;                 /* 1 to 16; loop k holds output[k] with input[k] */
    struct tuning tuning[INTERACT_MAX]; /* of loop k; ti_s above 0: every loop integrates */
    real_t derivative_filter;           /* N: the derivative's lag is Td/N; 1 to 100 */
    real_t interval_s;                  /* sample interval, 1e-3 to 1e5 */
    const struct matrix *decoupler;     /* u = D v, row and column k for loop k; NULL: none */
};

/* ERR_RANGE, ERR_NOT_FINITE: pairs outside the plant or given twice, settings, a decoupler of another size; why may be
 * NULL. The plant itself is not looked at (interact_check). */
MUST_CHECK enum err loops_check(const struct interact_plant *plant, const struct loops *loops,
                                struct interact_refusal *why);

/* s K (1 + 1/(Ti s) + Td s/(1 + Td s/N)) at s = i omega, omega above 0, with the action's sign. */
struct cplx loops_controller(const struct loops *loops, uint8_t k, real_t omega);

/* The loops opened at the outputs: G(s) D C(s) exp(-s h/2) at s = i omega, h the sample interval (a zero-order hold is
 * late by half of it). Lags shorter than h/2 count as h/2. */
void loops_open(const struct interact_plant *plant, const struct loops *loops, real_t omega,
                struct cmatrix *open);

#endif
