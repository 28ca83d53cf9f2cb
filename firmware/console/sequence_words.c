/* Texts on sequences, for the commands that are not about them. */
#include "console/sequence_words.h"
#include "console/phrases.h"

#include "exchange/sequence_rows.h"

void step_number(struct text *line, unsigned k)
{
    text_str(line, "step ");
    text_u32(line, k + 1u);
}

void sequence_headline(const struct service *s, struct text *line)
{
    const struct sequence *q = &s->supervisor->sequence;
    if (q->state == SEQUENCE_IDLE)
        return;
    text_str(line, sequence_kind_text(q->kind));
    put_word(line, sequence_state_text(q->state));
    text_str(line, " at ");
    step_number(line, q->step);
    if (q->state != SEQUENCE_HELD && q->state != SEQUENCE_ABORTED)
        return;
    put_reason(line, sequence_reason_text(q->reason));
    text_str(line, q->about[0] ? ", " : "");
    text_str(line, q->about);
}

void sequence_alarm_line(const struct service *s, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    if (sup->sequence.state != SEQUENCE_HELD &&
        (sup->sequence.state != SEQUENCE_ABORTED || sup->state != SUPERVISOR_SAFE))
        return;
    text_str(line, "SEQUENCE ");
    sequence_headline(s, line);
}

void sequence_event_words(const struct event *e, struct text *line)
{
    if (e->code != EVENT_SEQUENCE_HELD && e->code != EVENT_SEQUENCE_ABORTED)
        return;
    put_reason(line, sequence_kind_text(e->detail >> 4));
    text_str(line, ", ");
    text_str(line, sequence_reason_text(e->detail & 15u));
}

void offset_words(const struct measurement_state *state, const struct measurement_config *config,
                  struct text *line)
{
    if (!state->offset.on)
        return;
    text_str(line, ", less its offset ");
    text_float(line, config->offset.eu);
}
