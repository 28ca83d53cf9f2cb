/* PI and PID settings from a first-order-plus-dead-time model.
 *
 * All results are for the ideal (ISA) form of kinds/pid/pid.h:
 *     u = s K (e + 1/Ti integral e dt + Td de/dt), K > 0, s = the action
 * The model's gain is in the units of the settings: fractions of span in, fractions of span out gives the
 * fraction-per-fraction gain pid.h wants.
 */
#ifndef REFLUX_DESIGN_TUNING_H
#define REFLUX_DESIGN_TUNING_H

#include "base/error.h"
#include "design/double_symbols.h"
#include "lti/fopdt.h"
#include "num/real.h"

/* Same numbers as enum pid_action, which this layer does not see. */
enum tuning_action {
    TUNING_REVERSE = 0, /* model gain above 0 */
    TUNING_DIRECT = 1   /* model gain below 0 */
};

struct tuning {
    real_t gain; /* above 0 */
    real_t ti_s;
    real_t td_s; /* 0 for the PI rules */
    enum tuning_action action;
};

/* The fault, in words; pointers to constant text. */
struct tuning_refusal {
    const char *field, *wanted;
};

/* Every rule: ERR_NOT_FINITE (NaN or infinity), ERR_RANGE (gain 0, a time outside its range, or settings too
 * large for real_t); on error *why, which may be NULL, says which and *result is unchanged. */

/* Cohen and Coon, Trans. ASME 75 (1953) 827, as printed by Folami (1989), A2.2.1: quarter-decay response
 * to a load change. Fast and little damped: best for dead time 0.1 to 1 of the time constant. Needs dead
 * time above 0. */
MUST_CHECK enum err tuning_cohen_coon_pi(const struct fopdt *model, struct tuning *result,
                                         struct tuning_refusal *reason);
MUST_CHECK enum err tuning_cohen_coon_pid(const struct fopdt *model, struct tuning *result,
                                          struct tuning_refusal *reason);

/* Skogestad, J. Process Control 13 (2003) 291 (SIMC), PI:
 *     K = T/(|gain| (tau_c + theta)), Ti = min(T, 4 (tau_c + theta))
 * tau_c, s, [0, 1e6] with tau_c + theta above 0: wanted closed-loop time constant (lambda). The paper's own
 * choice is tau_c = theta; larger is slower and gentler. */
MUST_CHECK enum err tuning_simc_pi(const struct fopdt *model, real_t tau_c_s, struct tuning *result,
                                   struct tuning_refusal *reason);

/* The same for gain exp(-theta s)/((T s + 1)(T2 s + 1)), T2 = tau2_s in [0, T]: the paper's series (cascade)
 * PID with derivative time T2, converted to the ideal form with f = 1 + Td/Ti:
 *     K f, Ti f, Td/f
 * tau2_s = 0 gives tuning_simc_pi. */
MUST_CHECK enum err tuning_simc_pid(const struct fopdt *model, real_t tau2_s, real_t tau_c_s,
                                    struct tuning *result, struct tuning_refusal *reason);

/* B. D. Tyreus and W. L. Luyben, Ind. Eng. Chem. Res. 31 (1992) 2625, PI from the ultimate gain and period:
 *     K = Ku/3.2, Ti = 2.2 Pu
 * gain: Ku, its sign that of the process, 1e-6 to 1e6 in magnitude; period_s: Pu, 1e-6 to 1e6 s. Meant for processes near
 * an integrator with dead time, as most of a column's are; slow where the dead time is as long as the lag. */
MUST_CHECK enum err tuning_tyreus_luyben_pi(real_t gain, real_t period_s, struct tuning *result,
                                            struct tuning_refusal *reason);

#endif
