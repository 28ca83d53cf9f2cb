/* Feedforward elements with a record (blockN): each adds to the MVs that blockN.points names what its inputs call for. A list
 * in the order of the slots, behind the elements ffN. One begins at rest when all its inputs have a value, and the loops on
 * its MVs make room for it, as they fill its place when it goes. Within supervise only. */
#ifndef REFLUX_SUPERVISE_ELEMENT_BLOCKS_H
#define REFLUX_SUPERVISE_ELEMENT_BLOCKS_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Adds to loop_state.feedforward; before loops take over. */
void elements_step(struct supervisor *s);
#else
#define elements_step(s) ((void)(s))
#endif

#endif
