/* Texts on sequences. On a board without sequences every function is empty. */
#ifndef REFLUX_CONSOLE_SEQUENCE_WORDS_H
#define REFLUX_CONSOLE_SEQUENCE_WORDS_H

#include "service/service.h"

#if CONFIG_STEPS

#define SEQUENCE_ALARM_LINES 1u
/* "start held at step 7: guard, CW"; nothing where no sequence is under way, nor has been. */
void sequence_headline(const struct service *s, struct text *line);
/* The same where a sequence is held, or was aborted and the loops are in the safe state. */
void sequence_alarm_line(const struct service *s, struct text *line);
/* ": start, guard", which sequence was held or aborted, and why. */
void sequence_event_words(const struct event *e, struct text *line);
/* ", less its offset 2.5", behind a reading from which a sequence subtracts an offset. */
void offset_words(const struct measurement_state *state, const struct measurement_config *config,
                  struct text *line);
/* "step 7"; k counts from 0. */
void step_number(struct text *line, unsigned k);

#else
#define SEQUENCE_ALARM_LINES 0u
static inline void sequence_alarm_line(const struct service *s, struct text *line)
{
    (void)s;
    (void)line;
}
static inline void sequence_event_words(const struct event *e, struct text *line)
{
    (void)e;
    (void)line;
}
static inline void offset_words(const struct measurement_state *state,
                                const struct measurement_config *config, struct text *line)
{
    (void)state;
    (void)config;
    (void)line;
}
#endif

#endif
