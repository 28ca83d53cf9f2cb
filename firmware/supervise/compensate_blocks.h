/* Compensators with a record (blockN): between the loops' controllers and their MVs, a list in the order of the slots, behind
 * the static decoupler, whose loops they do not share. Within supervise only.
 *
 * Forwards each takes what its members' controllers gave, or what the compensators before it made of that, and gives MVs (less
 * feedforward). Backwards, from the end, each turns what became of the MVs into what became of the controllers' outputs. One
 * whose members, or which of them act, or whose settings have changed finds the inputs for the outputs that are there, and so
 * do those before it with the same loops; no other is touched.
 *
 * One that gives up, is switched off or gives what is no number: its members' MVs stay for that tick, and from the next on
 * what goes into it comes out, which begins with a bumpless transfer. */
#ifndef REFLUX_SUPERVISE_COMPENSATE_BLOCKS_H
#define REFLUX_SUPERVISE_COMPENSATE_BLOCKS_H

#include "exchange/state.h"

/* A command beyond this, in spans, may have ended with the range of num_t. */
#define COMMAND_MAX 100.0f

#if CONFIG_BLOCKS

/* Which loops need a bumpless transfer because a compensator of theirs does: bit i. */
uint32_t compensators_regroup(struct supervisor *s);
/* v[loop]: for those loops outputs found, less feedforward; controllers' outputs then. */
void compensators_transfer(struct supervisor *s, num_t *v);
/* u[loop]: the controllers' outputs; MVs, less feedforward, then. */
void compensators_step(struct supervisor *s, num_t *u);
/* told[loop]: what took effect of the controllers' outputs, set for members. */
void compensators_back_calculate(struct supervisor *s, num_t *told);

#else

#define compensators_regroup(s)              0u
#define compensators_transfer(s, v)          ((void)(v))
#define compensators_step(s, u)              ((void)(u))
#define compensators_back_calculate(s, told) ((void)(told))

#endif

#endif
