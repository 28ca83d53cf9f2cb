/* The arena: where the states of channels, loops and blocks have their places while a plan is in force. Channels and the
 * like come first, kind by kind, as many of each as the configuration reaches (up to the last place it uses); then the
 * blocks, each with as much as its settings need, where the plan says; then the histories of applied inputs. What does not
 * fit is refused with the plan, with the bytes it needs. */
#ifndef REFLUX_SUPERVISE_ARENA_H
#define REFLUX_SUPERVISE_ARENA_H

#include "exchange/state.h"

/* The states move to where the plan puts them; new ones are zero, those it has no place for are gone. A block stays whole
 * if it is of the same kind and size as before. */
void arena_place(struct supervisor *s, const struct plan *plan);

/* That of MV j, which has one. A history stays whole if it is as deep as before; else all of it is zero. */
struct applied_history *arena_history(const struct supervisor *s, uint8_t j);

#endif
