/* State of a block of the kind `gmv`: its parts, and what ties them together. The self-tuner itself stands behind it. */
#ifndef REFLUX_GMV_GMV_KIND_STATE_H
#define REFLUX_GMV_GMV_KIND_STATE_H

#include "kinds/gmv/gmv_lambda_state.h"
#include "kinds/gmv/gmv_moves_state.h"
#include "kinds/gmv/gmv_proposals_state.h"
#include "kinds/gmv/gmv_shadow_state.h"
#include "kinds/gmv/gmv_supervise_state.h"

struct gmv_block {
    uint8_t loops, disturbances;
    /* Members that acted in the last step, a bit each. */
    uint8_t acting;
    /* The samples have begun. */
    bool begun;
    float excite;
    num_t speed, gain_least;
    struct gmv_moves moves;
    struct gmv_supervise watch;
    struct gmv_shadow shadow;
    struct gmv_proposals proposals;
    struct gmv_lambda_search lambda;
};

static inline struct gmv *gmv_of(struct gmv_block *s)
{
    return (struct gmv *)(void *)((char *)s + ((sizeof *s + 7u) & ~(size_t)7u));
}

static inline const struct gmv *gmv_of_const(const struct gmv_block *s)
{
    return (const struct gmv *)(const void *)((const char *)s + ((sizeof *s + 7u) & ~(size_t)7u));
}

#endif
