#ifndef REFLUX_GMV_GMV_PROPOSALS_STATE_H
#define REFLUX_GMV_GMV_PROPOSALS_STATE_H

#include <string.h>

#include "kinds/gmv/gmv_proposals.h"

struct gmv_proposals {
    /* A proposal is under way, and has been handed over. */
    bool open, handed_over;
    /* Number of adopted parameters that are in the settings. */
    uint8_t stored;
    /* theta of the settings; the parameters adopted last. */
    float theta[GMV_LOOPS][GMV_PARAMETERS], adopted[GMV_LOOPS][GMV_PARAMETERS];
};

/* A proposal is under way. */
static inline bool gmv_proposals_open(const struct gmv_proposals *s)
{
    return s->open;
}

/* Number of adopted parameters that are in the settings. */
static inline uint8_t gmv_proposals_stored(const struct gmv_proposals *s)
{
    return s->stored;
}

/* Withdraws the proposal. */
static inline void gmv_proposals_withdraw(struct gmv_proposals *s)
{
    s->open = false;
}

static inline void gmv_proposals_configure(struct gmv_proposals *s,
                                           const float theta[GMV_LOOPS][GMV_PARAMETERS])
{
    memcpy(s->theta, theta, sizeof s->theta);
}

/* Starts the self-tuner again from theta of the settings. */
static inline void gmv_proposals_restore(const struct gmv_proposals *s, struct gmv *g)
{
    gmv_start_again(g, s->theta);
}

#endif
