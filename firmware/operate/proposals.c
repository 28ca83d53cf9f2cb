/* Proposals of blocks: checked whole, put into force at once or when they are accepted, and taken back.
 *
 *     the tick has one -> seen -> refused
 *                              -> in force at once, the old values kept
 *                              -> offered -> accepted: in force, the old values kept
 *                                         -> rejected, or the loops and blocks it is about have changed
 *
 * Behind an open transaction, a save, a sequence and automatic start-up it waits. One is looked at at a time. */
#include <string.h>

#include "base/crc32.h"
#include "operate/operate_internal.h"

#if CONFIG_BLOCKS

#define NONE_WAITS "no proposal waits to be accepted; `proposal` shows what there is"

/* Groups of parameters (parameter_table.c) that are settings of blocks: loop, decouple, ff, block. */
#define IS_OF_BLOCKS(group) ((group) == 4 || (group) == 5 || (group) == 6 || (group) == 16)

static struct proposal_slot *slot_of_tick(const struct operate *door)
{
    return &door->service->supervisor->proposal;
}

static uint8_t state_of(const struct operate *door)
{
    return atomic_load(&slot_of_tick(door)->state);
}

static void set_state(const struct operate *door, enum proposal_state state)
{
    atomic_store(&slot_of_tick(door)->state, (uint8_t)state);
}

/* Of all that the ids and values of a proposal go by: loops, elements and blocks by their places, and what fractions are of. */
static uint32_t shape_of(const struct config *c)
{
    uint32_t crc = 0;
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        crc = crc32_update(crc, c->measurement[i].name, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, &c->measurement[i].lo, 2 * sizeof(float));
        crc = crc32_update(crc, c->mv[i].name, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, &c->mv[i].lo, 2 * sizeof(float));
    }
    for (unsigned i = 0; i < CONFIG_LOOPS; i++) {
        crc = crc32_update(crc, c->loop[i].name, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, c->loop[i].pv, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, c->loop[i].out, CHANNEL_NAME_SIZE);
    }
    for (unsigned i = 0; i < CONFIG_FEEDFORWARDS; i++) {
        crc = crc32_update(crc, c->feedforward[i].from, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, c->feedforward[i].to, CHANNEL_NAME_SIZE);
    }
    for (unsigned i = 0; i < CONFIG_BLOCKS; i++) {
        const struct block_config *b = &c->block[i];
        crc = crc32_update(crc, b->kind, sizeof b->kind);
        crc = crc32_update(crc, b->loops, sizeof b->loops);
        crc = crc32_update(crc, b->inputs, sizeof b->inputs);
        crc = crc32_update(crc, b->points, sizeof b->points);
    }
    return crc;
}
_Static_assert(offsetof(struct measurement_config, hi) ==
                       offsetof(struct measurement_config, lo) + sizeof(float) &&
                   offsetof(struct mv_config, hi) == offsetof(struct mv_config, lo) + sizeof(float),
               "both ends of a span are looked at together");

/* ---- values into settings ---- */

static enum err refuse_proposed(struct config_fault *fault, enum err code,
                                const struct parameter *p, const char *wanted)
{
    *fault = (struct config_fault){.code = code,
                                   .group = p->group->name,
                                   .index = p->group->indexed ? (uint8_t)(p->index + 1u) : 0,
                                   .field = p->own ? p->own->name : p->field->name,
                                   .wanted = wanted};
    return code;
}

static enum err refuse_whole(struct config_fault *fault, enum err code, uint8_t block,
                             const char *wanted)
{
    *fault = (struct config_fault){.code = code,
                                   .group = "block",
                                   .index = (uint8_t)(block + 1u),
                                   .field = "proposal",
                                   .wanted = wanted};
    return code;
}

/* One value into *config; *old gets what was there. */
static enum err write_value(struct config *config, uint8_t block, const struct proposed_value *v,
                            float *old, struct config_fault *fault)
{
    struct parameter p;
    if (parameter_find_id(config, v->id, &p) != ERR_OK)
        return refuse_whole(fault, ERR_UNKNOWN, block, "names a parameter that is not there");
    if (!IS_OF_BLOCKS(p.group->id))
        return refuse_proposed(fault, ERR_UNSUPPORTED, &p, "is no setting of a block");
    if (parameter_get_number(&p, config, old) != ERR_OK)
        return refuse_proposed(fault, ERR_PARSE, &p, "is no number: it cannot be proposed");
    enum err err = parameter_set_number(&p, config, v->value);
    return err ? refuse_proposed(fault, err, &p, "is proposed with a value that is not allowed")
               : ERR_OK;
}

/* *p goes into *config whole; *back, which may be NULL, gets the way back. *at: the value that is refused. */
static enum err write_proposal(struct config *config, const struct proposal_slot *slot,
                               struct way_back *back, uint8_t *at, struct config_fault *fault)
{
    const struct block_proposal *p = &slot->is;
    *at = PROPOSAL_MAX;
    if (p->n > PROPOSAL_MAX)
        return refuse_whole(fault, ERR_FULL, slot->block, "has more values than there is room for");
    for (*at = 0; *at < p->n; (*at)++) {
        float old;
        enum err err = write_value(config, slot->block, &p->value[*at], &old, fault);
        if (err)
            return err;
        if (back)
            back->value[*at] = (struct proposed_value){p->value[*at].id, old};
    }
    return ERR_OK;
}

