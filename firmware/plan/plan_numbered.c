/* Blocks with a number (blockN) in a plan: finds their members, inputs and points, and has their kinds check them. */
#include <string.h>

#include "exchange/block_settings.h"
#include "exchange/block_setup.h"
#include "exchange/numbered_setup.h"
#include "plan/plan_parts.h"

static enum err refuse_block_of(struct config_fault *fault, enum err code, uint8_t n,
                                const char *field, const char *subject, const char *wanted)
{
    return plan_refuse(fault, code, "block", n + 1u, field, subject, wanted);
}

/* Checks that loop i may be a member beside those found so far. The block takes the place of its controller, or, as
 * a compensator, stands behind it. */
static enum err check_member(const struct plan *plan, uint8_t n, uint8_t i,
                             struct config_fault *fault)
{
    const struct numbered_plan *r = &plan->numbered[n];
    const struct loop_config *l = &plan->config.loop[i];
    const struct loop_config *first = &plan->config.loop[r->member[0]];
    if (plan->loop[i].decouple)
        return refuse_block_of(fault, ERR_CONFLICT, n, "loops", l->name,
                               "takes part in the static decoupler; set decouple off");
    if (plan_has_stage(plan, n, STAGE_COMPENSATE)) {
        for (uint8_t k = 0; k < r->members; k++)
            if (r->member[k] == i)
                return refuse_block_of(fault, ERR_CONFLICT, n, "loops", l->name, "is named twice");
        if (plan->loop[i].mv == PLAN_NONE)
            return refuse_block_of(fault, ERR_CONFLICT, n, "loops", l->name,
                                   "must drive a manipulated variable itself");
        const char *uncompensated = plan_kind(plan, i)->uncompensated;
        return uncompensated
                   ? refuse_block_of(fault, ERR_CONFLICT, n, "loops", l->name, uncompensated)
                   : ERR_OK;
    }
    if (plan->server[i] != PLAN_NONE)
        return refuse_block_of(fault, ERR_CONFLICT, n, "loops", l->name,
                               "is served by another block already");
    if (r->members && (l->divisor != first->divisor || l->phase != first->phase))
        return refuse_block_of(fault, ERR_CONFLICT, n, "loops", l->name,
                               "needs the divisor and the phase of the other loops of the block");
    return ERR_OK;
}

static enum err resolve_members(struct plan *plan, uint8_t n, uint8_t most,
                                struct config_fault *fault)
{
    struct numbered_plan *r = &plan->numbered[n];
    char name[CHANNEL_NAME_SIZE];
    for (const char *at = plan->config.block[n].loops; (at = plan_next_name(at, name)) != NULL;) {
        uint8_t i = config_find_loop(&plan->config, name);
        if (i == PLAN_NONE)
            return refuse_block_of(fault, ERR_UNKNOWN, n, "loops", name,
                                   "must be the name of a configured loop");
        if (r->members >= most)
            return refuse_block_of(fault, ERR_RANGE, n, "loops", name,
                                   "is one more than this kind serves");
        enum err err = check_member(plan, n, i, fault);
        if (err)
            return err;
        if (!plan_has_stage(plan, n, STAGE_COMPENSATE))
            plan->server[i] = (uint8_t)(BLOCK_NUMBERED + n);
        r->member[r->members++] = i;
    }
    /* If the kind is unknown, nobody knows whether it serves any loops. */
    if (most && !r->members && plan->block[BLOCK_NUMBERED + n].kind != PLAN_NONE)
        return refuse_block_of(fault, ERR_EMPTY, n, "loops", plan->config.block[n].kind,
                               "must name the loops it serves");
    return ERR_OK;
}

