#include "supervise/restart_sequence.h"

#include "supervise/sequence.h"
#include "supervise/sequence_act.h"

bool restart_in_sequence(const struct restart_sequence *kept)
{
    return kept->kind != SEQUENCE_NONE;
}

bool restart_with_offsets(const struct restart_sequence *kept)
{
    return kept->offsets != 0;
}

void restart_tell_interrupted(struct supervisor *s, const struct restart_sequence *kept)
{
    if (restart_in_sequence(kept))
        sequence_interrupted(s, kept->kind, kept->step);
}

/* With another configuration the names of the measurements are unknown. */
void restart_offsets_gone(struct supervisor *s, const struct restart_sequence *kept, bool same)
{
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (kept->offsets & 1u << i)
            event_put(s->events, s->time_ms, EVENT_OFFSET,
                      same ? s->plan->config.measurement[i].name : NULL, 0.0f, 0);
}

void restart_offsets_back(struct supervisor *s, const struct restart_sequence *kept)
{
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (kept->offsets & 1u << i)
            measurement_offset(s, i, true);
}

void restart_keep_sequence(struct restart_sequence *kept, const struct supervisor *s)
{
    kept->offsets = 0;
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (i < s->placed[PLACED_MEASUREMENTS] && s->measurement[i].offset.on)
            kept->offsets = (uint16_t)(kept->offsets | 1u << i);
    kept->kind = sequence_active(&s->sequence) ? s->sequence.kind : SEQUENCE_NONE;
    kept->step = s->sequence.step;
}
