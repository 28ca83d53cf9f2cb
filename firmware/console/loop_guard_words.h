/* Lines of `alarm` on doubtful measurements and on loops far from their setpoints. A board that does not watch for them has none. */
#ifndef REFLUX_CONSOLE_LOOP_GUARD_WORDS_H
#define REFLUX_CONSOLE_LOOP_GUARD_WORDS_H

#include "service/service.h"

#if CONFIG_LOOP_GUARD

#define DEVIATION_LINES CONFIG_LOOPS
/* Measurement n is uncertain while a loop acts on it. */
void doubtful_line(const struct service *s, unsigned n, struct text *line);
/* Loop n is far from its setpoint. */
void deviation_line(const struct service *s, unsigned n, struct text *line);

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
#endif

#endif
