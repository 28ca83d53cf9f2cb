/* The phase in which the kept loops are watched: begun by an operator, ended by a sign, by a hand or by time. Tick. */
#ifndef REFLUX_COMMISSION_WATCHING_H
#define REFLUX_COMMISSION_WATCHING_H

#include "commission/kept_watch.h"
#include "commission/reasons.h"

struct commission;

/* The settings that the trial has kept are in force, and the results are still there. Also for the main loop. */
bool commission_may_watch(const struct commission *c);
/* Length of the watch that is asked for next, samples. Main loop, under hal_tick_lock, where commission_may_watch(). */
void commission_set_watch(struct commission *c, uint32_t samples);
/* The watch has been asked for. */
void commission_begin_watch(struct commission *c, struct supervisor *s);
/* A tick of it. */
void commission_watch(struct commission *c, struct supervisor *s);
/* The watch ends without a sign, for that reason; subject may be NULL. The settings stay. */
void commission_end_watch(struct commission *c, struct supervisor *s, enum commission_reason reason,
                          const char *subject);

#endif
