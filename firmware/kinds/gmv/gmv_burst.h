/* Bursting: a self-tuner whose gains have drifted while nothing was learnt begins to swing, until the swing itself teaches it
 * better. Ours: the MV's moves in the last 16 steps or so against those of the last 256, while the setpoint rests.
 *
 * What swings turns again and again, a load is answered in one direction and perhaps back: so several turns are wanted within the
 * last 64 steps or so. */
#ifndef REFLUX_GMV_GMV_BURST_H
#define REFLUX_GMV_GMV_BURST_H

#include <stdbool.h>
#include <stdint.h>

#include "kinds/gmv/gmv.h"

struct gmv_burst {
    float setpoint;
    uint32_t rests;    /* steps since the setpoint has moved, or the law begun */
    uint32_t seen;     /* steps that the long mean has */
    float soon, long_; /* mean square of the last few moves and of many, spans of the MV squared */
    float last, turns; /* last move that is not small; how often they have turned of late */
};

void gmv_burst_begin(struct gmv_burst *b);
/* A step: whether it swings. ratio: of the mean squares; settled: steps after which a setpoint has been answered. */
bool gmv_burst_step(struct gmv_burst *b, float setpoint, float moved, float ratio,
                    uint32_t settled);

#endif
