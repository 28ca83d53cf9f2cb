/* A loop that keeps swinging at rest, with a model that predicts it well: bursting does not stand out of it, and its predictions
 * are no worse than ever. Ours: while the setpoint rests, the control error is far larger than what could not be predicted, crosses
 * zero again and again, and does not get smaller. A load, or a setpoint that is being answered, gets smaller; noise
 * is not far above what cannot be predicted. */
#ifndef REFLUX_GMV_GMV_CYCLE_H
#define REFLUX_GMV_GMV_CYCLE_H

#include <stdbool.h>
#include <stdint.h>

struct gmv_cycle {
    float setpoint, last; /* last control error that is not small */
    uint32_t rests;       /* steps since the setpoint has moved, or the law begun */
    uint32_t seen;        /* steps of this window */
    uint32_t crossings;
    uint8_t windows; /* that have swung, one after the other */
    float first, second,
        surprise; /* sums of squares: control errors of both halves, errors of predictions */
};

void gmv_cycle_begin(struct gmv_cycle *c);
/* A step: whether the window that ends with it has swung, and the one before. away: setpoint - PV, error: that of the prediction, both
 * fractions of span; settled: steps after which a setpoint has been answered. */
bool gmv_cycle_step(struct gmv_cycle *c, float setpoint, float away, float error, uint32_t settled);
/* Control error of the last whole half of a window, r.m.s., fraction of span. */
float gmv_cycle_size(const struct gmv_cycle *c);

#endif
