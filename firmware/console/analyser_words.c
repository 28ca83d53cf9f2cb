/* Words on when the reading of an analyser was sampled. */
#include "console/analyser_words.h"

#include "exchange/sampling.h"

void sampled_words(const struct supervisor *s, unsigned n, const struct measurement_config *config,
                   struct text *line)
{
    if ((config->analyser.every <= 1 && config->analyser.delay == 0) || !s->measurement[n].valid)
        return;
    text_str(line, ", sampled at ");
    text_seconds(line, sampling_at_ms(s, (uint8_t)n));
    text_str(line, " s");
}
