/* Bursting: a self-tuner whose gains have drifted while nothing was learnt begins to swing, until the swing itself teaches it
 * better. Ours: the MV's moves in the last 16 steps or so against those of the last 256, while the setpoint rests.
 *
 * A swing turns again and again; a load is answered in one direction and perhaps back. So a burst needs several turns within the
 * last 64 steps or so. */
#ifndef REFLUX_GMV_GMV_BURST_H
#define REFLUX_GMV_GMV_BURST_H

#include <stdbool.h>
#include <stdint.h>

struct gmv_burst;

void gmv_burst_begin(struct gmv_burst *b);
/* Takes a step. Returns whether the MV swings. ratio: of the mean squares; settled: steps after which a setpoint has been answered. */
bool gmv_burst_step(struct gmv_burst *b, float setpoint, float moved, float ratio,
                    uint32_t settled);
/* Returns the size of the recent moves, r.m.s., fraction of the MV's span. */
float gmv_burst_size(const struct gmv_burst *b);

#endif
