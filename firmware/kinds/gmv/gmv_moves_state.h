#ifndef REFLUX_GMV_GMV_MOVES_STATE_H
#define REFLUX_GMV_GMV_MOVES_STATE_H

#include <string.h>

#include "base/assertion.h"
#include "kinds/gmv/gmv_moves.h"

struct gmv_moves {
    /* The law has asked for moves. */
    bool has_asked;
    /* The loops were solved one by one. */
    bool singular;
    /* Steps since the law began to compute, up to FADE_STEPS. */
    uint8_t fading_in;
    /* Outputs that took effect last; outputs of the last step before limits. */
    num_t applied[GMV_LOOPS], given[GMV_LOOPS];
    /* Limits of the MVs, as far as they have shown; requests of the law. */
    num_t lo[GMV_LOOPS], hi[GMV_LOOPS], asked[GMV_LOOPS];
};

static inline num_t gmv_moves_applied(const struct gmv_moves *m, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return m->applied[i];
}

/* Output of loop i that took effect. */
static inline void gmv_moves_keep_applied(struct gmv_moves *m, unsigned i, num_t applied)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    m->applied[i] = applied;
}

/* The loops were solved one by one. */
static inline bool gmv_moves_singular(const struct gmv_moves *m)
{
    return m->singular;
}

/* Forgets the last request, after a gap. */
static inline void gmv_moves_break_off(struct gmv_moves *m)
{
    m->has_asked = false;
}

/* The law computes from this step on. */
static inline void gmv_moves_begin_law(struct gmv_moves *m)
{
    m->fading_in = 0;
    m->has_asked = false;
}

/* Outputs of the block before limits. */
static inline void gmv_moves_keep_given(struct gmv_moves *m, const num_t *out, unsigned loops)
{
    memcpy(m->given, out, loops * sizeof m->given[0]);
}

#endif
