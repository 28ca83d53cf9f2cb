/* What a relay test (by_relay.h) keeps and finds. */
#ifndef REFLUX_COMMISSION_BY_RELAY_STATE_H
#define REFLUX_COMMISSION_BY_RELAY_STATE_H

#include "exchange/config.h"
#include "identify/relay.h"
#include "identify/steady.h"

/* While it goes on; in the memory of the tests. */
struct relay_test {
    bool resting;
    uint32_t waited, cycling; /* samples, for rest and since */
    struct steady steady;
    struct relay relay;
    real_t rest[CHANNEL_MAX], limit[CHANNEL_MAX]; /* fraction of span */
    real_t slope_per_s[CHANNEL_MAX];              /* of a drift before it, likewise */
    uint8_t over[CHANNEL_MAX];                    /* samples in a row past the limit */
};

/* What stays of it. */
struct by_relay {
    bool on;                    /* the results are those of a relay test */
    bool found;                 /* there is one */
    uint8_t loop;               /* index in the plan of the test */
    uint8_t mode[CONFIG_LOOPS]; /* of all loops when it began */
    struct relay_result result;
    real_t gain, ti_s; /* proposed; gain with the sign of the process */
};

#endif
