/* Proposals of blocks: checked whole, put into force at once or when they are accepted, and taken back.
 *
 *     the tick has one -> seen -> refused
 *                              -> in force at once, the old values kept
 *                              -> offered -> accepted: in force, the old values kept
 *                                         -> rejected, or the loops and blocks it is about have changed
 *
 * Behind an open transaction, a save, a sequence and automatic start-up it waits. One is looked at at a time. */
#include <string.h>

#include "base/assertion.h"
#include "operate/operate_internal.h"

#define NONE_WAITS "no proposal waits to be accepted; `proposal` shows what there is"

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

/* ---- what becomes of one ---- */

/* Returns which of its values is the parameter that a plan was refused for; PROPOSAL_MAX: none. */
static uint8_t value_refused(const struct config *config, const struct block_proposal *is,
                             const struct config_fault *fault)
{
    for (uint8_t k = 0; k < is->n && k < PROPOSAL_MAX; k++) {
        struct parameter p;
        if (operate_find_proposed(config, is->value[k].id, &p) == ERR_OK &&
            strcmp(p.group->name, fault->group) == 0 && p.index + 1u == fault->index &&
            strcmp(p.own ? p.own->name : p.field->name, fault->field) == 0)
            return k;
    }
    return PROPOSAL_MAX;
}

/* *at: the value that it is refused for; PROPOSAL_MAX: to be found, where it is one. */
static void refuse_proposal(struct operate *door, uint8_t at, const struct config_fault *fault)
{
    const struct proposal_slot *slot = slot_of_tick(door);
    REFLUX_ASSERT(slot->block < CONFIG_BLOCKS);
    if (at >= PROPOSAL_MAX)
        at = value_refused(&service_plan(door->service)->config, &slot->content, fault);
    bool one = at < slot->content.n && at < PROPOSAL_MAX;
    operate_keep_refusal(door, slot->block, one ? slot->content.value[at].value : 0.0f, fault);
    set_state(door, PROPOSAL_FREE);
}

/* Stages the proposal of the tick. ERR_BUSY: not now, try again. */
static enum err stage_proposal(struct operate *door, struct way_back *back,
                               struct config_fault *fault)
{
    const struct proposal_slot *slot = slot_of_tick(door);
    uint8_t refused = PROPOSAL_MAX;
    enum err err;
    operate_watch_tables(door->service);
    struct config *config = service_stage(door->service);
    if (slot->content.n > PROPOSAL_MAX)
        err = proposed_refuse_whole(fault, ERR_FULL, slot->block,
                                    "has more values than there is room for");
    else
        err = proposed_write_all(config, slot->block, slot->content.value, slot->content.n, back,
                                 &refused, fault);
    if (err)
        refuse_proposal(door, refused, fault);
    return err;
}

/* Puts it into force from the next tick on. Settings that are in force already are not reported, and the way back stays. */
static enum err adopt(struct operate *door, struct config_fault *fault)
{
    const struct proposal_slot *slot = slot_of_tick(door);
    struct way_back back;
    enum err err = stage_proposal(door, &back, fault);
    if (!err)
        err = proposed_adopt(door, slot->content.value, &back, fault);
    if (!err)
        set_state(door, PROPOSAL_FREE);
    return err;
}

