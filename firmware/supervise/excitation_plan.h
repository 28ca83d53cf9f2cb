/* Effect of a plan that is about to come into force on a block's test signal. Within supervise only. */
#ifndef REFLUX_SUPERVISE_EXCITATION_PLAN_H
#define REFLUX_SUPERVISE_EXCITATION_PLAN_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Ends the excitation if the plan changes the block, an excited loop, MV or PV, or the base tick. The states must
 * still have their old places. */
void excitation_meet_plan(struct supervisor *s, const struct plan *next);
#else
#define excitation_meet_plan(s, next) ((void)(next))
#endif

#endif
