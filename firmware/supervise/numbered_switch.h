/* Blocks with a number (blockN) that give up for want of an input, or are switched off and on. Within supervise only.
 *
 * A loop that a block serves keeps its own controller, which follows, and takes over without a bump when the block gives up:
 * by itself, because an input is bad, or because it is switched off. It stays off until it is switched on (REQUEST_BLOCK), or
 * comes into force anew. */
#ifndef REFLUX_SUPERVISE_NUMBERED_SWITCH_H
#define REFLUX_SUPERVISE_NUMBERED_SWITCH_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Before loops take over: blocks without a good input give up. */
void numbered_check_inputs(struct supervisor *s);
/* Switches a block off or on. Returns false if there is none, or if nothing is to be switched. */
bool numbered_switch(struct supervisor *s, uint8_t n, bool on);
#else
#define numbered_check_inputs(s)  ((void)(s))
#define numbered_switch(s, n, on) ((void)(s), (void)(n), (void)(on), false)
#endif

#endif
