/* Decoupling of n loops by state feedback, with poles that are assigned (P. L. Falb and W. A. Wolovich, IEEE Trans. Automatic Control 12
 * (1967) 651; on a column: T. O. Folami, PhD thesis, Aston, 1989, chapter 6, as far as his volume 2 tells of it):
 *
 *     u = F x + G (w + integral - derivative) + Tf d
 *
 * d_i, the index of output i, is the least j at which C_i A^j B is not 0. With the rows C_i A^d_i B of B* and C_i A^(d_i + 1) of A*
 *
 *     F = B*^-1 (sum of M_k C A^k - A*),  G = B*^-1 K*
 *     y_i^(d_i + 1) = sum over k of m_ik y_i^(k) + kappa_i w_i
 *
 * so that y_i becomes w_i where kappa_i = -m_i0, K* = -M0 (his result; the line above is the proof). In discrete time y^(k) is y k samples
 * later, and kappa_i = 1 - sum of m_ik, K* = I - M0 with one pole.
 *
 * Ours: rows count as 0 by a tolerance; the form in discrete time; the integral of (w - y)/T_I and T_D y', which make PID of a loop with
 * one pole; Tf by outputs. What becomes of the rest of the plant are its zeros (state_zeros.h); one that is not stable is refused.
 * Output i is decoupled with setpoint i; which input moves it does not matter. */
#ifndef REFLUX_DESIGN_STATE_DECOUPLER_H
#define REFLUX_DESIGN_STATE_DECOUPLER_H

#include <stdbool.h>

#include "design/double_symbols.h"
#include "design/state_zeros.h"
#include "lti/state_model.h"

#define STATE_LOOPS     STATE_MODEL_OUTPUTS
#define STATE_POLES     4   /* of a loop: indices to 3 */
#define STATE_LOOP_NONE 255 /* no loop */

enum state_feedforward {
    STATE_FEEDFORWARD_NONE,
    STATE_FEEDFORWARD_STATES, /* Tf = -(B' B)^-1 B' E: least squares over all states (Folami) */
    STATE_FEEDFORWARD_OUTPUTS /* Tf = -B*^-1 C_i A^d_i E: y_i^(d_i + 1) is not moved by d (ours) */
};

struct state_decoupler_config {
    /* Cosine of the angle between C_i A^j and a column of B at which they count as at right angles, 0 to 0.1. States of one unit, or
     * scaled to one magnitude. */
    real_t row_lo;
    /* Largest condition number of B*, rows and columns of one norm, 1 to 1e6. */
    real_t condition_hi;
    /* A state with less than this part of the largest element of a row of F, in all rows, need not be measured; 0 to 0.1. */
    real_t weight_lo;
};

struct state_decoupler_goal {
    /* The first d_i + 1 of loop i count; conjugate complex ones in pairs. Per second, or in z. */
    struct cplx pole[STATE_LOOPS][STATE_POLES];
    real_t integral_s[STATE_LOOPS];   /* T_I, s, above 0; 0: none */
    real_t derivative_s[STATE_LOOPS]; /* T_D, s; 0: none */
    enum state_feedforward feedforward;
    /* A continuous design: interval at which it will be computed with inputs held, s; 0 is not judged. Of a sampled one it is the period. */
    real_t hold_s;
};

struct state_decoupler {
    uint8_t loops, states, disturbances;
    uint8_t index[STATE_LOOPS];
    struct matrix a_star, b_star;
    struct matrix f, g, tf; /* loops x states, x loops, x disturbances */
    real_t m[STATE_LOOPS][STATE_POLES], k_star[STATE_LOOPS];
    real_t integral_s[STATE_LOOPS], derivative_s[STATE_LOOPS];
    real_t condition; /* of B* */
    real_t neglected; /* largest cosine that counted as 0 */
    struct state_modes zeros;
    uint16_t needed; /* bit k: state k has to be known; how many there are */
    uint8_t needed_count;
    real_t radius; /* of the loop as sampled, 0: not judged */
};

struct state_decoupler_work {
    uint8_t part;            /* which is next */
    struct matrix chain;     /* rows C_i A^k, k to d_i, of one norm, loop by loop */
    struct matrix invariant; /* -B*^-1 A* */
    struct lu lu;
    struct state_model sampled;
    union {
        struct svd svd;
        struct pseudo_inverse_work pseudo_inverse;
        struct state_model_work sampling;
        struct state_zeros_work zeros;
    } at;
};

/* The fault, in words, and its loop (STATE_LOOP_NONE: no particular one); pointers to constant text. */
struct state_decoupler_refusal {
    const char *field, *wanted;
    uint8_t loop;
};

/* Cosines to 1e-3, condition to 1e4, weights to 1e-6. */
void state_decoupler_config_default(struct state_decoupler_config *config);

/* ERR_RANGE, ERR_NOT_FINITE: model, config or goal; "outputs": not as many as inputs; "index" above 3; "zero": not stable, or nearer to the
 * limit than rounding can tell; "pole", "integral_s": the loop that was asked for is not stable; "hold_s": not as sampled, *result has
 * its radius. ERR_SINGULAR: no input moves an output, or B* is singular or above condition_hi. ERR_FULL: states and modes are more than
 * 16 together. *result has what was found before. reason may be NULL. Up to 6e6 instructions. */
MUST_CHECK enum err
state_decoupler_design(const struct state_model *model, const struct state_decoupler_config *config,
                       const struct state_decoupler_goal *goal, struct state_decoupler_work *work,
                       struct state_decoupler *result, struct state_decoupler_refusal *reason);

/* The same in three parts: the law, its zeros, the loop. ERR_BUSY: there is another. All that is handed over stays between them, and reason
 * is there. */
void state_decoupler_begin(struct state_decoupler_work *work);
MUST_CHECK enum err
state_decoupler_part(const struct state_model *model, const struct state_decoupler_config *config,
                     const struct state_decoupler_goal *goal, struct state_decoupler_work *work,
                     struct state_decoupler *result, struct state_decoupler_refusal *reason);

#endif
