/* The result of a relay test: a record of by_relay.c, which alone writes it. */
#ifndef REFLUX_COMMISSION_RELAY_FINDING_H
#define REFLUX_COMMISSION_RELAY_FINDING_H

#include "identify/relay.h"

struct relay_finding {
    struct relay_result result;
    real_t gain, ti_s; /* proposed; gain with the sign of the process */
    bool found;        /* there is a result */
};

#endif
