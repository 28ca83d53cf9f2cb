/* What `tune` says where `set` would refuse its lines. */
#ifndef REFLUX_CONSOLE_TUNE_DOUBT_H
#define REFLUX_CONSOLE_TUNE_DOUBT_H

#include "console/reply.h"

#if CONFIG_PEOPLE
/* Prints a remark where these settings of a loop would not come into force. */
void print_tune_doubt(struct client *c, uint8_t loop, const struct tuning *tuning);
#else
static inline void print_tune_doubt(struct client *c, uint8_t loop, const struct tuning *tuning)
{
    (void)c;
    (void)loop;
    (void)tuning;
}
#endif

#endif
