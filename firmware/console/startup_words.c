/* Texts on automatic start-up, for the commands that are not about it. */
#include "console/startup_words.h"

#include "commission/sensor_advice.h"
#include "commission/words.h"
#include "console/phrases.h"

void startup_event_words(const struct event *e, struct text *line)
{
    static const char *const sensors[] = {[SENSOR_RARE] = "it is renewed rarely",
                                          [SENSOR_COARSE] = "it reads in coarse steps",
                                          [SENSOR_LOST] = "its span is too wide"};
    bool watched = e->code >= EVENT_WATCH_ENDED && e->code <= EVENT_WATCH_SIGN;
    if (e->code == EVENT_COMMISSION_ENDED || e->code == EVENT_TRIAL_FAILED ||
        (watched && e->detail != REASON_NOT))
        put_reason(line, commission_reason_text((enum commission_reason)e->detail));
    else if (e->code == EVENT_NOT_DETERMINED)
        put_reason(line, e->detail == 0 ? "the pairing is not determined"
                                        : words_of_no_design((enum err)(-(int)e->detail)));
    else if (e->code == EVENT_SENSOR_POOR && e->detail >= SENSOR_RARE && e->detail <= SENSOR_LOST)
        put_reason(line, sensors[e->detail]);
}

bool startup_answer_words(const struct answer *a, struct text *t)
{
    if (a->more != ANSWER_TAKEN)
        return false;
    workspace_refusal(a->workspace, t);
    return true;
}

bool work_cost_line(const struct service *s, struct text *line)
{
    text_str(line, "work"); /* the unit is that of the ticks */
    text_named_u32(line, "n", s->work_cost.n);
    text_named_u32(line, "max", s->work_cost.highest);
    text_named_u32(line, "thousands", s->work_cost.sum.thousands);
    return true;
}
