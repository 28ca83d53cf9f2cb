#ifndef REFLUX_GMV_GMV_LEARNER_STATE_H
#define REFLUX_GMV_GMV_LEARNER_STATE_H

#include "base/assertion.h"
#include "kinds/gmv/gmv_learner.h"

struct gmv_learner {
    struct gmv_predicted predicted[GMV_LOOPS];
    /* Bytes from the beginning of the learner to each loop's estimator. */
    uint32_t rls_offset[GMV_LOOPS];
};

static inline const struct rls *gmv_learner_rls(const struct gmv_learner *l, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return (const struct rls *)(const void *)((const char *)l + l->rls_offset[i]);
}

static inline const struct gmv_predicted *gmv_learner_predicted(const struct gmv_learner *l,
                                                                unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return &l->predicted[i];
}

#endif
