#ifndef REFLUX_GMV_GMV_SHADOW_STATE_H
#define REFLUX_GMV_GMV_SHADOW_STATE_H

#include "base/assertion.h"
#include "kinds/gmv/gmv_shadow.h"
#include "kinds/gmv/gmv_shape.h"
#include "signal/pid.h"

struct gmv_shadow {
    struct pid pi[GMV_LOOPS];
    /* Inputs of the last step. */
    num_t pv[GMV_LOOPS], setpoint[GMV_LOOPS];
};

static inline void gmv_shadow_back_calculate(struct gmv_shadow *s, unsigned i, num_t applied,
                                             uint8_t clamp)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    pid_back_calculate(&s->pi[i], applied, clamp);
}

/* Loop i's PI goes on from this output. */
static inline void gmv_shadow_follow(struct gmv_shadow *s, unsigned i, num_t applied)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    pid_follow(&s->pi[i], s->setpoint[i], s->pv[i], applied);
}

/* Returns the output of loop i's PI. */
static inline num_t gmv_shadow_step(struct gmv_shadow *s, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return pid_step(&s->pi[i], s->setpoint[i], s->pv[i]);
}

/* Takes setpoints and PVs of a step. */
static inline void gmv_shadow_take(struct gmv_shadow *s, const struct block_io *io, unsigned loops)
{
    REFLUX_ASSERT(loops <= GMV_LOOPS);
    for (unsigned i = 0; i < loops; i++) {
        s->pv[i] = io->members.in[i];
        s->setpoint[i] = io->members.setpoint[i];
    }
}

#endif
