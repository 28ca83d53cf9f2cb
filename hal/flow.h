/* XON/XOFF on the console's line, both ways, for the ports: called where bytes arrive and where they leave, so
 * that it works while the main loop is busy.
 *
 *   towards us   past 3/4 of the receive ring XOFF goes out, ahead of all that waits; below 1/4 XON
 *   from us      after XOFF nothing but such a byte goes out, until XON (or ^C, should XON have been lost)
 *
 * All functions of one line run in the same context or with the receive interrupt held off.
 */
#ifndef REFLUX_HAL_FLOW_H
#define REFLUX_HAL_FLOW_H

#include "hal/ring.h"

#define FLOW_XON    0x11u
#define FLOW_XOFF   0x13u
#define FLOW_CANCEL 0x03u /* ^C */

struct flow {
    bool on;         /* this line does it; the plant link is binary and does not */
    bool held;       /* the other side wants nothing now */
    bool holding;    /* the other side has been asked to wait */
    uint8_t pending; /* XON or XOFF to send next, 0 = none */
};

/* A byte has arrived; false when it was XON or XOFF and belongs to nobody else. */
static inline bool flow_received(struct flow *f, uint8_t byte)
{
    if (!f->on) {
        return true;
    }
    if (byte == FLOW_XOFF) {
        f->held = true;
    } else if (byte == FLOW_XON || byte == FLOW_CANCEL) {
        f->held = false;
    }
    return byte != FLOW_XOFF && byte != FLOW_XON;
}

/* The receive ring has been filled or emptied: is there something to say? */
static inline void flow_look(struct flow *f, const struct ring *rx)
{
    uint32_t used = ring_used(rx);
    if (!f->on) {
        return;
    }
    if (!f->holding && used > rx->size / 4u * 3u) {
        f->holding = true;
        f->pending = FLOW_XOFF;
    } else if (f->holding && used < rx->size / 4u) {
        f->holding = false;
        f->pending = FLOW_XON;
    }
}

/* Bytes of the transmit ring that may go out now. */
static inline uint32_t flow_ready(const struct flow *f, const struct ring *tx)
{
    return (f->pending ? 1u : 0u) + (f->held ? 0u : ring_used(tx));
}

/* Bytes of the transmit ring that may go out now and lie in one piece; drop those that went with ring_skip. None while
 * XON or XOFF is waiting: that goes first (flow_next). */
static inline size_t flow_run(const struct flow *f, const struct ring *tx, const uint8_t **bytes)
{
    return f->pending || f->held ? 0 : ring_peek(tx, bytes);
}

/* The next byte to send; false when there is none. */
static inline bool flow_next(struct flow *f, struct ring *tx, uint8_t *byte)
{
    if (f->pending) {
        *byte = f->pending;
        f->pending = 0;
        return true;
    }
    return !f->held && ring_get(tx, byte);
}

#endif
