/* Blocks (blockN): switched off and on, and asked for the verbs of their kinds. */
#include <string.h>

#include "base/assertion.h"
#include "exchange/tables.h"
#include "hal/tick.h"
#include "operate/operate_internal.h"
#include "settings/block_pool.h"

#define NO_SUCH_BLOCK "no such block; `block` lists them"

static bool is_block(const struct config *config, uint8_t block)
{
    return block < CONFIG_BLOCKS && config->block[block].kind[0];
}

static uint8_t slot_of(uint8_t block)
{
    REFLUX_ASSERT(block < CONFIG_BLOCKS);
    return (uint8_t)(BLOCK_NUMBERED + block);
}

bool operate_block(const struct session *session, uint8_t block, struct block_reading *reading)
{
    const struct service *s = session->door->service;
    const struct plan *plan = service_in_force(s);
    const struct supervisor *sup = s->supervisor;
    if (!is_block(&plan->config, block))
        return false;
    uint8_t kind = plan->block[slot_of(block)].kind;
    REFLUX_ASSERT(kind == PLAN_NONE || kind < block_kind_count);
    *reading = (struct block_reading){.kind = kind == PLAN_NONE ? NULL : block_kinds[kind],
                                      .name = plan->config.block[block].kind};
    hal_tick_lock();
    const struct numbered_state *state = &sup->numbered[block];
    REFLUX_ASSERT(state->input < BLOCK_INPUTS_MAX);
    uint8_t input = plan->numbered[block].input[state->input];
    if (sup->block[slot_of(block)].off)
        reading->gave_up = state->gave_up        ? state->gave_up
                           : input & INPUT_IS_MV ? plan->config.mv[input & ~INPUT_IS_MV].name
                                                 : plan->config.measurement[input].name;
    reading->raised = state->raised;
    reading->excites = sup->excitation.holder == block + 1u;
    if (job_is_asked(&sup->work[block]))
        reading->work = sup->work[block].late ? BLOCK_WORK_LATE : BLOCK_WORKS;
    hal_tick_unlock();
    return true;
}

const char *operate_block_value(const struct session *session, uint8_t block, unsigned i,
                                float *value)
{
    const struct service *s = session->door->service;
    struct block_reading r;
    const char *name = NULL;
    hal_tick_lock(); /* a value may be computed from several that the tick writes together */
    if (operate_block(session, block, &r) && r.kind && r.kind->describe)
        name = r.kind->describe(supervisor_block(s->supervisor, slot_of(block)), i, value);
    hal_tick_unlock();
    return name;
}

enum err operate_find_block(const struct session *session, const char *name, uint8_t *block,
                            struct answer *answer)
{
    const struct config *config = operate_settings(session);
    const char *digit = strncmp(name, "block", 5) == 0 ? name + 5 : name;
    *block = (uint8_t)PLAN_NONE;
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++) {
        bool by_number = digit[0] == (char)('1' + n) && !digit[1];
        if (!is_block(config, n) || !(by_number || strcmp(config->block[n].kind, name) == 0))
            continue;
        if (*block != PLAN_NONE)
            return operate_refuse(answer, ERR_CONFLICT, name,
                                  "several blocks are of this kind; take the number of one");
        *block = n;
    }
    return *block == PLAN_NONE ? operate_refuse(answer, ERR_UNKNOWN, name, NO_SUCH_BLOCK) : ERR_OK;
}

/* Returns the kind of a block in the settings that apply to a request made now; NULL: refused. */
static const struct block_kind *kind_asked(const struct session *session, uint8_t block,
                                           enum err *err, struct answer *answer)
{
    const struct plan *plan = service_plan(session->door->service);
    uint8_t place = is_block(&plan->config, block) ? plan->block[slot_of(block)].kind : PLAN_NONE;
    REFLUX_ASSERT(place == PLAN_NONE || place < block_kind_count);
    *err = ERR_OK;
    if (place != PLAN_NONE)
        return block_kinds[place];
    *err = is_block(&plan->config, block)
               ? operate_refuse(answer, ERR_UNSUPPORTED, plan->config.block[block].kind,
                                "this build lacks the kind, or had no room for it")
               : operate_refuse(answer, ERR_UNKNOWN, NULL, NO_SUCH_BLOCK);
    return NULL;
}

