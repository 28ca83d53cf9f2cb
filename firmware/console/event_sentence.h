/* An event as a sentence for people, "bottom setpoint 112.5 degC". On a board without it people read what scripts read. */
#ifndef REFLUX_CONSOLE_EVENT_SENTENCE_H
#define REFLUX_CONSOLE_EVENT_SENTENCE_H

#include "console/event_words.h"
#include "console/reply.h"

#if CONFIG_PEOPLE
/* Writes time, level and a sentence with values in their units; of warnings and alarms also the code, under which the pages have it, and of
 * STARTED, for which a script may wait before it can say `mode machine`. */
void event_sentence(const struct config *config, const struct event *e, struct text *line);
#else
static inline void event_sentence(const struct config *config, const struct event *e,
                                  struct text *line)
{
    (void)config;
    event_line(e, line);
}
#endif

/* Writes an event as this client reads it. */
static inline void event_for_client(const struct client *c, const struct event *e,
                                    struct text *line)
{
    if (!CONFIG_PEOPLE || client_is_machine(c))
        event_line(e, line);
    else
        event_sentence(client_settings(c), e, line);
}

#endif