static enum err resolve_inputs(struct plan *plan, uint8_t n, uint8_t most,
                               struct config_fault *fault)
{
    struct numbered_plan *r = &plan->numbered[n];
    char name[CHANNEL_NAME_SIZE];
    for (const char *at = plan->config.block[n].inputs; (at = plan_next_name(at, name)) != NULL;) {
        uint8_t i = config_find_measurement(&plan->config, name);
        uint8_t j = config_find_mv(&plan->config, name);
        if (i == PLAN_NONE && j == PLAN_NONE)
            return refuse_block_of(fault, ERR_UNKNOWN, n, "inputs", name,
                                   "must be a configured measurement or manipulated variable");
        if (r->inputs >= most)
            return refuse_block_of(fault, ERR_RANGE, n, "inputs", name,
                                   "is one more than this kind reads");
        r->input[r->inputs++] = i != PLAN_NONE ? i : (uint8_t)(INPUT_IS_MV | j);
    }
    return ERR_OK;
}

static enum err resolve_points(struct plan *plan, uint8_t n, uint8_t most,
                               struct config_fault *fault)
{
    struct numbered_plan *r = &plan->numbered[n];
    char name[CHANNEL_NAME_SIZE];
    for (const char *at = plan->config.block[n].points; (at = plan_next_name(at, name)) != NULL;) {
        uint8_t i = config_find_measurement(&plan->config, name);
        if (i == PLAN_NONE)
            return refuse_block_of(fault, ERR_UNKNOWN, n, "points", name,
                                   "must be the name of a configured measurement");
        if (plan->writer[i] != PLAN_NONE)
            return refuse_block_of(fault, ERR_CONFLICT, n, "points", name,
                                   plan->writer[i] == n ? "is named twice"
                                                        : "is written by another block already");
        if (r->points >= most)
            return refuse_block_of(fault, ERR_RANGE, n, "points", name,
                                   "is one more than this kind writes");
        plan->writer[i] = n;
        r->point[r->points++] = i;
    }
    return ERR_OK;
}

static enum err resolve_numbered(struct plan *plan, uint8_t n, struct config_fault *fault)
{
    struct block_place *place = &plan->block[BLOCK_NUMBERED + n];
    place->kind = config_block_kind(&plan->config, n);
    /* If this build lacks the kind, its loops stay in manual, and its points have no value (supervise/numbered_switch.c). */
    const struct block_kind *kind = place->kind == PLAN_NONE ? NULL : block_kinds[place->kind];
    enum err err = resolve_members(plan, n, kind ? kind->members_most : BLOCK_MEMBERS_MAX, fault);
    if (!err)
        err = resolve_inputs(plan, n, kind ? kind->inputs_most : BLOCK_INPUTS_MAX, fault);
    if (!err && plan_has_stage(plan, n, STAGE_FEED_FORWARD))
        err = plan_resolve_added(plan, n, fault);
    else if (!err)
        err = resolve_points(plan, n, kind ? kind->points_most : BLOCK_POINTS_MAX, fault);
    return err;
}

/* An estimator must not be its own input, not even through others. Estimators run in the order of their numbers. */
static enum err check_reads(const struct plan *plan, uint8_t n, struct config_fault *fault)
{
    const struct numbered_plan *r = &plan->numbered[n];
    for (uint8_t k = 0; k < r->inputs && !plan_has_stage(plan, n, STAGE_FEED_FORWARD); k++) {
        if (r->input[k] & INPUT_IS_MV)
            continue;
        uint8_t writer = plan->writer[r->input[k]];
        if (r->points && writer != PLAN_NONE && writer >= n)
            return refuse_block_of(fault, ERR_CYCLE, n, "inputs",
                                   plan->config.measurement[r->input[k]].name,
                                   "must be written by a block before this one");
    }
    return ERR_OK;
}

enum err plan_resolve_numbered(struct plan *plan, struct config_fault *fault)
{
    memset(plan->writer, PLAN_NONE, sizeof plan->writer);
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        plan->server[i] = PLAN_NONE;
    enum err err = ERR_OK;
    for (uint8_t n = 0; !err && n < CONFIG_BLOCKS; n++)
        if (plan->config.block[n].kind[0]) {
            plan->numbered_end = (uint8_t)(n + 1u);
            err = resolve_numbered(plan, n, fault);
        }
    for (uint8_t n = 0; !err && n < CONFIG_BLOCKS; n++)
        err = check_reads(plan, n, fault);
    return err;
}

