/* Histories of applied inputs (block/applied_history.h): which MV has one, how far it goes back, and the values
 * that the tick appends. The deepest one that a block asked for serves all blocks. Within supervise only.
 *
 * If a plan keeps an MV (name and span) and the base tick, the history continues; with another depth it continues
 * with the values it has. Otherwise, and after the safe state that silence or another plant brings, it begins anew,
 * filled with the value that is applied then. */
#ifndef REFLUX_SUPERVISE_HISTORIES_H
#define REFLUX_SUPERVISE_HISTORIES_H

#include "exchange/state.h"

#if CONFIG_BLOCKS

/* Before the arena takes the places of `next`: moves the values that a history of another depth keeps to its front. */
void histories_fit(struct supervisor *s, const struct plan *next);
/* A plan has come into force, and its outputs have their places: begins histories anew, or deepens them. old: the
 * plan before, or NULL. */
void histories_place(struct supervisor *s, const struct plan *old);
/* Begins all histories anew. */
void histories_begin(struct supervisor *s);
/* At the end of the tick: appends the applied values. */
void histories_append(struct supervisor *s);
/* Returns the history of MV j, or NULL. */
const struct applied_history *history_of(const struct supervisor *s, uint8_t j);

#else

#define histories_fit(s, next)  ((void)(next))
#define histories_place(s, old) ((void)(old))
#define histories_begin(s)      ((void)(s))
#define histories_append(s)     ((void)(s))

#endif

#endif
