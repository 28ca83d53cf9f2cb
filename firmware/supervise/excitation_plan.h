/* What a plan that is about to come into force makes of a block's test signal. Within supervise only. */
#ifndef REFLUX_SUPERVISE_EXCITATION_PLAN_H
#define REFLUX_SUPERVISE_EXCITATION_PLAN_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Ends it where the plan changes the block, or a loop, MV or PV that it is about, or the base tick. The states have their old
 * places still. */
void excitation_meet_plan(struct supervisor *s, const struct plan *next);
#else
#define excitation_meet_plan(s, next) ((void)(next))
#endif

#endif
