#include "supervise/switch_offs.h"

#include <string.h>

#include "exchange/block_settings.h"

static void forget(struct supervisor *s, uint8_t element)
{
    uint8_t *byte = &s->silenced[element / SWITCH_OFF_TERMS];
    *byte = (uint8_t)(*byte & ~(1u << element % SWITCH_OFF_TERMS));
}

static bool is_element(uint8_t element)
{
    return element < SWITCH_OFF_TERMS ? element < CONFIG_FEEDFORWARDS
                                      : element / SWITCH_OFF_TERMS < SWITCH_OFF_BYTES;
}

struct block_switch_off *switch_off_room(struct supervisor *s, uint8_t block)
{
    struct switch_off_slot *w = &s->switch_off[block - BLOCK_NUMBERED];
    if (atomic_load(&w->state) != SWITCH_OFF_FREE)
        return NULL;
    w->content.n = 0;
    return &w->content;
}

/* Writes the name of a feedforward element or term: "ff1", "block3.term2". */
static void name_element(uint8_t element, char name[CHANNEL_NAME_SIZE])
{
    uint8_t block = (uint8_t)(element / SWITCH_OFF_TERMS),
            k = (uint8_t)(element % SWITCH_OFF_TERMS);
    char word[] = "term1";
    if (block == 0) {
        memcpy(name, "ff1", 4);
        name[2] = (char)(name[2] + k);
        return;
    }
    word[4] = (char)(word[4] + k);
    block_word_name((uint8_t)(block - 1u), word, name);
}

void switch_off_hand_over(struct supervisor *s, uint8_t block, const struct block_io *io)
{
    uint8_t n = (uint8_t)(block - BLOCK_NUMBERED);
    struct switch_off_slot *w = &s->switch_off[n];
    const struct block_switch_off *is = io->requests.switch_off;
    char name[CHANNEL_NAME_SIZE];
    if (!is || !is->n || !is_element(is->element))
        return;
    for (uint8_t k = 0; k < is->n && k < SWITCH_OFF_MAX; k++)
        w->content.value[k].id = proposed_by(n, is->value[k].id);
    if (!is_switched_off(s, is->element)) {
        uint8_t *byte = &s->silenced[is->element / SWITCH_OFF_TERMS];
        *byte = (uint8_t)(*byte | 1u << is->element % SWITCH_OFF_TERMS);
        name_element(is->element, name);
        event_put(s->events, s->time_ms, EVENT_SWITCHED_OFF, name, (float)(n + 1u), 0);
    }
    w->kind = s->block[block].kind;
    atomic_store(&w->state, SWITCH_OFF_GIVEN);
}

void switch_offs_lift(struct supervisor *s)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++) {
        struct switch_off_slot *w = &s->switch_off[n];
        if (atomic_load(&w->state) != SWITCH_OFF_LIFTED)
            continue;
        forget(s, w->content.element);
        atomic_store(&w->state, SWITCH_OFF_FREE);
    }
}

void switch_off_forget_ff(struct supervisor *s, uint8_t k)
{
    forget(s, switch_off_of_ff(k));
}

bool switched_off(const struct supervisor *s, uint8_t block)
{
    return is_switched_off(s, switch_off_of_ff((uint8_t)(block - BLOCK_FEEDFORWARDS)));
}

bool switched_off_changes(struct supervisor *s, uint8_t block, struct block_io *io)
{
    uint8_t n = (uint8_t)(block - BLOCK_NUMBERED);
    bool changes = s->numbered[n].silenced != s->silenced[1 + n];
    io->requests.silenced = s->numbered[n].silenced = s->silenced[1 + n];
    return changes;
}

/* Returns true if both blocks have the same k-th values in the rows that have a value for each term. */
static bool same_term(const struct block_kind *kind, const uint8_t *a, const uint8_t *b, uint8_t k)
{
    for (uint8_t i = 0; i < kind->parameters; i++) {
        const struct block_parameter *p = &kind->parameter[i];
        size_t size = block_value_size(p->type), at = p->offset + k * size;
        if (p->cols == SWITCH_OFF_TERMS && p->rows == 1 && memcmp(a + at, b + at, size) != 0)
            return false;
    }
    return true;
}

void switch_off_forget_terms(struct supervisor *s, const struct plan *old, uint8_t block, bool same)
{
    uint8_t n = (uint8_t)(block - BLOCK_NUMBERED);
    for (uint8_t k = 0; k < SWITCH_OFF_TERMS && s->silenced[1 + n]; k++)
        if (!same || !same_term(plan_kind(s->plan, block), config_block_settings(&old->config, n),
                                config_block_settings(&s->plan->config, n), k))
            forget(s, switch_off_term(n, k));
}
