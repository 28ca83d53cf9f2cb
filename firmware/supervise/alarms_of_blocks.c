#include "supervise/alarms_of_blocks.h"

void alarms_hear(struct supervisor *s, uint8_t n, uint8_t k, float value)
{
    for (uint8_t i = 0; i < s->placed[PLACED_ALARMS]; i++)
        if (s->plan->alarm[i] == ALARM_OF_EVENT(n, k))
            s->alarm[i].event.value = value;
}

float alarm_event_value(const struct supervisor *s, uint8_t i)
{
    return s->alarm[i].event.value;
}

bool alarm_event_is_raised(const struct supervisor *s, uint8_t of_event)
{
    return s->numbered[ALARM_BLOCK(of_event)].raised & (1u << ALARM_EVENT(of_event));
}
