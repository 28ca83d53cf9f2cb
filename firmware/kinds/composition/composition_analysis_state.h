/* State of the analyses. For its owner composition_analysis.c and for composition_block.h, which allocates it. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_ANALYSIS_STATE_H
#define REFLUX_COMPOSITION_COMPOSITION_ANALYSIS_STATE_H

#include "kinds/composition/composition_settings.h"

#if CONFIG_BLOCKS

#define ANALYSIS_PAST 128u

struct composition_analysis {
    uint8_t input, stage, component; /* from 0 */
    real_t share;                    /* g */
    real_t correction;               /* mole fraction */
    real_t surprise;                 /* mole fraction, by which the last one was off */
    real_t age_s;                    /* age of the last one, in the step before */
    bool seen;                       /* there has been one */
    bool rejected;                   /* the last one was too far off */
    bool filtered;             /* the filter finds the correction, from `surprise` and `fresh` */
    bool fresh;                /* there is a believed one that the filter has not taken yet */
    real_t moved;              /* mole fraction, by the estimate since its sample was taken */
    float past[ANALYSIS_PAST]; /* the estimate without correction, every `every` steps */
    uint16_t newest, filled;   /* place in `past`, places that count */
    uint16_t counted;          /* steps since the newest */
    uint16_t every;
};

struct composition_analyses {
    struct composition_analysis analysis[ANALYSES_MAX];
    uint8_t n;
};

#endif
#endif
