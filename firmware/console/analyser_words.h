/* Words on measurements that do not come in every tick. On a board without analysers they are empty. */
#ifndef REFLUX_CONSOLE_ANALYSER_WORDS_H
#define REFLUX_CONSOLE_ANALYSER_WORDS_H

#include "service/service.h"

#if CONFIG_ANALYSERS
/* ", sampled at 120 s", behind the latest reading of an analyser. */
void sampled_words(const struct supervisor *s, unsigned n, const struct measurement_config *config,
                   struct text *line);
#else
static inline void sampled_words(const struct supervisor *s, unsigned n,
                                 const struct measurement_config *config, struct text *line)
{
    (void)s;
    (void)n;
    (void)config;
    (void)line;
}
#endif

#endif
