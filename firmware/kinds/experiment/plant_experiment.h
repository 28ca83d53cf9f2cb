/* The kind `experiment` moves all MVs of a plant at the same time by pseudorandom binary signals, and finds a difference model of it
 * (docs/methods/experiment.md). Inputs of the block: n measurements, then n MVs. */
#ifndef REFLUX_EXPERIMENT_PLANT_EXPERIMENT_H
#define REFLUX_EXPERIMENT_PLANT_EXPERIMENT_H

#include "block/block.h"

/* 0 leaves it out of an image. */
#ifndef CONFIG_EXPERIMENT
#define CONFIG_EXPERIMENT CONFIG_BLOCKS
#endif

#if CONFIG_EXPERIMENT

#include "lti/difference_model.h"

/* Measurements, and MVs. */
#define EXPERIMENT_MOST 4
/* A model of so many outputs has parameters of its own, which can be proposed and saved. */
#define EXPERIMENT_KEPT 2

struct experiment_settings {
    /* Control interval; 0: a base tick. */
    float period_s;
    /* Cutoff of a filter before decimation, part of half the control frequency; 0: none. */
    float cutoff;
    /* EU, to either side. */
    float amplitude[EXPERIMENT_MOST];
    /* EU, farthest an MV may get; 0: twice the amplitude. */
    float reach[EXPERIMENT_MOST];
    /* EU, farthest a measurement may get. */
    float band[EXPERIMENT_MOST];
    /* %, least */
    float fit;
    /* settle, clock: samples */
    uint16_t bits, clock, periods, settle;
    uint16_t na, nb;
    /* Block of the kind state_law or polynomial; 0: none. */
    uint16_t law;
    /* Blocks of the kind rst; 0: none. */
    uint16_t place[EXPERIMENT_KEPT];
    /* %, of the loops with them */
    float overshoot;
    /* Settling time of a setpoint step. */
    float settling_s[EXPERIMENT_KEPT];
    /* Pole of the observer. */
    float observer;
    /* enum arx_method, arx_criterion */
    uint8_t method, criterion;
    /* enum experiment_adopt */
    uint8_t adopt;
    /* From here on what it finds itself. The model is whole. */
    uint8_t known;
    float a[EXPERIMENT_KEPT][DIFFERENCE_A_MOST];
    /* EU per EU */
    float b[EXPERIMENT_KEPT][EXPERIMENT_KEPT][DIFFERENCE_B_MOST];
};

enum experiment_adopt { EXPERIMENT_ADOPT_ASKED, EXPERIMENT_ADOPT_AT_ONCE };

extern const struct block_kind experiment_kind;

#endif
#endif
