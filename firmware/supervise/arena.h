/* The arena: where the states of channels and blocks, and dead times, have their places while a plan is in force.
 * States stand from the beginning, kind by kind, as many of each as the configuration reaches (up to the last place it
 * uses); dead-time lines from the end. What does not fit is refused with the plan, with the bytes it needs. */
#ifndef REFLUX_SUPERVISE_ARENA_H
#define REFLUX_SUPERVISE_ARENA_H

#include "supervise/plan.h"

struct supervisor;

enum placed {
    PLACED_MEASUREMENTS,
    PLACED_OUTPUTS,
    PLACED_LOOPS,
    PLACED_INTERLOCKS,
    PLACED_ALARMS,
    PLACED_FEEDFORWARDS,
    PLACED_DECOUPLER, /* one, or none */
    PLACED_KINDS
};

/* How many places of each kind the plan needs. */
void arena_count(const struct plan *plan, uint8_t n[PLACED_KINDS]);
/* Bytes of so many. */
uint32_t arena_state_bytes(const uint8_t n[PLACED_KINDS]);
/* The states move to where these counts put them; new ones are zero, those past the counts are gone. */
void arena_place(struct supervisor *s, const uint8_t n[PLACED_KINDS]);

#endif
