/* Static decoupler from a gain matrix: D = K^-1 with every column divided by its diagonal element, so that loop k moves
 * its own input by exactly what it asks for and the others by what keeps their outputs still. The gain of loop k with D
 * is K_kk/lambda_kk. */
#ifndef REFLUX_DESIGN_STATIC_DECOUPLER_H
#define REFLUX_DESIGN_STATIC_DECOUPLER_H

#include "design/double_symbols.h"
#include "interact/rga.h"

#define STATIC_DECOUPLER_LOOPS 8

struct static_decoupler_config {
    real_t element_hi; /* largest |element|: 1 to 1000; the firmware's decoupler takes 100 */
    /* Largest relative gain: inverting the plant multiplies the errors of its inputs by it (Skogestad, Morari and Doyle,
     * IEEE Trans. Automatic Control 33 (1988) 1092): 1 to 1000. */
    real_t lambda_hi;
    real_t significance; /* standard deviations between each decoupled loop's gain and 0: 0 to 20 */
    real_t floor;        /* relative standard deviation of a gain at least: 0 to 0.5 */
    real_t left_hi;      /* largest left_sd, below: 0.01 to 10 */
};

struct static_decoupler_result {
    struct matrix d;              /* loops x loops, in the order of the pairs */
    real_t gain[INTERACT_MAX];    /* of loop k with D */
    real_t gain_sd[INTERACT_MAX]; /* of it, from the gains' errors */
    /* Interaction that the gains' errors leave: standard deviation of K D off the diagonal over the diagonal
     * element of its row, the largest. */
    real_t left_sd;
};

struct static_decoupler_work {
    struct pseudo_inverse_work pseudo;
    struct matrix gains, inverse;
};

/* Elements to 100, lambda to 10, 3 standard deviations, floor 0.005, left 0.3. */
void static_decoupler_config_default(struct static_decoupler_config *config);

/* ERR_FULL: more than STATIC_DECOUPLER_LOOPS pairs. ERR_SINGULAR: K has no inverse, an element of its diagonal is 0, or a
 * bound of config is exceeded; why says which, and where. ERR_RANGE, ERR_NOT_FINITE: config, plant or pairs. why may be
 * NULL. */
MUST_CHECK enum err static_decoupler(const struct interact_plant *plant, const struct pairs *pairs,
                                     const struct static_decoupler_config *config,
                                     struct static_decoupler_work *work,
                                     struct static_decoupler_result *result,
                                     struct interact_refusal *reason);

#endif
