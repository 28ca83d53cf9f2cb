/* Automatic start-up of a plant of which nothing is known (Johansson 1994): tests, model, analysis, proposal, adoption.
 *
 *     idle -> testing -> fitting -> (next input ...) -> analysing -> ready -> accepted -> trial -> kept
 *                 ^                                        |                                 \--> old set returns
 *                 +--- another round, while not determined-+
 *
 * The tick moves everything: it asks for a job (base/job.h) when there is something to work out, the main loop does it in
 * pieces, and its result is taken a declared number of ticks later whatever the processor's speed.
 *
 * While it tests, the loops on the tested manipulated variables stay in manual. Whatever else happens - safe state,
 * interlock, lost measurement, an operator's hand, a new configuration - ends the test, and the manipulated variables
 * go back to where they were held. Nothing is stored.
 */
#ifndef REFLUX_COMMISSION_COMMISSION_H
#define REFLUX_COMMISSION_COMMISSION_H

#include "commission/commission_state.h"
#include "supervise/supervisor.h"

/* w must live as long. */
void commission_init(struct commission *c, struct event_queue *events, struct workspace *w);

/* Whether `ask` makes sense now; *wanted gets the reason in words where not. Main loop, under hal_tick_lock. */
MUST_CHECK enum err commission_may(const struct commission *c, enum commission_ask ask,
                                   const char **wanted);
/* Whether the tests could begin: channels, modes, room. *what gets a channel's or loop's name or NULL. Likewise. */
MUST_CHECK enum err commission_may_begin(const struct supervisor *s, const char **what,
                                         const char **wanted);
/* Whether a trial could. Likewise. */
MUST_CHECK enum err commission_may_try(const struct commission *c, const struct supervisor *s,
                                       const char **what, const char **wanted);
/* Puts it to the tick, one thing at a time; abort takes the place of what the tick has not taken yet. A beginning leases the
 * workspace. Likewise. ERR_STATE, ERR_BUSY; *wanted is NULL where somebody else has the workspace (workspace_refusal()). */
MUST_CHECK enum err commission_put(struct commission *c, enum commission_ask ask,
                                   const char **wanted);

/* Are tests, model and analysis still in the workspace, and will they be until the main loop next asks for something? Else they
 * are nothing, or may be overwritten in the midst of a look at them. Main loop. */
bool commission_keeps(const struct commission *c);
/* ... and is there a result of the analysis, or of a relay test, among them? */
bool commission_has_results(const struct commission *c);
/* ... or was there, and what is outside the workspace is of it? */
bool commission_had_results(const struct commission *c);
/* Somebody has looked at them. Main loop, under hal_tick_lock. */
void commission_seen(struct commission *c);
/* Gives them up: the workspace is free for others. Likewise. ERR_STATE: under way, or nothing to be given up. */
MUST_CHECK enum err commission_discard(struct commission *c, const char **wanted);

/* After commission_init(), where it was under way when the board was reset: it says so. */
void commission_was_reset(struct commission *c);

/* Tick context, between validate and control. c->job is to be among the firmware's jobs. */
void commission_tick(struct commission *c, struct supervisor *s);

/* Checksum of the names, spans and order of a configuration's channels, which results refer to by index. */
uint32_t commission_channels(const struct config *config);

/* Half of a double step, s, that would show the end of measurement[j]'s response to input[k], where the latest test did not:
 * until it is over but for a twentieth, as far as its time constant is known; at least twice the latest. */
real_t commission_half_needed(const struct commission *c, uint8_t j, uint8_t k);

/* Is there a proposal? */
bool commission_has_proposal(const struct commission *c);

const char *commission_reason_text(enum commission_reason reason);

#endif
