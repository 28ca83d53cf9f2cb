/* Lines of `alarm` on doubtful measurements and on loops far from their setpoints. */
#include "console/loop_guard_words.h"

#include "console/phrases.h"

static void alarm_words(const char *code, const char *name, const char *words, struct text *line)
{
    text_str(line, code);
    put_word(line, name);
    put_word(line, words);
}

void doubtful_line(const struct service *s, unsigned n, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    if (n < sup->placed[PLACED_MEASUREMENTS] && sup->measurement[n].doubt.lasting.active)
        alarm_words("DOUBTFUL", service_in_force(s)->config.measurement[n].name,
                    "is uncertain and a loop acts on it", line);
}

void deviation_line(const struct service *s, unsigned n, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    if (n < sup->placed[PLACED_LOOPS] && sup->loop[n].deviation.lasting.active)
        alarm_words("DEVIATION", service_in_force(s)->config.loop[n].name,
                    "is far from its setpoint", line);
}
