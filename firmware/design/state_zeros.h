/* The part of a plant that its decoupling by state feedback hides, and the loop that is closed with samples.
 *
 * Decoupled outputs are moved by their own setpoints alone, with the assigned poles; what is left of the plant moves as it does while all
 * outputs are held at 0, and its modes are the invariant zeros (W. M. Wonham and A. S. Morse, SIAM J. Control 8 (1970) 1). They are the
 * eigenvalues of A + B F on the states that all rows C_i A^k, k to d_i, call 0. */
#ifndef REFLUX_DESIGN_STATE_ZEROS_H
#define REFLUX_DESIGN_STATE_ZEROS_H

#include "design/double_symbols.h"
#include "lti/state_model.h"
#include "num/ceigen.h"
#include "num/svd.h"

struct state_modes {
    uint8_t n;
    /* Per second, or in z. */
    struct cplx mode[STATE_MODEL_STATES];
    /* Error by rounding of an eigenvalue well apart from others. */
    real_t error;
    real_t outermost; /* largest real part, continuous; largest magnitude, in z */
};

struct state_zeros_work {
    struct svd svd;
    struct matrix moved;
    struct cmatrix modes;
};

/* chain: rows C_i A^k, invariant: -B*^-1 A* (loops x states). ERR_SINGULAR: rows of the chain depend on one another; ERR_TIMEOUT: no
 * convergence. */
MUST_CHECK enum err state_zeros_find(const struct state_model *model, const struct matrix *chain,
                                     const struct matrix *invariant, struct state_zeros_work *work,
                                     struct state_modes *zeros);

/* A law as a program computes it once a sample: u = f x + g (w + q - derivative_s (y - y a sample ago)/period),
 * q <- q + period/integral_s (w - y); 0 of a time: none. Pointers to as many as there are outputs. */
struct state_law {
    const struct matrix *f, *g;
    const real_t *integral_s, *derivative_s;
};

/* Largest magnitude of the eigenvalues of a sampled model with this law. ERR_FULL: states, integrals and differences are more than 16;
 * ERR_TIMEOUT. */
MUST_CHECK enum err state_loop_radius(const struct state_model *sampled,
                                      const struct state_law *law, struct state_zeros_work *work,
                                      real_t *radius);

#endif
