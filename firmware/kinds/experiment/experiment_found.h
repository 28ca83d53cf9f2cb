/* The findings of an experiment for an output. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_FOUND_H
#define REFLUX_EXPERIMENT_EXPERIMENT_FOUND_H

#include <stdint.h>

struct experiment_found {
    /* Orders; enum plant_verdict. */
    uint8_t na, nb, verdict;
    /* % */
    float one_step, fit, apart;
};

#endif
