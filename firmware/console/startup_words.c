/* Texts on automatic start-up, for the commands that are not about it. */
#include "console/startup_words.h"
#include "console/phrases.h"

void startup_event_words(const struct event *e, struct text *line)
{
    if (e->code != EVENT_COMMISSION_ENDED && e->code != EVENT_TRIAL_FAILED &&
        (e->code < EVENT_WATCH_ENDED || e->code > EVENT_WATCH_SIGN || e->detail == REASON_NOT))
        return;
    put_reason(line, commission_reason_text((enum commission_reason)e->detail));
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
    return true;
}
