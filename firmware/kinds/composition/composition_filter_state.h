/* State that a block with complete innovation keeps of its job. For its owner composition_filter.c and for composition_block.h, which
 * allocates it. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_FILTER_STATE_H
#define REFLUX_COMPOSITION_COMPOSITION_FILTER_STATE_H

#include "kinds/composition/composition_parts.h"

#if CONFIG_BLOCKS

struct composition_job;

struct composition_filter {
    struct composition_job *job; /* in the workspace; NULL: it is not leased */
    uint32_t lease;
    bool declined;    /* from `free` to `take` */
    uint8_t refusals; /* consecutive; another has the workspace; saturates */
    bool begins;      /* the next order begins with what is known before any reading */
    bool steady;      /* COVARIANCE_STEADY: the gains are complete */
    uint8_t analysed; /* bit i: the job works analysis i in */
    uint32_t count;   /* results that were taken; saturates */
    /* [sensors][composition_model_length()]; NULL: none yet, each temperature moves its own mole fraction */
    const real_t *gain;
    real_t surprise[ANALYSES_MAX]; /* mole fraction, of the analyses that the job works in */
    struct composition_certainty certainty;
};

#endif
#endif
