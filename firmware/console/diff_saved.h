/* `diff saved`: what differs from the stored settings. A board without it refuses the word. */
#ifndef REFLUX_CONSOLE_DIFF_SAVED_H
#define REFLUX_CONSOLE_DIFF_SAVED_H

#include "console/reply.h"

#if CONFIG_PEOPLE
/* Begins the listing, or refuses it. */
void diff_saved(struct client *c);
#else
static inline void diff_saved(struct client *c)
{
    (void)c;
}
#endif

#endif
