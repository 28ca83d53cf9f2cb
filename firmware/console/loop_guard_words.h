/* Words on doubtful measurements, on loops far from their setpoints, and on loops that the board has put into manual. A board that does not
 * watch for them has none. */
#ifndef REFLUX_CONSOLE_LOOP_GUARD_WORDS_H
#define REFLUX_CONSOLE_LOOP_GUARD_WORDS_H

#include "base/event.h"
#include "service/service.h"

#if CONFIG_LOOP_GUARD

#define DEVIATION_LINES CONFIG_LOOPS
/* Measurement n is uncertain while a loop acts on it. */
void doubtful_line(const struct service *s, unsigned n, struct text *line);
/* Loop n is far from its setpoint, or the board has put it into manual. */
void deviation_line(const struct service *s, unsigned n, struct text *line);
/* Writes why the board has put a loop into manual, or which interlock it is, if the event says that. */
void guard_event_words(const struct event *e, struct text *line);
/* Writes what releases interlock n, if its latch alone holds it. */
void latched_words(const struct service *s, unsigned n, struct text *line);
/* Names the loops that the board has put into manual; writes nothing if there are none. */
void by_board_status(const struct service *s, struct text *line);

#else
#define DEVIATION_LINES 0u
static inline void doubtful_line(const struct service *s, unsigned n, struct text *line)
{
    (void)s;
    (void)n;
    (void)line;
}
static inline void deviation_line(const struct service *s, unsigned n, struct text *line)
{
    (void)s;
    (void)n;
    (void)line;
}
static inline void latched_words(const struct service *s, unsigned n, struct text *line)
{
    (void)s;
    (void)n;
    (void)line;
}
static inline void guard_event_words(const struct event *e, struct text *line)
{
    (void)e;
    (void)line;
}
static inline void by_board_status(const struct service *s, struct text *line)
{
    (void)s;
    (void)line;
}
#endif

#endif
