/* What a block with complete innovation keeps of its gains' job from tick to tick (kinds/composition/composition_job.h). For this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_FILTER_H
#define REFLUX_COMPOSITION_COMPOSITION_FILTER_H

#include "kinds/composition/composition.h"

#if CONFIG_BLOCKS

struct composition_job;

struct composition_filter {
    struct composition_job *job; /* in the workspace; NULL: it is not leased */
    uint32_t lease;
    bool declined;               /* somebody said `free`; until `take` */
    uint8_t refusals;            /* in a row: somebody else has the workspace; saturates */
    bool begins;                 /* the next order begins with what is known before any reading */
    bool steady;                 /* COVARIANCE_STEADY: the gains are there */
    uint8_t analysed;            /* bit i: the job works analysis i in */
    uint32_t count;              /* orders that were taken; saturates */
    real_t sd[BLOCK_POINTS_MAX]; /* of what a point gives, mole fraction or K */
    real_t least, most;          /* standard deviations of mole fractions */
};

#endif
#endif
