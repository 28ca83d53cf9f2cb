/* Cascades in a model: output `outer` answers every input as G2 times output `inner` does, so it holds nothing that the
 * inner one does not hold earlier. Johansson (1994): a 2-output 1-input model that factors as (G1, G2 G1) wants an inner
 * controller on y1 and an outer one on y2. */
#ifndef REFLUX_INTERACT_CASCADE_H
#define REFLUX_INTERACT_CASCADE_H

#include "interact/plant.h"

struct cascade_config {
    real_t significance; /* as in structure.h; also the bound of the misfit, standard deviations */
    real_t floor;        /* relative standard deviation of a gain at least: 1e-4 to 0.5 */
    /* Inner: (L + T) at most this part of the outer's, with every input: 0.05 to 1. */
    real_t faster;
};

struct cascade {
    uint8_t inner, outer; /* outputs */
    uint16_t inputs;      /* bit j: moves both */
    struct fopdt between; /* G2: gain, dead time and time constant from inner to outer */
    real_t misfit_sd;     /* 0 with a single input, where the gains always fit */
};

/* significance 3, floor 0.02, faster 0.6. */
void cascade_config_default(struct cascade_config *config);

/* All pairs of outputs that fit, best inner (the slowest of those fast enough) for each outer; at most INTERACT_MAX of
 * them, *found how many. */
MUST_CHECK enum err cascade_detect(const struct interact_plant *plant,
                                   const struct cascade_config *config,
                                   struct cascade cascades[INTERACT_MAX], uint8_t *found);

#endif
