/* Reasons that keep tests or a trial from beginning, or end them: plant, modes, hands, configuration. Tick, and main loop under
 * hal_tick_lock; no state. */
#ifndef REFLUX_COMMISSION_BLOCKING_H
#define REFLUX_COMMISSION_BLOCKING_H

#include "commission/reasons.h"
#include "supervise/supervisor.h"

struct commission;

/* ERR_STATE: the tests of the whole plant could not begin. *what gets a channel's or loop's name or NULL, *wanted the reason. */
MUST_CHECK enum err commission_may_begin(const struct supervisor *s, const char **what,
                                         const char **wanted);
/* ERR_STATE: a relay test of that loop could not begin. Likewise. */
MUST_CHECK enum err commission_may_relay(const struct supervisor *s, uint8_t loop,
                                         const char **what, const char **wanted);
/* ERR_STATE: a trial could not begin. Likewise. */
MUST_CHECK enum err commission_may_try(const struct commission *c, const struct supervisor *s,
                                       const char **what, const char **wanted);

/* Another configuration is in force, or the outputs have been safe since tests or a trial began: REASON_CONFIG, REASON_SAFE, or
 * REASON_NOT. Ends whatever start-up does. */
enum commission_reason commission_interruption(const struct commission *c,
                                               const struct supervisor *s);
/* Reason for which a trial cannot begin or go on; REASON_NOT: none. */
enum commission_reason blocking_reason(const struct commission *c, const struct supervisor *s,
                                       const char **subject);
/* Reason for which tests have to end that the tests themselves do not see; REASON_NOT: none. */
enum commission_reason commission_disturbance(const struct commission *c,
                                              const struct supervisor *s, const char **subject);

#endif
