/* Kind `experiment`: a PRBS experiment on all inputs at the same time, and a difference model of the plant from it (docs/experiment.md).
 * Its inputs are one to four measurements, then one to four MVs. It moves nothing until it is told to. */
#ifndef REFLUX_ADAPT_PRBS_EXPERIMENT_H
#define REFLUX_ADAPT_PRBS_EXPERIMENT_H

#include "block/block.h"
#include "lti/difference_model.h"

#if CONFIG_BLOCKS

/* A model becomes settings where it is no larger than this. */
#define EXPERIMENT_PAIRS 2 /* outputs, and inputs */
#define EXPERIMENT_A     2 /* coefficients of A_ii behind the 1 */
#define EXPERIMENT_B     5 /* of B_ij, from z^-1 on */
#define EXPERIMENT_MODEL (EXPERIMENT_PAIRS * (EXPERIMENT_A + EXPERIMENT_PAIRS * EXPERIMENT_B))

struct experiment_settings {
    float period_s;                   /* of the model's samples; 0: a base tick */
    float cutoff;                     /* of the filter of measurements, part of half their rate */
    float amplitude[DIFFERENCE_MOST]; /* of MVs, fraction of span to either side */
    float move[DIFFERENCE_MOST];      /* how far each may be from where it was; 0: 1.5 amplitudes */
    float reach[DIFFERENCE_MOST];     /* of measurements, likewise; 0: anywhere */
    float
        fit_least; /* part of the movement that the model has to explain, on samples it has not seen */
    /* The model in force: per output A, then B of each input. Fractions of span. */
    float model[EXPERIMENT_MODEL];
    uint16_t bits, clock, repeats, rest; /* of registers; samples; sequences; samples */
    uint16_t na, nb;                     /* highest orders tried */
    uint8_t method, criterion;           /* enum arx_method, enum arx_criterion */
    uint8_t independence;                /* enum prbs_independence */
    uint8_t adopt;                       /* enum experiment_adopts */
    uint8_t none[4];
};

enum experiment_adopts { EXPERIMENT_ASKS, EXPERIMENT_AT_ONCE };

extern const struct block_kind experiment_kind;

#endif
#endif