/* It waits for somebody to accept it. */
static void offer(struct operate *door)
{
    struct service *s = door->service;
    const struct proposal_slot *slot = slot_of_tick(door);
    REFLUX_ASSERT(slot->block < CONFIG_BLOCKS);
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

/* Its block has withdrawn it. */
static bool take_withdrawn(struct operate *door)
{
    const struct proposal_slot *slot = slot_of_tick(door);
    struct service *s = door->service;
    if (!atomic_load(&slot->withdrawn))
        return false;
    service_record(s, EVENT_PROPOSAL_WITHDRAWN, service_plan(s)->config.block[slot->block].kind,
                   (float)(slot->block + 1u), 0);
    set_state(door, PROPOSAL_FREE);
    return true;
}

/* The loops, blocks or spans have changed since. */
static bool is_stale(struct operate *door)
{
    const struct plan *plan = service_plan(door->service);
    const struct proposal_slot *slot = slot_of_tick(door);
    struct config_fault fault;
    if (state_of(door) == PROPOSAL_GIVEN && service_in_force(door->service)->serial == slot->plan) {
        door->proposals.shape = proposed_shape(&service_in_force(door->service)->config);
        door->proposals.shape_serial = slot->plan;
        set_state(door, PROPOSAL_SEEN);
    }
    if (state_of(door) != PROPOSAL_GIVEN && plan->serial == door->proposals.shape_serial)
        return false;
    if (state_of(door) != PROPOSAL_GIVEN &&
        proposed_shape(&plan->config) == door->proposals.shape) {
        door->proposals.shape_serial = plan->serial;
        return false;
    }
    (void)!proposed_refuse_whole(&fault, ERR_CONFLICT, slot->block,
                                 "is out of date: loops, blocks or spans have changed");
    refuse_proposal(door, PROPOSAL_MAX, &fault);
    return true;
}

/* Returns whether there was anything to do. */
static bool poll_proposal(struct operate *door)
{
    struct config_fault fault;
    if (state_of(door) == PROPOSAL_FREE)
        return false;
    if (take_withdrawn(door) || is_stale(door))
        return true;
    if (state_of(door) == PROPOSAL_OFFERED || !operate_may_change_settings(door))
        return false;
    if (slot_of_tick(door)->content.manner != PROPOSAL_AT_ONCE)
        offer(door);
    else if (adopt(door, &fault) != ERR_OK && state_of(door) != PROPOSAL_FREE && fault.group)
        refuse_proposal(door, PROPOSAL_MAX, &fault);
    return true;
}

bool operate_poll_proposals(struct operate *door)
{
    bool any = operate_poll_switch_offs(door);
    return poll_proposal(door) || any;
}

/* ---- what clients ask ---- */

bool operate_proposal(const struct session *session, struct proposal_reading *r)
{
    const struct operate *door = session->door;
    const struct proposal_slot *slot = slot_of_tick(door);
    *r = (struct proposal_reading){.state = (enum proposal_state)state_of(door)};
    if (r->state != PROPOSAL_FREE) {
        r->block = slot->block;
        r->values = slot->content.n;
        r->at_once = slot->content.manner == PROPOSAL_AT_ONCE;
    }
    r->back = door->proposals.back.n ? &door->proposals.back : NULL;
    r->refused = door->proposals.refused.known ? &door->proposals.refused : NULL;
    return r->state != PROPOSAL_FREE || r->back || r->refused;
}

bool operate_proposed(const struct session *session, unsigned k, struct parameter *p, float *value)
{
    const struct proposal_slot *slot = slot_of_tick(session->door);
    if (state_of(session->door) == PROPOSAL_FREE || k >= slot->content.n || k >= PROPOSAL_MAX)
        return false;
    *value = slot->content.value[k].value;
    return operate_find_proposed(operate_settings(session), slot->content.value[k].id, p) == ERR_OK;
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
    if (state_of(door) == PROPOSAL_FREE || take_withdrawn(door) || is_stale(door) ||
        state_of(door) != PROPOSAL_OFFERED)
        return operate_refuse(answer, ERR_STATE, "proposal", NONE_WAITS);
    if (!operate_may_change_settings(door))
        return refuse_change(session, answer);
    uint8_t n = slot_of_tick(door)->content.n; /* the tick may have the place again afterwards */
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
    struct way_back *back = &door->proposals.back;
    struct config_fault fault;
    float present;
    enum err err = operate_admit(session, "proposal", answer);
    if (err)
        return err;
    if (!back->n)
        return operate_refuse(answer, ERR_STATE, "proposal",
                              "no proposal is in force that could be taken back");
    if (proposed_shape(operate_settings(session)) != back->shape)
        return operate_refuse(answer, ERR_CONFLICT, "proposal",
                              "loops, blocks or spans have changed since; `set` what is wanted");
    if (!operate_may_change_settings(door))
        return refuse_change(session, answer);
    operate_watch_tables(s);
    struct config *config = service_stage(s);
    for (unsigned k = back->n; !err && k-- > 0;) /* the last first: one may stand there twice */
        err = proposed_write(config, back->block, &back->value[k], &present, &fault);
    if (!err)
        err = service_apply(s, config, &fault);
    if (err)
        return answer_fault(answer, err, &fault);
    operate_record(session, EVENT_DO_PROPOSAL, "back", (float)back->n);
    back->n = 0;
    return ERR_OK;
}
