/* A loop that keeps swinging at rest although its model predicts it well: the bursting test does not see it, and its predictions
 * are no worse than ever. Ours: while the setpoint rests, the control error is far larger than the prediction error, crosses
 * zero again and again, and does not get smaller. The error after a load or a setpoint gets smaller; noise is not far above the
 * prediction error. */
#ifndef REFLUX_GMV_GMV_CYCLE_H
#define REFLUX_GMV_GMV_CYCLE_H

#include <stdbool.h>
#include <stdint.h>

struct gmv_cycle;

void gmv_cycle_begin(struct gmv_cycle *c);
/* Takes a step. Returns whether the window that ends with it has swung, and the one before. away: setpoint - PV, error: of the
 * prediction, both fractions of span; settled: steps after which a setpoint has been answered. */
bool gmv_cycle_step(struct gmv_cycle *c, float setpoint, float away, float error, uint32_t settled);
/* Returns the control error of the last whole half of a window, r.m.s., fraction of span. */
float gmv_cycle_size(const struct gmv_cycle *c);

#endif
