/* The supervisor: one plan in force, the state of its channels and loops, and the tick that moves them.
 *
 * All functions run in the tick context. Other contexts talk to it through requests, and read snapshots
 * under hal_tick_lock.
 *
 * A tick, top to bottom (architecture: docs/tick.md)
 *     validate      readings -> fractions of span; bad ones held, then their loops go to manual
 *     requests      modes, setpoints, manual outputs asked for since the last tick
 *     sequence      what the next rows of a sequence ask for
 *     control       due loops, outer before inner
 *     compensate    static decoupler over the loops that act
 *     feed forward  added to the outputs of acting loops
 *     excite        a test signal on top, from whoever owns the excitation
 *     constrain     operating limits, rates, interlocks, safe state
 * and back-calculation with what was applied. Report and actuation are the caller's.
 */
#ifndef REFLUX_SUPERVISE_SUPERVISOR_H
#define REFLUX_SUPERVISE_SUPERVISOR_H

#include "exchange/span.h"
#include "exchange/state.h"
#include "supervise/alarms.h"
#include "supervise/safe_state.h"
#include "supervise/sequence.h"

/* Safe state, no plan yet: supervisor_take_plan comes before anything else. */
void supervisor_init(struct supervisor *s, struct event_queue *events);

/* Puts a new plan into force; it must live until the next one. Loops keep mode and state where name,
 * measurement and output are the same (settings change without a bump), others start in manual. */
void supervisor_take_plan(struct supervisor *s, const struct plan *plan);
/* CONFIG_APPLIED: once for all plans of one tick. */
void supervisor_tell_plan(struct supervisor *s);

/* Which configured channels the plant has. Cleared by supervisor_unbind, then told one by one. */
void supervisor_unbind(struct supervisor *s);
void supervisor_bind_measurement(struct supervisor *s, uint8_t index);
void supervisor_bind_mv(struct supervisor *s, uint8_t index);

/* The safe state (safe_state.h), and readings are forgotten: what comes next may come from another plant. */
void supervisor_go_safe(struct supervisor *s, const char *reason);

/* One request. Call before supervisor_control (after supervisor_validate, so that it meets this sample), or
 * while no plant is there. Whether mode, setpoint or output are now as asked; an event says so too. */
bool supervisor_request(struct supervisor *s, const struct request *request);

/* Test signal on output j from the next tick on, fraction of span; it stays until it is changed, and is taken
 * away with the safe state. Whoever excites has found out that nobody else does. */
void supervisor_excite(struct supervisor *s, uint8_t j, num_t fraction);

void supervisor_validate(struct supervisor *s, const struct tick_input *input);
/* Sequence, control, compensate, feed forward, constrain, and back-calculation. */
void supervisor_control(struct supervisor *s);

#endif