/* ---- what becomes of one ---- */

/* Which of its values is the parameter that a plan was refused for; PROPOSAL_MAX: none. */
static uint8_t value_refused(const struct config *config, const struct block_proposal *is,
                             const struct config_fault *fault)
{
    for (uint8_t k = 0; k < is->n && k < PROPOSAL_MAX; k++) {
        struct parameter p;
        if (parameter_find_id(config, is->value[k].id, &p) == ERR_OK &&
            strcmp(p.group->name, fault->group) == 0 && p.index + 1u == fault->index &&
            strcmp(p.own ? p.own->name : p.field->name, fault->field) == 0)
            return k;
    }
    return PROPOSAL_MAX;
}

/* It is known, until the next is, what was wrong with it. */
static void refuse_proposal(struct operate *door, uint8_t at, const struct config_fault *fault)
{
    const struct proposal_slot *slot = slot_of_tick(door);
    if (at >= PROPOSAL_MAX)
        at = value_refused(&service_plan(door->service)->config, &slot->is, fault);
    struct refused_proposal *r = &door->refused;
    char name[CHANNEL_NAME_SIZE];
    struct text t = text_on(name, sizeof name);
    *r = (struct refused_proposal){.fault = *fault, .block = slot->block, .there = true};
    if (at < slot->is.n && at < PROPOSAL_MAX)
        r->value = slot->is.value[at].value;
    service_fault_name(fault, &t);
    service_record(door->service, EVENT_PROPOSAL_REFUSED, name, r->value, (uint8_t)-fault->code);
    set_state(door, PROPOSAL_FREE);
}

/* Is whoever else changes settings done with it? */
static bool may_change(const struct operate *door)
{
    const struct service *s = door->service;
    return operate_settings_are_free(s) && !s->supervisor->testing && !operate_start_up_on_trial(s);
}

/* What the tick has given is staged; ERR_BUSY: not now, try again. */
static enum err stage_proposal(struct operate *door, struct way_back *back,
                               struct config_fault *fault)
{
    uint8_t at;
    operate_watch_tables(door->service);
    struct config *config = service_stage(door->service);
    enum err err = write_proposal(config, slot_of_tick(door), back, &at, fault);
    if (err)
        refuse_proposal(door, at, fault);
    return err;
}

/* Is any of its values another than the one there was? */
static bool changes_something(const struct block_proposal *is, const struct way_back *back)
{
    for (uint8_t k = 0; k < is->n; k++)
        if (is->value[k].value != back->value[k].value)
            return true;
    return false;
}

/* In force from the next tick on. Of what is in force already nothing is told, and the way back stays. */
static enum err adopt(struct operate *door, struct config_fault *fault)
{
    struct service *s = door->service;
    const struct proposal_slot *slot = slot_of_tick(door);
    struct way_back back = {.n = slot->is.n, .block = slot->block, .shape = door->shape};
    enum err err = stage_proposal(door, &back, fault);
    if (err)
        return err;
    if (!changes_something(&slot->is, &back)) {
        set_state(door, PROPOSAL_FREE);
        return ERR_OK;
    }
    err = service_apply(s, service_staged(s), fault);
    if (err)
        return err;
    door->back = back;
    door->refused.there = false;
    service_record(s, EVENT_BLOCK_ADOPTED, service_plan(s)->config.block[slot->block].kind,
                   (float)(slot->block + 1u), 0);
    set_state(door, PROPOSAL_FREE);
    return ERR_OK;
}

/* It waits for somebody to accept it. */
static void offer(struct operate *door)
{
    struct service *s = door->service;
    const struct proposal_slot *slot = slot_of_tick(door);
    struct config_fault fault;
    if (stage_proposal(door, NULL, &fault) != ERR_OK)
        return;
    enum err err = service_check(s, service_staged(s), &fault);
    if (err && !fault.group)
        return; /* not now */
    if (err) {
        refuse_proposal(door, PROPOSAL_MAX, &fault);
        return;
    }
    set_state(door, PROPOSAL_OFFERED);
    service_record(s, EVENT_BLOCK_PROPOSES, service_plan(s)->config.block[slot->block].kind,
                   (float)(slot->block + 1u), 0);
}

/* What it was made for is there no longer. */
static bool is_stale(struct operate *door)
{
    const struct plan *plan = service_plan(door->service);
    const struct proposal_slot *slot = slot_of_tick(door);
    struct config_fault fault;
    if (state_of(door) == PROPOSAL_GIVEN && service_in_force(door->service)->serial == slot->plan) {
        door->shape = shape_of(&service_in_force(door->service)->config);
        door->shape_serial = slot->plan;
        set_state(door, PROPOSAL_SEEN);
    }
    if (state_of(door) != PROPOSAL_GIVEN && plan->serial == door->shape_serial)
        return false;
    if (state_of(door) != PROPOSAL_GIVEN && shape_of(&plan->config) == door->shape) {
        door->shape_serial = plan->serial;
        return false;
    }
    (void)!refuse_whole(&fault, ERR_CONFLICT, slot->block,
                        "was made for other loops, blocks or spans than there are now");
    refuse_proposal(door, PROPOSAL_MAX, &fault);
    return true;
}

