/* How much of the arena (supervise/arena.h) a plan needs: the plan is checked with it, and the tick places states by it. */
#ifndef REFLUX_EXCHANGE_ARENA_SIZES_H
#define REFLUX_EXCHANGE_ARENA_SIZES_H

#include "exchange/state.h"

/* How many places of each kind the plan needs. */
void arena_count(const struct plan *plan, uint8_t n[PLACED_KINDS]);
/* Bytes of so many. */
uint32_t arena_state_bytes(const uint8_t n[PLACED_KINDS]);
/* Bytes of one state of that kind, and grains of n of them. */
uint32_t arena_kind_bytes(enum placed kind);
uint32_t arena_kind_grains(enum placed kind, uint8_t n);

/* Grains of a history of applied inputs that goes back so many base ticks. */
uint32_t arena_history_grains(uint16_t ticks);

#endif
