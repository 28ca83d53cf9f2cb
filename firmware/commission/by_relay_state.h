/* The states of by_relay.c. */
#ifndef REFLUX_COMMISSION_BY_RELAY_STATE_H
#define REFLUX_COMMISSION_BY_RELAY_STATE_H

#include "commission/relay_finding.h"
#include "exchange/config.h"
#include "identify/steady.h"

/* A relay test under way; in the memory of the tests. */
struct relay_test {
    bool resting;
    uint32_t waited;  /* samples of waiting for rest */
    uint32_t cycling; /* samples since rest */
    struct steady steady;
    struct relay relay;
    real_t rest[CHANNEL_MAX], limit[CHANNEL_MAX]; /* fraction of span */
    real_t slope_per_s[CHANNEL_MAX];              /* of a drift before it, likewise */
    uint8_t over[CHANNEL_MAX];                    /* samples in a row past the limit */
};

/* Result of the latest relay test. */
struct by_relay {
    bool latest;                /* the latest results are those of a relay test */
    uint8_t loop;               /* index in the plan of the test */
    uint8_t mode[CONFIG_LOOPS]; /* of all loops when it began */
    struct relay_finding finding;
};

/* The latest results are those of a relay test. */
static inline bool by_relay_is_latest(const struct by_relay *r)
{
    return r->latest;
}

static inline const struct relay_finding *by_relay_finding(const struct by_relay *r)
{
    return &r->finding;
}

/* Index of the loop in the plan of the test. */
static inline uint8_t by_relay_loop(const struct by_relay *r)
{
    return r->loop;
}

#endif
