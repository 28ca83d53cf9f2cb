/* Compensators with a number (blockN) stand between the loops' controllers and their MVs. They form a list in the
 * order of the slots, behind the static decoupler, with which they share no loops. Within supervise only.
 *
 * Forwards, each compensator takes the outputs of its members' controllers, or of the compensators before it, and
 * gives MVs (less feedforward). Backwards, from the end of the list, each turns what took effect of the MVs into
 * what took effect of the controllers' outputs. If the members of a compensator, the set of those that act, or its
 * settings change, it finds the inputs for the present outputs. So do the compensators before it with the same
 * loops; no other is touched.
 *
 * If a compensator gives up, is switched off or gives an output that is not a number, its members' MVs stay for
 * that tick. From the next tick on its inputs pass through it unchanged, which begins with a bumpless transfer. */
#ifndef REFLUX_SUPERVISE_COMPENSATE_BLOCKS_H
#define REFLUX_SUPERVISE_COMPENSATE_BLOCKS_H

#include "exchange/state.h"

/* A command beyond this, in spans, may have reached the end of num_t's range. */
#define COMMAND_MAX 100.0f

#if CONFIG_BLOCKS

/* Returns the loops that need a bumpless transfer because one of their compensators does: bit i. */
uint32_t compensators_regroup(struct supervisor *s);
/* Turns v[loop] of those loops from the outputs found, less feedforward, into the controllers' outputs. */
void compensators_transfer(struct supervisor *s, num_t *v);
/* Turns u[loop] from the controllers' outputs into the MVs, less feedforward. */
void compensators_step(struct supervisor *s, num_t *u);
/* Writes to told[loop], for members, what took effect of the controllers' outputs. */
void compensators_back_calculate(struct supervisor *s, num_t *told);

#else

#define compensators_regroup(s)              0u
#define compensators_transfer(s, v)          ((void)(v))
#define compensators_step(s, u)              ((void)(u))
#define compensators_back_calculate(s, told) ((void)(told))

#endif

#endif
