/* Feedforward: ffN, then blocks with a number (blockN) of that stage, a list in the order of the plan. Each adds to the outputs of
 * loops that act. Within supervise only.
 *
 * One begins at rest as soon as its inputs have values, and adds nothing without them. Whenever it begins, ends, or is switched
 * off, the loops on its MVs go on from the outputs they find. */
#ifndef REFLUX_SUPERVISE_FEED_FORWARD_H
#define REFLUX_SUPERVISE_FEED_FORWARD_H

#include "exchange/state.h"

/* Computes loop_state.feedforward of all loops. before[loop]: what was added in the tick before. */
void feed_forward(struct supervisor *s, num_t *before);

#endif
