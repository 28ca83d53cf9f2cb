#include "supervise/raised.h"

#include "exchange/block_settings.h"
#include "supervise/alarms_of_blocks.h"

void raised_tell(struct supervisor *s, uint8_t block, const struct block_io *io)
{
    uint8_t n = (uint8_t)(block - BLOCK_NUMBERED), kind = s->block[block].kind;
    uint16_t before = s->numbered[n].raised, now = 0;
    for (uint8_t k = 0; k < block_kinds[kind]->events; k++) {
        const struct block_event *event = &block_kinds[kind]->event[k];
        char name[CHANNEL_NAME_SIZE];
        if (!(io->requests.raised & (1u << k)))
            continue;
        now = (uint16_t)(now | (1u << k));
        alarms_hear(s, n, k, io->requests.event_value[k]);
        if (before & (1u << k))
            continue;
        block_word_name(n, event->code, name);
        event_put(s->events, s->time_ms,
                  event->level == BLOCK_ALARM ? EVENT_BLOCK_ALARM : EVENT_BLOCK_EVENT, name,
                  io->requests.event_value[k], kind);
    }
    s->numbered[n].raised = now & ((1u << BLOCK_EVENTS_MAX) - 1u);
}
