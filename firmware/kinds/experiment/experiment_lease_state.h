/* The state behind experiment_lease.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_LEASE_STATE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_LEASE_STATE_H

#include <stdint.h>

struct experiment_lease {
    void *memory;
    uint32_t number;
};

#endif
