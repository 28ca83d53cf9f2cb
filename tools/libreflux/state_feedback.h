/* Part of libreflux.h: decoupling by state feedback (firmware/design/state_decoupler.h). The rules of libreflux.h hold; matrices are
 * row by row, complex numbers re and im. tools/reflux/state_decoupler.py is the Python side. */
#ifndef REFLUX_LIBREFLUX_STATE_FEEDBACK_H
#define REFLUX_LIBREFLUX_STATE_FEEDBACK_H

#include <stdint.h>

#define REFLUX_STATE_POLES 4 /* places for poles of a loop */

/* x' = A x + B u + E d, y = C x: n states (to 16), as many outputs as inputs (loops, to 8); period_s 0: continuous */
struct reflux_state_model {
    int32_t n, loops, disturbances;
    double period_s;
    const double *a, *b, *c, *e;
};

/* poles: loops x REFLUX_STATE_POLES complex; times by loop, s, 0: none; feedforward: enum state_feedforward */
struct reflux_state_goal {
    const double *poles, *integral_s, *derivative_s;
    int32_t feedforward;
    double hold_s;
};

/* Places for the results. m: loops x REFLUX_STATE_POLES; zeros: n complex; numbers: condition, neglected, outermost zero, its error,
 * radius. */
struct reflux_state_found {
    int32_t *index, *n_zeros, *needed;
    double *f, *g, *tf, *b_star, *m, *k_star, *zeros, *numbers;
};

/* settings: row_lo, condition_hi, weight_lo. Where it is refused *found has what was found before. */
int32_t reflux_state_decoupler(const struct reflux_state_model *model, const double *settings,
                               const struct reflux_state_goal *goal,
                               struct reflux_state_found *found, char *reason);
void reflux_state_decoupler_defaults(double *settings);

/* A, B and E of a continuous model as samples see it. */
int32_t reflux_state_sample(const struct reflux_state_model *model, double period_s, double *a,
                            double *b, double *e);

#endif
