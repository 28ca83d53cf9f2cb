/* The kind `experiment`: moves all MVs of a plant at the same time by pseudorandom binary signals, and finds a difference model of it
 * (docs/experiment.md). Inputs of the block: n measurements, then n MVs. */
#ifndef REFLUX_EXPERIMENT_PLANT_EXPERIMENT_H
#define REFLUX_EXPERIMENT_PLANT_EXPERIMENT_H

#include "block/block.h"

/* 0 leaves it out of an image. */
#ifndef CONFIG_EXPERIMENT
#define CONFIG_EXPERIMENT CONFIG_BLOCKS
#endif

#if CONFIG_EXPERIMENT

#include "lti/difference_model.h"

#define EXPERIMENT_MOST 4 /* measurements, and MVs */
/* A model of so many outputs has parameters of its own, which can be proposed and saved. */
#define EXPERIMENT_KEPT 2

struct experiment_settings {
    float period_s; /* control interval; 0: a base tick */
    float cutoff;   /* of a filter before decimation, part of half the control frequency; 0: none */
    float amplitude[EXPERIMENT_MOST];      /* EU, to either side */
    float reach[EXPERIMENT_MOST];          /* EU, farthest an MV may get; 0: twice the amplitude */
    float band[EXPERIMENT_MOST];           /* EU, farthest a measurement may get */
    float fit;                             /* %, least */
    uint16_t bits, clock, periods, settle; /* settle, clock: samples */
    uint16_t na, nb;
    uint16_t law;                      /* block of the kind state_law or polynomial; 0: none */
    uint16_t place[EXPERIMENT_KEPT];   /* blocks of the kind rst; 0: none */
    float overshoot;                   /* %, of the loops with them */
    float settling_s[EXPERIMENT_KEPT]; /* of a setpoint step */
    float observer;                    /* pole */
    uint8_t method, criterion;         /* enum arx_method, arx_criterion */
    uint8_t adopt;                     /* enum experiment_adopt */
    /* From here on what it finds itself. */
    uint8_t known; /* the model is there, whole */
    float a[EXPERIMENT_KEPT][DIFFERENCE_A_MOST];
    float b[EXPERIMENT_KEPT][EXPERIMENT_KEPT][DIFFERENCE_B_MOST]; /* EU per EU */
};

enum experiment_adopt { EXPERIMENT_ADOPT_ASKED, EXPERIMENT_ADOPT_AT_ONCE };

extern const struct block_kind experiment_kind;

#endif
#endif
