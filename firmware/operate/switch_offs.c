/* Feedforward elements that blocks have switched off in the tick (supervise/switch_offs.h): the same made settings.
 *
 *     given -> in force, the old values kept
 *           -> in the open transaction: applied with it, or overruled in it; after `abandon` given again
 *           -> nothing, where the element has had other settings since
 *
 * Behind a save, a sequence and automatic start-up it waits. */
#include "supervise/switch_offs.h"
#include "base/assertion.h"
#include "operate/operate_internal.h"

static struct switch_off_slot *switch_off_slot_of(const struct operate *door, uint8_t n)
{
    REFLUX_ASSERT(n < CONFIG_BLOCKS);
    return &door->service->supervisor->switch_off[n];
}

static enum switch_off_state switch_off_state_of(const struct operate *door, uint8_t n)
{
    return (enum switch_off_state)atomic_load(&switch_off_slot_of(door, n)->state);
}

static void set_switch_off(const struct operate *door, uint8_t n, enum switch_off_state state)
{
    atomic_store(&switch_off_slot_of(door, n)->state, (uint8_t)state);
}

/* Its values for these settings; returns how many. Those of the block itself only while it is of the kind that gave them. */
static uint8_t values_for(const struct operate *door, const struct config *config, uint8_t n,
                          struct proposed_value *v)
{
    const struct switch_off_slot *slot = switch_off_slot_of(door, n);
    bool same_kind = config_block_kind(config, n) == slot->kind;
    uint8_t count = 0;
    for (uint8_t k = 0; k < slot->content.n && k < SWITCH_OFF_MAX; k++) {
        uint32_t id = slot->content.value[k].id;
        bool own = id >> 16 && (id & PROPOSED_SELF) == n;
        if (same_kind || !own)
            v[count++] = slot->content.value[k];
    }
    return count;
}

static enum err write_switch_off(const struct operate *door, struct config *config, uint8_t n,
                                 struct proposed_value *v, struct way_back *back,
                                 struct config_fault *fault, uint8_t *at)
{
    uint8_t count = values_for(door, config, n, v);
    operate_watch_tables(door->service);
    return proposed_write_all(config, n, v, count, back, at, fault);
}

static void adopt_or_refuse(struct operate *door, uint8_t n)
{
    struct service *s = door->service;
    struct proposed_value v[SWITCH_OFF_MAX];
    struct way_back back;
    struct config_fault fault;
    uint8_t at;
    enum err err = write_switch_off(door, service_stage(s), n, v, &back, &fault, &at);
    if (err) {
        REFLUX_ASSERT(at < SWITCH_OFF_MAX);
        operate_keep_refusal(door, n, v[at].value, &fault);
        set_switch_off(door, n, SWITCH_OFF_FREE);
        return;
    }
    err = proposed_adopt(door, v, &back, &fault);
    if (err && !fault.group)
        return; /* not now */
    if (err)
        operate_keep_refusal(door, n, 0.0f, &fault);
    set_switch_off(door, n, SWITCH_OFF_FREE);
}

/* Values that cannot be written into the transaction wait until it is over. */
static bool stage_switch_off(struct operate *door, uint8_t n)
{
    struct proposed_value v[SWITCH_OFF_MAX];
    struct config_fault fault;
    uint8_t at;
    enum err err = write_switch_off(door, service_staged(door->service), n, v, NULL, &fault, &at);
    if (!err)
        set_switch_off(door, n, SWITCH_OFF_STAGED);
    return !err;
}

static bool poll_one(struct operate *door, uint8_t n)
{
    const struct service *s = door->service;
    enum switch_off_state state = switch_off_state_of(door, n);
    bool over = state == SWITCH_OFF_GIVEN &&
                !is_switched_off(s->supervisor, switch_off_slot_of(door, n)->content.element);
    if (state == SWITCH_OFF_APPLIED || over) {
        set_switch_off(door, n, SWITCH_OFF_FREE);
        return true;
    }
    if (state != SWITCH_OFF_GIVEN)
        return false;
    if (s->staging)
        return stage_switch_off(door, n);
    if (!operate_may_change_settings(door))
        return false;
    adopt_or_refuse(door, n);
    return true;
}

bool operate_poll_switch_offs(struct operate *door)
{
    bool any = false;
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++)
        any = poll_one(door, n) || any;
    return any;
}

/* The settings that everything asked now will meet have its values. */
static bool is_in_settings(const struct operate *door, uint8_t n)
{
    const struct config *config = &service_plan(door->service)->config;
    struct proposed_value v[SWITCH_OFF_MAX];
    bool as_given = true;
    for (uint8_t k = values_for(door, config, n, v); k-- > 0;) {
        struct parameter p;
        float value;
        as_given = as_given && operate_find_proposed(config, v[k].id, &p) == ERR_OK &&
                   parameter_get_number(&p, config, &value) == ERR_OK && value == v[k].value;
    }
    return as_given;
}

void operate_transaction_over(struct operate *door, bool applied)
{
    door->service->staging = false;
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++)
        if (switch_off_state_of(door, n) == SWITCH_OFF_STAGED)
            set_switch_off(door, n,
                           !applied                  ? SWITCH_OFF_GIVEN
                           : is_in_settings(door, n) ? SWITCH_OFF_APPLIED
                                                     : SWITCH_OFF_LIFTED);
}

/* ---- what clients see ---- */

bool operate_switched_off(const struct session *session, bool applied, unsigned k, uint8_t *block,
                          struct parameter *p, float *value)
{
    const struct operate *door = session->door;
    const struct config *config = operate_settings(session);
    for (*block = 0; *block < CONFIG_BLOCKS; (*block)++) {
        struct proposed_value v[SWITCH_OFF_MAX];
        enum switch_off_state state = switch_off_state_of(door, *block);
        bool shown = applied ? state == SWITCH_OFF_APPLIED
                             : state == SWITCH_OFF_GIVEN || state == SWITCH_OFF_STAGED;
        uint8_t n = shown ? values_for(door, config, *block, v) : 0;
        if (k < n) {
            *value = v[k].value;
            return operate_find_proposed(config, v[k].id, p) == ERR_OK;
        }
        k -= n;
    }
    return false;
}
