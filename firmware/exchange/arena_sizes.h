/* How much of the arena (supervise/arena.h) a plan needs. The check of a plan uses it, and so does the tick when it
 * places states. */
#ifndef REFLUX_EXCHANGE_ARENA_SIZES_H
#define REFLUX_EXCHANGE_ARENA_SIZES_H

#include "exchange/state.h"

/* Counts how many places of each kind the plan needs. */
void arena_count(const struct plan *plan, uint8_t n[PLACED_KINDS]);
/* Returns the bytes of this many places, in whole grains. */
uint32_t arena_state_bytes(const uint8_t n[PLACED_KINDS]);
/* Return the bytes of one state of that kind, and the grains of n of them. */
uint32_t arena_kind_bytes(enum placed kind);
uint32_t arena_kind_grains(enum placed kind, uint8_t n);

/* Returns the grains of a history of applied inputs that goes back this many base ticks. */
uint32_t arena_history_grains(uint16_t ticks);

#endif
