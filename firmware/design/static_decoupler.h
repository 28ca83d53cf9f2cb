/* Static decoupler from a gain matrix: D = K^-1 with every column divided by its diagonal element, so that loop k moves
 * its own input by exactly what it asks for and the others by what keeps their outputs still. */
#ifndef REFLUX_DESIGN_STATIC_DECOUPLER_H
#define REFLUX_DESIGN_STATIC_DECOUPLER_H

#include "design/names.h"
#include "interact/rga.h"

#define STATIC_DECOUPLER_LOOPS 8

struct static_decoupler_config {
    real_t element_hi; /* largest |element|: 1 to 1000; the firmware's decoupler takes 100 */
    real_t
        lambda_hi; /* largest relative gain: inverting the plant multiplies an error of the inputs by it (Skogestad,
                            Morari and Doyle, IEEE Trans. Automatic Control 33 (1988) 1092): 1 to 1000, usual 10 */
    real_t
        significance; /* standard deviations between each decoupled loop's gain and 0: 0 to 20, usual 3 */
    real_t floor; /* relative standard deviation of a gain at least: 0 to 0.5 */
};

struct static_decoupler_result {
    struct matrix d;              /* loops x loops, order of the pairs */
    real_t gain[INTERACT_MAX];    /* of loop k with D: K_kk / lambda_kk */
    real_t gain_sd[INTERACT_MAX]; /* of it, from the gains' errors */
    real_t
        leak_sd; /* largest standard deviation of what is left off the diagonal, over the diagonal */
};

/* 10, 3, 0.005, elements to 100. */
void static_decoupler_config_default(struct static_decoupler_config *config);

/* ERR_FULL: more than STATIC_DECOUPLER_LOOPS pairs; ERR_SINGULAR: K has no inverse, a diagonal element of it is 0, or a
 * bound of config is exceeded (why says which, and the loops). ERR_RANGE, ERR_NOT_FINITE: config, plant or pairs. */
struct static_decoupler_work {
    struct rga_work rga;
    struct matrix gains, lambda;
};
MUST_CHECK enum err static_decoupler(const struct interact_plant *plant, const struct pairs *pairs,
                                     const struct static_decoupler_config *config,
                                     struct static_decoupler_work *work,
                                     struct static_decoupler_result *result,
                                     struct interact_refusal *why);

#endif
