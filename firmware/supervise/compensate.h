/* Compensators stand between the loops' controllers and their MVs: the static decoupler, then blocks with a number (blockN) of that
 * stage, a list in the order of the plan. The decoupler shares no loop with the others. Within supervise only.
 *
 * Forwards, each compensator takes the outputs of its members' controllers, or of the compensators before it, and
 * gives MVs (less feedforward). Backwards, from the end of the list, each turns what took effect of the MVs into
 * what took effect of the controllers' outputs. If the members of a compensator, the set of those that act, or its
 * settings change, it finds the inputs for the present outputs. So do the compensators before it with the same
 * loops; no other is touched.
 *
 * If a compensator gives up, is switched off or gives an output that is not a number, its members' MVs stay for
 * that tick. From the next tick on its inputs pass through it unchanged, which begins with a bumpless transfer. */
#ifndef REFLUX_SUPERVISE_COMPENSATE_H
#define REFLUX_SUPERVISE_COMPENSATE_H

#include "exchange/state.h"

/* A command beyond this, in spans, may have reached the end of num_t's range. */
#define COMMAND_MAX 100.0f

/* moves: the loops that begin to act or that go on from the output they find, a bit each. Returns those that need a bumpless
 * transfer because one of their compensators does. */
uint32_t compensators_regroup(struct supervisor *s, uint32_t moves);
/* Turns v[loop] of those loops from the outputs found, less feedforward, into the controllers' outputs. */
void compensators_transfer(struct supervisor *s, num_t *v);
/* Turns u[loop] from the controllers' outputs into the MVs, less feedforward. */
void compensators_step(struct supervisor *s, num_t *u);
/* Writes to told[loop], for members, what took effect of the controllers' outputs. */
void compensators_back_calculate(struct supervisor *s, num_t *told);

#endif
