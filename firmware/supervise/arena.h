/* The arena: the memory of the states of channels, loops and blocks while a plan is in force. First come channels
 * and the like, kind by kind, as many of each as the configuration reaches (up to the last place it uses). Then
 * come the blocks, each with as much as its settings need, where the plan says, and then the histories of applied
 * inputs. If a plan does not fit, its check refuses it with the bytes it needs. */
#ifndef REFLUX_SUPERVISE_ARENA_H
#define REFLUX_SUPERVISE_ARENA_H

#include "exchange/state.h"

/* Moves the states to their places in the plan. New states are zero, and states without a place are gone. A block's
 * state stays whole if the block has the same kind and size as before. */
void arena_place(struct supervisor *s, const struct plan *plan);

/* Returns the history of MV j, which must have one. Of a history, arena_place() keeps as many bytes as the old and
 * the new depth have in common; the rest is zero. */
struct applied_history *arena_history(const struct supervisor *s, uint8_t j);

#endif
