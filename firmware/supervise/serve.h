/* Blocks with a number (blockN): estimators, and controllers that serve loops in place of the loops' own. Within
 * supervise only.
 *
 * A loop that a block serves keeps its own controller, which follows. This controller takes over without a bump
 * when the block gives up by itself or because an input is bad, or when somebody switches it off. It acts until the
 * block is switched on (REQUEST_BLOCK) or comes into force anew. */
#ifndef REFLUX_SUPERVISE_SERVE_H
#define REFLUX_SUPERVISE_SERVE_H

#include "exchange/state.h"

#if CONFIG_BLOCKS

/* Places the blocks after a plan has come into force. old: the plan before, or NULL. */
void serve_place(struct supervisor *s, const struct plan *old);
/* Makes estimators begin anew, because the next readings may come from another plant, or hours later. */
void serve_forget(struct supervisor *s);
/* After the plant's measurements: runs the estimators, and validates their points likewise. */
void serve_estimate(struct supervisor *s);
/* Before loops take over: makes blocks without a good input give up. */
void serve_check_inputs(struct supervisor *s);
/* After loops have taken over, and whenever none of its members acts: gives follow to the blocks that need it. */
void serve_follow(struct supervisor *s);
/* Requires the block to follow before its next step. */
void serve_must_follow(struct supervisor *s, uint8_t slot);
/* Loop i has had its turn: if it is the last of its block, runs the block. */
void serve_step(struct supervisor *s, uint8_t i);
/* Tells the blocks what took effect of their last steps, when it is known for all loops
 * (loop_state.served.applied). */
void serve_back_calculate(struct supervisor *s);
/* Switches a block off or on. Returns false if there is no such block, or it cannot be switched. */
bool serve_switch(struct supervisor *s, uint8_t n, bool on);

#else

#define serve_switch(s, n, on) ((void)(s), (void)(n), (void)(on), false)

#define serve_place(s, old)        ((void)(old))
#define serve_forget(s)            ((void)(s))
#define serve_estimate(s)          ((void)(s))
#define serve_check_inputs(s)      ((void)(s))
#define serve_follow(s)            ((void)(s))
#define serve_must_follow(s, slot) ((void)(slot))
#define serve_step(s, i)           ((void)(i))
#define serve_back_calculate(s)    ((void)(s))

#endif

#endif
