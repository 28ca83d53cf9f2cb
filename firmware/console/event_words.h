/* An event as a line of text. */
#ifndef REFLUX_CONSOLE_EVENT_WORDS_H
#define REFLUX_CONSOLE_EVENT_WORDS_H

#include "base/event.h"
#include "base/text.h"

/* Writes time, level, code, subject, value and words. */
void event_line(const struct event *e, struct text *line);
/* Writes what the detail of an event says: ": the reading is outside the span", ", by engineer". */
void event_reasons(const struct event *e, struct text *line);

#endif
