/* Texts on blocks (blockN), for the commands that are not about blocks. */
#include "console/block_words.h"
#include "console/phrases.h"

#include <string.h>

#include "exchange/tables.h"

void block_event_words(const struct event *e, struct text *line)
{
    if (e->code == EVENT_PROPOSAL_REFUSED) {
        put_reason(line, err_text((enum err) - (int)e->detail));
    }
    if (e->code != EVENT_BLOCK_EVENT && e->code != EVENT_BLOCK_ALARM)
        return;
    const struct block_kind *kind = e->detail < block_kind_count ? block_kinds[e->detail] : NULL;
    const char *code = strchr(e->subject, '.');
    for (unsigned k = 0; kind && code && k < kind->events; k++) {
        if (strcmp(code + 1, kind->event[k].code) == 0) {
            put_reason(line, kind->event[k].words);
        }
    }
}

/* Writes that a block has given up (0), or the k-th event of its kind (k + 1) where that is an alarm and holds. */
static void alarm_of_block(const struct session *session, uint8_t block, unsigned what,
                           struct text *line)
{
    struct block_reading r;
    if (!operate_block(session, block, &r) || !r.kind)
        return;
    if (what == 0 && r.gave_up && strcmp(r.gave_up, "asked") != 0) {
        text_str(line, "BLOCK_GAVE_UP ");
        put_block(line, block);
        put_word(line, r.gave_up);
    }
    if (what == 0 || what > r.kind->events)
        return;
    const struct block_event *event = &r.kind->event[what - 1u];
    const struct plan *plan = service_in_force(session->door->service);
    for (unsigned i = 0; i < CONFIG_ALARMS; i++)
        if (plan->alarm[i] == ALARM_OF_EVENT(block, what - 1u))
            return; /* that entry has a line of its own, or is shelved */
    if (event->level != BLOCK_ALARM || !(r.raised & (1u << (what - 1u))))
        return;
    char name[CHANNEL_NAME_SIZE];
    block_word_name(block, event->code, name);
    text_str(line, "BLOCK_ALARM ");
    text_str(line, name);
    put_word(line, event->words);
}

void block_alarm_line(const struct session *session, unsigned n, struct text *line)
{
    unsigned lines = BLOCK_EVENTS_MAX + 1u; /* of a block */
    alarm_of_block(session, (uint8_t)(n / lines), n % lines, line);
}

/* ---- refusals ---- */

bool block_value_words(enum err code, const struct answer *a, struct text *t)
{
    bool table = code == ERR_FULL && !a->value.needed;
    const char *reason = code == ERR_FULL    ? "' refused, bytes needed: "
                         : code == ERR_STATE ? "' refused, the block has no kind; set that first"
                         : code == ERR_UNSUPPORTED
                             ? "' refused, this build lacks the kind of the block"
                         : code == ERR_CONFLICT ? "' refused, a name stands in it twice"
                                                : NULL;
    if (!reason)
        return false;
    parameter_name(&a->value.parameter, t);
    if (table) {
        text_str(t, ": " TABLES_TAKEN);
        return true;
    }
    text_str(t, ": '");
    text_str(t, a->value.text ? a->value.text : ""); /* no block has a secret */
    text_str(t, reason);
    if (code == ERR_FULL) {
        text_u32(t, a->value.needed);
        text_str(t, ", there are: ");
        text_u32(t, a->value.free);
    }
    return true;
}

bool block_answer_words(const struct answer *a, struct text *t)
{
    if (a->more != ANSWER_VERBS)
        return false;
    const struct block_kind *kind = a->kind;
    text_str(t, kind->verbs ? "no such verb; its kind has:" : "its kind has no verbs");
    for (unsigned v = 0; v < kind->verbs; v++) {
        put_word(t, kind->verb[v].name);
    }
    if (kind->stage != STAGE_ESTIMATE) /* nothing could stand in for an estimator */
        text_str(t, "; `block N on|off` switches it");
    return true;
}

/* ---- completion ---- */

static bool is_word(const char *word, size_t size, const char *name)
{
    return strlen(name) == size && memcmp(word, name, size) == 0;
}

unsigned block_choice(const struct session *session, const char *word_kind, size_t size,
                      const char *name, unsigned n, struct text *word)
{
    const struct config *config = operate_settings(session);
    if (is_word(word_kind, size, "BLOCK")) {
        if (n < CONFIG_BLOCKS && config->block[n].kind[0])
            text_u32(word, n + 1u);
        return CONFIG_BLOCKS;
    }
    struct block_reading r;
    struct answer a;
    uint8_t block;
    if (!is_word(word_kind, size, "VERB") ||
        operate_find_block(session, name, &block, &a) != ERR_OK ||
        !operate_block(session, block, &r) || !r.kind)
        return 0;
    if (n < r.kind->verbs)
        text_str(word, r.kind->verb[n].name);
    return r.kind->verbs;
}

unsigned block_kind_choice(const struct parameter *p, unsigned n, struct text *word)
{
    if (p->field->type != PARAMETER_KIND)
        return 0;
    if (block_kind_is_numbered((uint8_t)n))
        text_str(word, block_kinds[n]->name);
    return block_kind_count;
}

/* ---- parameters ---- */

bool is_of_unknown_block(const struct parameter *p, const struct config *config)
{
    return is_in_block(p) && block_is_unknown(config, p->index);
}

void block_group_name(struct text *t)
{
    put_word(t, parameter_blocks.name);
}

bool switched_off_words(const struct session *session, struct text *t)
{
    struct parameter p;
    uint8_t block;
    float value;
    text_str(t, "# switched off meanwhile:");
    unsigned k = 0;
    for (; operate_switched_off(session, true, k, &block, &p, &value); k++) {
        text_str(t, k ? ", " : " ");
        parameter_name(&p, t);
    }
    return k > 0;
}
