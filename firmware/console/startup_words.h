/* Texts on automatic start-up. On a board without it every function is empty. */
#ifndef REFLUX_CONSOLE_STARTUP_WORDS_H
#define REFLUX_CONSOLE_STARTUP_WORDS_H

#include "operate/operate.h"

#if COMMISSION_CHANNELS

/* ": the process gain has no sign", the reason why a start-up or a trial ended. */
void startup_event_words(const struct event *e, struct text *line);
/* "start-up has it; `commission abort` frees it", for ANSWER_TAKEN. False: the answer is another. */
bool startup_answer_words(const struct answer *a, struct text *t);
/* The line of `stats` on work between ticks. False: there is none. */
bool work_cost_line(const struct service *s, struct text *line);

#else
static inline void startup_event_words(const struct event *e, struct text *line)
{
    (void)e;
    (void)line;
}
static inline bool startup_answer_words(const struct answer *a, struct text *t)
{
    (void)a;
    (void)t;
    return false;
}
static inline bool work_cost_line(const struct service *s, struct text *line)
{
    (void)s;
    (void)line;
    return false;
}
#endif

#endif
