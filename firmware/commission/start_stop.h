/* Functions that concern all parts of start-up at once: it begins anew, releases the outputs, ends, and puts events. Tick. */
#ifndef REFLUX_COMMISSION_START_STOP_H
#define REFLUX_COMMISSION_START_STOP_H

#include "base/event.h"
#include "commission/reasons.h"
#include "num/real.h"
#include "supervise/supervisor.h"

struct commission;

/* Clears everything that was found before; the tests belong to the plan in force. */
void commission_forget(struct commission *c, const struct supervisor *s);
/* Takes the test signals away. */
void commission_release(struct commission *c, struct supervisor *s);
/* Ends tests or trial before their time; subject may be NULL. */
void commission_end(struct commission *c, struct supervisor *s, enum commission_reason reason,
                    const char *subject, real_t value);
/* As commission_end(), because of output j. */
void commission_end_by_output(struct commission *c, struct supervisor *s,
                              enum commission_reason reason, uint8_t j, real_t value);

/* Ends the tests because a computation refused the numbers of the present input. */
void commission_fail(struct commission *c, struct supervisor *s, real_t value);

/* Puts an event about a channel or loop; subject may be NULL. */
void commission_say(const struct commission *c, const struct supervisor *s, enum event_code code,
                    const char *subject, float value);
/* Likewise, about the whole. */
void commission_say_of_all(const struct commission *c, const struct supervisor *s,
                           enum event_code code, float value, uint8_t detail);
/* Likewise, about output j. */
void commission_say_of_output(const struct commission *c, const struct supervisor *s,
                              enum event_code code, uint8_t j, float value, uint8_t detail);
/* Likewise, about the input whose turn it is. */
void commission_say_of_input(const struct commission *c, const struct supervisor *s,
                             enum event_code code, float value, uint8_t detail);

#endif
