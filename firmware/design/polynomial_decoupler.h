/* Polynomial decoupler of a plant in discrete time, A(z^-1) y = B(z^-1) u with A diagonal: G = adj(B), so that B G is det(B) times the
 * unit matrix and loop i is det(B)/A_ii. No division, so G is stable whatever the zeros of det B. Source: Kotyk and Machacek (1995),
 * Eqs 6 and 7, of two loops.
 *
 * Ours: up to four loops; every column without the delay that all its elements share (of two loops with a common delay of one that is the
 * paper's z), and divided by its diagonal element's gain at rest, so that loop k moves its own input by what it asks for in
 * the end. Both leave B G diagonal. Output i is controlled by input i. */
#ifndef REFLUX_DESIGN_POLYNOMIAL_DECOUPLER_H
#define REFLUX_DESIGN_POLYNOMIAL_DECOUPLER_H

#include <stdbool.h>

#include "design/double_symbols.h"
#include "lti/difference_model.h"
#include "num/polynomial.h"

#define DECOUPLED_NONE 255 /* no loop */

struct polynomial_decoupler_config {
    /* Largest sum of an element's magnitudes in G, 1 to 127: what Q7.24 and its neighbours hold. */
    real_t element_hi;
    /* Largest part of the gain at rest of det B that may cancel, 1e-6 to 1: |det B(1)| over the sum of the magnitudes of its
     * terms. Below, the errors of the model are larger than what is left. */
    real_t determinant_lo;
    /* Largest |zero| of det B in z, above 0: a zero further out stays in every loop. */
    real_t zero_hi;
    /* The same below which a history of inputs that took effect, run backwards through G, forgets soon enough, 0.1 to 0.999. */
    real_t recursion_hi;
};

struct polynomial_decoupler {
    struct polynomial_matrix g; /* loops x loops, in z^-1 */
    /* Loop i with G: y_i = h[i] / A_ii of what goes in; in z^-1, with its dead time. */
    struct polynomial h[DIFFERENCE_MOST];
    struct polynomial det; /* of B, without its delay */
    uint8_t delay;         /* of det B, samples */
    /* Zeros of det B in z, without the infinite ones that its delay is; only polynomial_decoupler_zeros() gives them. */
    struct polynomial_roots zeros;
    real_t outermost; /* the largest |zero|, radius included; 0: there is none */
    /* The part that was limited may be taken into G's past, u = G v solved for v sample by sample: all zeros are within recursion_hi,
     * and G has an inverse in its first coefficients. Where not, moves are scaled as a whole. */
    bool recursive;
};

struct polynomial_decoupler_work {
    struct polynomial_matrix b;
    struct polynomial_minors minors;
};

/* The fault, in words, and its place (DECOUPLED_NONE: no particular one); pointers to constant text. */
struct polynomial_decoupler_refusal {
    const char *field, *wanted;
    uint8_t output, input;
};

/* Elements to 100, determinant at least 0.02, zeros to 1, recursion to 0.95. */
void polynomial_decoupler_config_default(struct polynomial_decoupler_config *config);

/* ERR_RANGE, ERR_NOT_FINITE: config or model; "outputs": not square. why may be NULL. */
MUST_CHECK enum err polynomial_decoupler_check(const struct difference_model *model,
                                               const struct polynomial_decoupler_config *config,
                                               struct polynomial_decoupler_refusal *reason);

/* Designs for what polynomial_decoupler_check() accepts. ERR_SINGULAR: det B is 0, or so small at rest that it may be;
 * a diagonal element of adj B at rest likewise, or an element exceeds element_hi. ERR_RANGE with "zero": outside zero_hi.
 * *result then has det B all the same. why may be NULL. Up to 2e5 instructions. */
MUST_CHECK enum err polynomial_decoupler_design(const struct difference_model *model,
                                                const struct polynomial_decoupler_config *config,
                                                struct polynomial_decoupler_work *work,
                                                struct polynomial_decoupler *result,
                                                struct polynomial_decoupler_refusal *reason);

/* The zeros of a design, or of one that was refused with det B known: for people. ERR_RANGE: it is not; ERR_TIMEOUT. Up to 1e6
 * instructions. */
MUST_CHECK enum err polynomial_decoupler_zeros(struct polynomial_decoupler *d);

#endif
