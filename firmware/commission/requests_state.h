/* The state of requests.c. */
#ifndef REFLUX_COMMISSION_REQUESTS_STATE_H
#define REFLUX_COMMISSION_REQUESTS_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "commission/phase.h"

/* The main loop writes it under hal_tick_lock. */
struct startup_requests {
    volatile uint8_t ask;           /* enum commission_ask */
    volatile uint8_t relay_loop;    /* of COMMISSION_ASK_RELAY */
    volatile bool old_wanted;       /* the main loop has to put the old settings into force */
    volatile uint32_t relay_serial; /* serial of the plan in which `relay_loop` counts */
    uint32_t trial_serial;          /* serial of the plan with the proposal */
};

/* The request that waits for the tick. */
static inline enum commission_ask requests_pending(const struct startup_requests *r)
{
    return (enum commission_ask)r->ask;
}

static inline void requests_put(struct startup_requests *r, enum commission_ask ask)
{
    r->ask = (uint8_t)ask;
}

/* The loop of a relay test, an index in the plan of that serial. */
static inline uint8_t requests_relay_loop(const struct startup_requests *r)
{
    return r->relay_loop;
}

static inline uint32_t requests_relay_serial(const struct startup_requests *r)
{
    return r->relay_serial;
}

/* The serial of the plan that a trial is asked for. */
static inline uint32_t requests_trial_serial(const struct startup_requests *r)
{
    return r->trial_serial;
}

/* The main loop has to put the old settings into force. */
static inline bool requests_want_old(const struct startup_requests *r)
{
    return r->old_wanted;
}

static inline void requests_set_want_old(struct startup_requests *r, bool wanted)
{
    r->old_wanted = wanted;
}

#endif