bool operate_poll_proposals(struct operate *door)
{
    struct config_fault fault;
    if (state_of(door) == PROPOSAL_FREE)
        return false;
    if (is_stale(door))
        return true;
    if (state_of(door) == PROPOSAL_OFFERED || !may_change(door))
        return false;
    if (slot_of_tick(door)->is.manner != PROPOSAL_AT_ONCE)
        offer(door);
    else if (adopt(door, &fault) != ERR_OK && state_of(door) != PROPOSAL_FREE && fault.group)
        refuse_proposal(door, PROPOSAL_MAX, &fault);
    return true;
}

/* ---- what clients ask ---- */

bool operate_proposal(const struct session *session, struct proposal_reading *r)
{
    const struct operate *door = session->door;
    const struct proposal_slot *slot = slot_of_tick(door);
    *r = (struct proposal_reading){.state = (enum proposal_state)state_of(door)};
    if (r->state != PROPOSAL_FREE) {
        r->block = slot->block;
        r->values = slot->is.n;
        r->at_once = slot->is.manner == PROPOSAL_AT_ONCE;
    }
    r->back = door->back.n ? &door->back : NULL;
    r->refused = door->refused.there ? &door->refused : NULL;
    return r->state != PROPOSAL_FREE || r->back || r->refused;
}

bool operate_proposed(const struct session *session, unsigned k, struct parameter *p, float *value)
{
    const struct proposal_slot *slot = slot_of_tick(session->door);
    if (state_of(session->door) == PROPOSAL_FREE || k >= slot->is.n || k >= PROPOSAL_MAX)
        return false;
    *value = slot->is.value[k].value;
    return parameter_find_id(operate_settings(session), slot->is.value[k].id, p) == ERR_OK;
}

static enum err refuse_change(struct session *session, struct answer *answer)
{
    return operate_refuse(
        answer, session->door->service->staging ? ERR_STATE : ERR_BUSY, "proposal",
        session->door->service->staging ? OPEN_ALREADY
                                        : "a sequence, a save or automatic start-up is under way");
}

static enum err answer_fault(struct answer *answer, enum err err, const struct config_fault *fault)
{
    if (!fault->group)
        return operate_refuse(answer, err, NULL, QUEUE_FULL);
    answer->more = ANSWER_CONFIG;
    answer->config = *fault;
    return err;
}

enum err operate_proposal_accept(struct session *session, struct answer *answer)
{
    struct operate *door = session->door;
    struct config_fault fault;
    enum err err = operate_admit(session, "proposal", answer);
    if (err)
        return err;
    if (state_of(door) == PROPOSAL_FREE || is_stale(door) || state_of(door) != PROPOSAL_OFFERED)
        return operate_refuse(answer, ERR_STATE, "proposal", NONE_WAITS);
    if (!may_change(door))
        return refuse_change(session, answer);
    uint8_t n = slot_of_tick(door)->is.n; /* the tick may have the place again afterwards */
    err = adopt(door, &fault);
    if (err)
        return answer_fault(answer, err, &fault);
    operate_record(session, EVENT_DO_PROPOSAL, "accept", (float)n);
    return ERR_OK;
}

enum err operate_proposal_reject(struct session *session, struct answer *answer)
{
    struct operate *door = session->door;
    enum err err = operate_admit(session, "proposal", answer);
    if (err)
        return err;
    if (state_of(door) == PROPOSAL_FREE)
        return operate_refuse(answer, ERR_STATE, "proposal", NONE_WAITS);
    set_state(door, PROPOSAL_FREE);
    operate_record(session, EVENT_DO_PROPOSAL, "reject", 0.0f);
    return ERR_OK;
}

enum err operate_proposal_back(struct session *session, struct answer *answer)
{
    struct operate *door = session->door;
    struct service *s = door->service;
    struct way_back *back = &door->back;
    struct config_fault fault;
    float present;
    enum err err = operate_admit(session, "proposal", answer);
    if (err)
        return err;
    if (!back->n)
        return operate_refuse(answer, ERR_STATE, "proposal",
                              "no proposal is in force that could be taken back");
    if (shape_of(operate_settings(session)) != back->shape)
        return operate_refuse(answer, ERR_CONFLICT, "proposal",
                              "loops, blocks or spans have changed since; `set` what is wanted");
    if (!may_change(door))
        return refuse_change(session, answer);
    operate_watch_tables(s);
    struct config *config = service_stage(s);
    for (unsigned k = back->n; !err && k-- > 0;) /* the last first: one may stand there twice */
        err = write_value(config, back->block, &back->value[k], &present, &fault);
    if (!err)
        err = service_apply(s, config, &fault);
    if (err)
        return answer_fault(answer, err, &fault);
    operate_record(session, EVENT_DO_PROPOSAL, "back", (float)back->n);
    back->n = 0;
    return ERR_OK;
}

#endif
