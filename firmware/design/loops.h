/* Several single loops on one plant, with or without a static decoupler, seen as one closed loop. */
#ifndef REFLUX_DESIGN_LOOPS_H
#define REFLUX_DESIGN_LOOPS_H

#include <stddef.h>

#include "design/double_symbols.h"
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
                                struct interact_refusal *reason);

/* The elements sampled with their inputs held, exactly: for a dead time of delay + f samples, 0 <= f < 1,
 *     x(k+1) = (1 - rise) x(k) + (rise - rise_late) u(k - delay - 1) + rise_late u(k - delay), y = gain x
 * rise = 1 - exp(-h/T) and rise_late = 1 - exp(-(1 - f) h/T), which keep their digits where h is far below T. An element of two
 * lags has a state for each (design/modes.h), or one complex state, whose imaginary part is the second. Row and column
 * k for loop k. */
struct loops_sampled {
    const struct interact_plant *plant; /* gains and shapes are read there */
    real_t step_s;
    real_t rise[INTERACT_MAX][INTERACT_MAX], rise_late[INTERACT_MAX][INTERACT_MAX];
    /* Those of the second lag, or imaginary parts; 0 for one lag. */
    real_t second[INTERACT_MAX][INTERACT_MAX], second_late[INTERACT_MAX][INTERACT_MAX];
    uint16_t delay[INTERACT_MAX][INTERACT_MAX];
};

/* Samples of interval_s, or longer ones where a dead time would be more than delay_most of them. plant and loops checked; the
 * plant must live as long as `sampled`. */
void loops_sample(const struct interact_plant *plant, const struct loops *loops,
                  uint16_t delay_most, real_t step_least_s, struct loops_sampled *sampled);

/* z - 1 at z = exp(i omega h), to its last digit also where omega h is small. */
struct cplx loops_z_less_1(real_t omega_h);

/* The PID of kinds/pid/pid.h (positional) where z - 1 is as given, not 0, with the action's sign:
 *     s K (1 + h/(Ti (z - 1)) + Td (1 - 1/z)/(Tf + h - Tf/z)), Tf = Td/N */
struct cplx loops_controller(const struct loops *loops, uint8_t k, real_t step_s,
                             struct cplx z_less_1);

/* The loops opened at the outputs, G(z) D C(z), at z = exp(i omega h); omega above 0, at most pi/h. */
void loops_open(const struct loops *loops, const struct loops_sampled *sampled, real_t omega,
                struct cplx open[INTERACT_MAX][MATRIX_MAX]);

/* Takes the state of element (k, l) one sample on and returns the element's output. before and after: its input in the two
 * samples that its dead time reaches. second: the second state, of an element of two lags. */
real_t loops_advance(const struct loops *loops, const struct loops_sampled *sampled, size_t k,
                     size_t l, real_t before, real_t after, real_t *state, real_t *second);

#endif
