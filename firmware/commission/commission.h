/* Automatic start-up of a plant of which nothing is known (Johansson 1994): tests, model, analysis, proposal, adoption.
 *
 *     idle -> testing -> fitting -> (next input ...) -> analysing -> ready -> accepted -> trial -> kept
 *                 ^                                        |                                 \--> old set returns
 *                 +--- another round, while not determined-+                    kept -> watching -> kept, or old set returns
 *
 * The tick moves everything: it asks for a task (background.h) when there is something to work out, the main loop does it in
 * pieces, and its result is taken a declared number of ticks later whatever the processor's speed.
 *
 * While it tests, the loops on the tested manipulated variables stay in manual. Whatever else happens - safe state,
 * interlock, lost measurement, an operator's hand, a new configuration - ends the test, and the manipulated variables
 * go back to where they were held. Nothing is stored.
 *
 * Who calls whom, from above (a file uses those below it, never one above):
 *
 *     commission                              requests are taken, phases get their tick; the one that others include
 *     results                                 a fit or the analysis is done: repeat, go on, another round, or ready
 *     tests  by_relay  acceptance  watching   a phase each, in the tick
 *     proposal  trial_plan  expected          main loop: the proposal as settings, its trial planned, what tests would take
 *     next_test  direction  model  analysis_job  blocking  start_stop      helpers that see several parts
 *     status requests lease background test_outputs test_inputs origin adoption     a part each, with its own state
 *     experiment  analysis  kept_watch ...    methods that know nothing of start-up
 *
 * In the tick run results, tests, by_relay, analysis_single, acceptance, watching, kept_watch, next_test, direction, start_stop, status,
 * test_outputs, test_inputs, origin, adoption, trial_step, margin_probe, swing, experiment, limits, progress and combine. In the main loop run
 * interim_fit, analysis,
 * analysis_structure, certainty, test_verdict, words, expected, lease, proposal, proposal_loops, proposal_structure and trial_plan.
 * Both use commission, model, analysis_job, background, blocking, channels, requests and reasons, as the heads of these say. Only
 * analysis.c, in the main loop, uses plan/. */
#ifndef REFLUX_COMMISSION_COMMISSION_H
#define REFLUX_COMMISSION_COMMISSION_H

#include "commission/adoption.h"
#include "commission/analysis_job.h"
#include "commission/blocking.h"
#include "commission/by_relay.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/direction.h"
#include "commission/next_test.h"
#include "commission/requests.h"
#include "commission/startup_results.h"
#include "commission/status.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "supervise/supervisor.h"

/* w must live as long. */
void commission_init(struct commission *c, struct event_queue *events, struct workspace *w);
/* The job that has to be among the firmware's jobs. */
struct job *commission_job(struct commission *c);

/* ERR_STATE: `ask` makes no sense now; *wanted gets the reason in words. Main loop, under hal_tick_lock. */
MUST_CHECK enum err commission_may(const struct commission *c, enum commission_ask ask,
                                   const char **wanted);
/* Puts it to the tick, one thing at a time; abort takes the place of what the tick has not taken yet. A beginning leases the
 * workspace. Likewise. ERR_STATE, ERR_BUSY; *wanted is NULL where somebody else has the workspace (workspace_refusal()). */
MUST_CHECK enum err commission_put(struct commission *c, enum commission_ask ask,
                                   const char **wanted);

/* Somebody has looked at the results. Main loop, under hal_tick_lock. */
void commission_seen(struct commission *c);
/* Gives the results up: the workspace is free for others. Likewise. ERR_STATE: under way, or nothing to be given up. */
MUST_CHECK enum err commission_discard(struct commission *c, const char **wanted);

/* A trial runs, is asked for, or its old settings are on their way back. */
bool commission_is_on_trial(const struct commission *c);
/* The settings before the trial, from accepting on. */
struct config *commission_old(struct commission *c);

/* After commission_init(), where start-up was running or a proposal waited when the board was reset: it reports that. */
void commission_was_reset(struct commission *c);

/* Tick context, between validate and control. */
void commission_tick(struct commission *c, struct supervisor *s);

#endif