static void record_block(const struct session *session, uint8_t block, const char *word,
                         float number)
{
    char name[CHANNEL_NAME_SIZE];
    block_word_name(block, word, name);
    operate_record(session, EVENT_DO_BLOCK, name, number);
}

enum err operate_block_switch(struct session *session, uint8_t block, bool on,
                              struct answer *answer)
{
    enum err err;
    const struct block_kind *kind = kind_asked(session, block, &err, answer);
    if (!kind)
        return err;
    if (kind->stage == STAGE_ESTIMATE)
        return operate_refuse(answer, ERR_STATE, kind->name,
                              "is an estimator: no other block can write its points");
    struct request r = {
        .kind = REQUEST_BLOCK, .loop = PLAN_NONE, .output = block, .mode = (uint8_t)on};
    err = operate_request(session, &r, answer);
    if (!err)
        record_block(session, block, on ? "on" : "off", 0.0f);
    return err;
}

enum err operate_find_verb(const struct session *session, uint8_t block, const char *name,
                           uint8_t *verb, struct answer *answer)
{
    enum err err;
    const struct block_kind *kind = kind_asked(session, block, &err, answer);
    if (!kind)
        return err;
    for (*verb = 0; *verb < kind->verbs; (*verb)++)
        if (strcmp(kind->verb[*verb].name, name) == 0)
            return ERR_OK;
    (void)!operate_refuse(answer, ERR_UNKNOWN, name, NULL);
    answer->more = ANSWER_VERBS;
    answer->kind = kind;
    return ERR_UNKNOWN;
}

/* The verb takes that number, or none. */
static enum err check_verb_number(const struct block_verb *verb, const float *number,
                                  struct answer *answer)
{
    if (!number)
        return verb->number && !verb->may_lack_number
                   ? operate_refuse(answer, ERR_PARSE, verb->name, "needs a number")
                   : ERR_OK;
    if (!verb->number)
        return operate_refuse(answer, ERR_PARSE, verb->name, "takes no number");
    return *number >= verb->lo && *number <= verb->hi
               ? ERR_OK
               : operate_refuse_range(answer, verb->name, *number, verb->lo, verb->hi,
                                      verb->number);
}

enum err operate_verb(struct session *session, uint8_t block, uint8_t verb, const float *number,
                      struct answer *answer)
{
    struct service *s = session->door->service;
    enum err err;
    service_flush(s); /* the block is off, or on, in what is in force */
    const struct block_kind *kind = kind_asked(session, block, &err, answer);
    if (!kind)
        return err;
    if (verb >= kind->verbs) {
        (void)!operate_refuse(answer, ERR_UNKNOWN, NULL, NULL);
        answer->more = ANSWER_VERBS;
        answer->kind = kind;
        return ERR_UNKNOWN;
    }
    const struct block_verb *v = &kind->verb[verb];
    if (v->access == ACCESS_ENGINEER)
        err = operate_admit(session, v->name, answer);
    if (!err)
        err = check_verb_number(v, number, answer);
    if (!err && s->supervisor->block[slot_of(block)].off)
        err = operate_refuse(answer, ERR_STATE, kind->name, "is off; `block N on` first");
    if (err)
        return err;
    struct request r = {.kind = REQUEST_VERB,
                        .loop = number != NULL,
                        .output = block,
                        .mode = verb,
                        .value = number ? *number : 0.0f};
    err = operate_request(session, &r, answer);
    if (!err)
        record_block(session, block, v->name, r.value);
    return err;
}

enum err operate_block_figures(const struct parameter *p, struct config *staged, const char *text,
                               struct answer *answer)
{
    answer->value.needed = 0;
    return p->own ? ERR_FULL
                  : record_make(staged, p->index, text, &answer->value.needed, &answer->value.free);
}
