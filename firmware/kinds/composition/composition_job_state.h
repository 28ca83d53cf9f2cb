/* State of the job that computes gains. It stands in the leased workspace. For its owner composition_job.c and for tests. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_JOB_STATE_H
#define REFLUX_COMPOSITION_COMPOSITION_JOB_STATE_H

#include <stddef.h>

#include "kinds/composition/composition_parts.h"
#include "kinds/composition/covariance_band.h"
#include "kinds/composition/covariance_ud.h"

#if CONFIG_BLOCKS

/* Mole fractions and extras, at most. */
#define COMPOSITION_LENGTH_MOST (COLUMN_STATES_MAX + COVARIANCE_EXTRAS_MAX)
/* Numbers of the factors of the largest column's Phi. */
#define COMPOSITION_FACTORS_MOST                                                                   \
    (COLUMN_STAGES_MAX * (3u * (COLUMN_COMPONENTS_MAX - 1u) * (COLUMN_COMPONENTS_MAX - 1u) + 2u))

enum composition_phase {
    PHASE_MODEL,
    PHASE_FACTORS,
    PHASE_FEED,
    PHASE_CARRY,
    PHASE_SENSORS,
    PHASE_ANALYSES,
    PHASE_POINTS,
    PHASE_DONE
};

struct composition_job {
    /* the order */
    real_t x[COLUMN_STATES_MAX];
    struct column_inputs inputs;
    real_t h;                   /* s, of a cycle */
    uint16_t present;           /* bit k: sensor k counts */
    uint8_t analysed;           /* bit i: analysis i has a sample */
    real_t older[ANALYSES_MAX]; /* variance for its age */
    bool begin;

    uint8_t phase, next;
    enum err err;
    bool carrying;
    uint32_t cycles;       /* towards a steady state */
    real_t moved, largest; /* gains, in a cycle */
    real_t before[COMPOSITION_LENGTH_MOST];
    uint16_t noise_first;

    struct column column;
    struct column_transition transition;
    real_t factors[COMPOSITION_FACTORS_MOST];
    real_t rates[COLUMN_STATES_MAX], work[COLUMN_STATES_MAX];
    real_t push[COVARIANCE_EXTRAS_MAX * COLUMN_STATES_MAX];
    real_t keep[COVARIANCE_EXTRAS_MAX], grown[COVARIANCE_EXTRAS_MAX];
    real_t noise[COMPOSITION_LENGTH_MOST];
    struct covariance_step step;
    union {
        struct covariance_ud ud;
        struct covariance_band band;
    } covariance;

    /* the result */
    real_t gain[(SENSORS_MAX + ANALYSES_MAX) * COMPOSITION_LENGTH_MOST];
    real_t spread[SENSORS_MAX];
    struct composition_certainty certainty;
    _Alignas(max_align_t) uint8_t memory[]; /* for the covariance */
};

#endif
#endif
