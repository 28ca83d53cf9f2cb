#include "supervise/verbs.h"

#include "exchange/block_settings.h"

static const struct block_kind *kind_of_request(const struct supervisor *s, const struct request *r)
{
    uint8_t kind =
        r->output < CONFIG_BLOCKS ? s->block[BLOCK_NUMBERED + r->output].kind : PLAN_NONE;
    return kind == PLAN_NONE ? NULL : block_kinds[kind];
}

bool verb_exists(const struct supervisor *s, const struct request *r)
{
    const struct block_kind *kind = kind_of_request(s, r);
    return kind && r->mode < kind->verbs;
}

bool verb_run(struct supervisor *s, const struct request *r)
{
    uint8_t n = r->output, block = (uint8_t)(BLOCK_NUMBERED + n);
    const struct block_verb *verb = &kind_of_request(s, r)->verb[r->mode];
    const char *reason = "off";
    char name[CHANNEL_NAME_SIZE];
    if (!s->block[block].off)
        reason = verb->run(supervisor_block(s, block), r->loop ? &r->value : NULL);
    if (reason) {
        event_put(s->events, s->time_ms, EVENT_BLOCK_REFUSED, reason, (float)(n + 1u), 0);
        return false;
    }
    block_word_name(n, verb->name, name);
    event_put(s->events, s->time_ms, EVENT_BLOCK_VERB, name, r->loop ? r->value : 0.0f, 0);
    return true;
}
