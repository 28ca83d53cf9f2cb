/* The supervisor: one plan in force, the state of its channels and loops, and the tick that moves them.
 *
 * All functions run in the tick context. Other contexts talk to it through requests, and read snapshots under
 * hal_tick_lock.
 *
 * A tick, top to bottom (architecture: docs/inside/tick.md)
 *     validate      readings to fractions of span; bad ones are held, then their loops go to manual; estimators
 *     requests      modes, setpoints and manual outputs asked for since the last tick
 *     sequence      the actions of the next rows of a sequence
 *     feed forward  what is added to the outputs of loops that act
 *     control       due loops, outer before inner
 *     compensate    static decoupler, then each blockN of that stage, over the loops that act
 *     excite        a test signal on top, from whoever holds the plant
 *     constrain     operating limits, rates, interlocks, safe state
 * Back-calculation with the applied values ends the tick. Report and actuation are the caller's. */
#ifndef REFLUX_SUPERVISE_SUPERVISOR_H
#define REFLUX_SUPERVISE_SUPERVISOR_H

#include "exchange/span.h"
#include "exchange/state.h"
#include "supervise/alarms.h"
#include "supervise/safe_state.h"
#include "supervise/sequence.h"

/* Starts in the safe state without a plan: supervisor_take_plan comes before anything else. */
void supervisor_init(struct supervisor *s, struct event_queue *events);

/* Puts a new plan into force; *plan must live until the next one. Loops keep mode and state if name, measurement
 * and output are the same (settings change without a bump); others start in manual. */
void supervisor_take_plan(struct supervisor *s, const struct plan *plan);
/* Reports CONFIG_APPLIED, once for all plans of one tick. */
void supervisor_tell_plan(struct supervisor *s);

/* Tell which configured channels the plant has: supervisor_unbind clears them all, and the others bind one channel
 * each. */
void supervisor_unbind(struct supervisor *s);
void supervisor_bind_measurement(struct supervisor *s, uint8_t index);
void supervisor_bind_mv(struct supervisor *s, uint8_t index);
/* The plant has lost this one: its loop goes to manual, and it waits at its safe value. */
void supervisor_unbind_mv(struct supervisor *s, uint8_t index);

/* Takes the safe state (safe_state.h) and forgets readings, because the next ones may come from another plant. */
void supervisor_go_safe(struct supervisor *s, const char *reason);

/* Carries out one request. Call it before supervisor_control (after supervisor_validate, so that it meets this
 * sample), or while no plant is there. Returns true if the request is fulfilled; an event says so too. */
bool supervisor_request(struct supervisor *s, const struct request *request);

/* Puts a test signal on output j from the next tick on, fraction of span. It stays until it is changed, and the
 * safe state ends it. The caller has made sure that nobody else excites the plant. */
void supervisor_excite(struct supervisor *s, uint8_t j, num_t fraction);

void supervisor_validate(struct supervisor *s, const struct tick_input *input);
/* Runs sequence, control, compensate, feed forward, constrain, and back-calculation. */
void supervisor_control(struct supervisor *s);

#endif