static bool members_taken(const struct plan *plan, uint8_t block, const bool *taken)
{
    const struct numbered_plan *n = &plan->numbered[block - BLOCK_NUMBERED];
    for (uint8_t k = 0; k < n->members; k++)
        if (!taken[n->member[k]])
            return false;
    return true;
}

bool plan_setpoint_ready(const struct plan *plan, uint8_t i, const bool *taken)
{
    uint8_t outer = plan->loop[i].outer;
    if (outer == PLAN_NONE)
        return true;
    uint8_t server = plan->server[outer];
    return server == PLAN_NONE ? taken[outer] : members_taken(plan, server, taken);
}

uint8_t plan_list_controllers(struct plan *plan, uint8_t i, const bool *taken, uint8_t n)
{
    uint8_t server = plan->server[i];
    plan->listed[n++] = i;
    if (server != PLAN_NONE && members_taken(plan, server, taken) &&
        plan_has_stage(plan, (uint8_t)(server - BLOCK_NUMBERED), STAGE_CONTROL))
        plan->listed[n++] = server;
    return n;
}

/* Refuses a block that names another of a kind that it cannot use. */
static enum err check_named(const struct plan *plan, uint8_t n, struct config_fault *fault)
{
    const struct block_kind *kind = plan_kind(plan, (uint8_t)(BLOCK_NUMBERED + n));
    if (!plan_number_named(plan, n) || plan_names_a(plan, n, kind->named_kind) ||
        plan_names_other(plan, n))
        return ERR_OK;
    return refuse_block_of(fault, ERR_UNKNOWN, n, plan_names_with(kind)->name, kind->named_kind,
                           "must be the kind of the block it is the number of");
}

enum err plan_resolve_block_alarm(struct plan *plan, uint8_t alarm, struct config_fault *fault)
{
    const char *on = plan->config.alarm[alarm].on;
    uint8_t n = strncmp(on, "block", 5) == 0 && on[6] == '.' ? (uint8_t)(on[5] - '1') : PLAN_NONE;
    plan->alarm[alarm] = PLAN_NONE;
    if (n >= CONFIG_BLOCKS || !plan->config.block[n].kind[0])
        return plan_refuse(fault, ERR_UNKNOWN, "alarm", alarm + 1u, "on", on,
                           "must begin with a block that is there, like block1.CODE");
    uint8_t place = plan->block[BLOCK_NUMBERED + n].kind;
    /* The kind is kept by name, and its events are unknown here. */
    if (place == PLAN_NONE)
        return ERR_OK;
    const struct block_kind *kind = block_kinds[place];
    for (uint8_t k = 0; k < kind->events; k++) {
        if (strcmp(on + 7, kind->event[k].code) != 0)
            continue;
        plan->alarm[alarm] = ALARM_OF_EVENT(n, k);
        return ERR_OK;
    }
    return plan_refuse(fault, ERR_UNKNOWN, "alarm", alarm + 1u, "on", on,
                       "is nothing that block says; `block N` lists what it may say");
}

enum err plan_check_numbered(struct plan *plan, struct config_fault *fault)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++) {
        struct block_setup setup;
        struct block_fault reason = {0};
        if (plan->block[BLOCK_NUMBERED + n].kind == PLAN_NONE)
            continue;
        enum err of_stage = plan_check_stage(plan, n, fault);
        if (!of_stage)
            of_stage = check_named(plan, n, fault);
        if (of_stage)
            return of_stage;
        plan_setup_numbered(plan, n, &setup);
        enum err err = plan_kind(plan, (uint8_t)(BLOCK_NUMBERED + n))->check(&setup, &reason);
        if (err)
            (void)!refuse_block_of(fault, err, n, reason.field, plan->config.block[n].kind,
                                   reason.wanted);
        fault->must_be = reason.must_be;
        if (err)
            return err;
    }
    return ERR_OK;
}
