/* The answer of a first-order-plus-dead-time element of gain 1 to an excitation, on the points of a record: each the mean
 * of a block of samples, sample k the value at the instant k before that sample's edge acts. Exact for any block, by
 * geometric sums. */
#ifndef REFLUX_IDENTIFY_RESPONSE_H
#define REFLUX_IDENTIFY_RESPONSE_H

#include <stdint.h>

#include "identify/excitation.h"
#include "num/real.h"

/* lag: time constant in samples, [0, 1e9], 0 a plain delay; dead: dead time in samples, [0, 1e6]; block from 1; model:
 * points values. by_dead: the derivative of each by the dead time, per sample, or NULL. About 4 exponentials an edge
 * and a product or two a point and edge. */
void response_model(const struct excitation *u, real_t lag, real_t dead, uint32_t block,
                    uint32_t points, real_t *model, real_t *by_dead);

#endif
