/* State of the monitor. For its owner composition_watch.c and for composition_block.h, which allocates it. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_WATCH_STATE_H
#define REFLUX_COMPOSITION_COMPOSITION_WATCH_STATE_H

#include "kinds/composition/composition_settings.h"

#if CONFIG_BLOCKS

/* Means over the last `watch` seconds. */
struct composition_means {
    real_t mean;    /* innovations over their expected standard deviation */
    real_t swing;   /* K2, squares of innovations about `slow` */
    real_t slow;    /* K, innovations over SLOW_STEPS */
    real_t pull;    /* K/h, corrections */
    real_t square;  /* e2 over its expected variance */
    real_t product; /* e times the one before, over the same */
    real_t last;    /* K, e of the step before */
};

struct composition_watch {
    struct composition_means sensor[SENSORS_MAX];
    real_t weight;  /* weight of a step in the means, once they have begun */
    uint32_t steps; /* steps in them; saturates */
};

#endif
#endif
