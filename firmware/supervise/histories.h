/* Histories of applied inputs (block/applied_history.h): which MV has one, how far it goes back, and what the tick puts into
 * it. The deepest that a block asked for serves all. Within supervise only.
 *
 * A plan that leaves an MV (name and span) and the base tick as they are leaves the history alone; with another depth it goes on
 * with what there is of it. Else, and after the safe state that silence or another plant brings, it begins anew, full of what
 * is applied then. */
#ifndef REFLUX_SUPERVISE_HISTORIES_H
#define REFLUX_SUPERVISE_HISTORIES_H

#include "exchange/state.h"

#if CONFIG_BLOCKS

/* Before the arena has the places of `next`: what a history of another depth goes on with stands first. */
void histories_fit(struct supervisor *s, const struct plan *next);
/* A plan has come into force, and its outputs have their places. old: the one before, or NULL. */
void histories_place(struct supervisor *s, const struct plan *old);
/* All begin anew. */
void histories_begin(struct supervisor *s);
/* The tick is over: what it applied is the newest. */
void histories_append(struct supervisor *s);
/* That of MV j, or NULL. */
const struct applied_history *history_of(const struct supervisor *s, uint8_t j);

#else

#define histories_fit(s, next)  ((void)(next))
#define histories_place(s, old) ((void)(old))
#define histories_begin(s)      ((void)(s))
#define histories_append(s)     ((void)(s))

#endif

#endif
