/* Controllers with a number (blockN), which act for loops in place of the loops' own. Within supervise only. */
#ifndef REFLUX_SUPERVISE_NUMBERED_CONTROL_H
#define REFLUX_SUPERVISE_NUMBERED_CONTROL_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Lets it follow before its next step. */
static inline void numbered_must_follow(struct supervisor *s, uint8_t block)
{
    s->block[block].must_follow = true;
}
/* The next samples may come from another plant, or hours later, so estimators begin anew and controllers follow. */
void numbered_forget(struct supervisor *s);
/* After loops have taken over, and whenever none of its members acts: the blocks that have to follow do. */
void controllers_follow(struct supervisor *s);
/* All its members have had their turns: steps it, if its turn is due. */
void numbered_control(struct supervisor *s, uint8_t block);
/* Tells them what took effect of their last steps, once it is known for all loops (loop_applied()). */
void controllers_back_calculate(struct supervisor *s);
#else
#define numbered_must_follow(s, block) ((void)(block))
#define numbered_forget(s)             ((void)(s))
#define controllers_follow(s)          ((void)(s))
#define numbered_control(s, block)     ((void)(block))
#define controllers_back_calculate(s)  ((void)(s))
#endif

#endif
