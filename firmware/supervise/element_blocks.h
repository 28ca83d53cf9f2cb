/* Feedforward elements with a number (blockN): each adds corrections for its inputs to the MVs that blockN.points
 * names. They form a list in the order of the slots, behind the elements ffN. An element begins at rest when all
 * its inputs have a value. The loops on its MVs then make room for it without a bump, and fill its place when it
 * goes. Within supervise only. */
#ifndef REFLUX_SUPERVISE_ELEMENT_BLOCKS_H
#define REFLUX_SUPERVISE_ELEMENT_BLOCKS_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Adds the corrections to loop_state.feedforward, before loops take over. */
void elements_step(struct supervisor *s);
#else
#define elements_step(s) ((void)(s))
#endif

#endif
