#include "plan/plan_build.h"

#include <stddef.h>
#include <string.h>

#include "base/crc32.h"
#include "exchange/tables.h"
#include "plan/plan_parts.h"
#include "plan/sequence_plan.h"
#include "signal/ramp.h"

#define TICK_SHORTEST_S      0.05f
#define BLOCK_INTERVAL_MAX_S 1e5f

_Static_assert(DECOUPLER_MAX <= CONFIG_LOOPS && DECOUPLER_MAX <= 8, "a bit of a byte for each");

/* Returns true for a word that begins or ends a reply of the console. */
static bool reserved(const char *name)
{
    return strcmp(name, "ok") == 0 || strcmp(name, "err") == 0;
}

/* Returns true if signal/ramp.h takes a rate in EU/s over this span. */
static bool rate_possible(float rate_per_s, float span)
{
    float fraction = rate_per_s / span;
    return rate_per_s == 0.0f || (fraction >= 1e-9f && fraction <= 1e6f);
}

/* Returns true if the span is wide enough that float resolves its thousandths, wherever it lies. */
static bool span_possible(float lo, float hi)
{
    float reach = (lo < 0.0f ? -lo : lo) + (hi < 0.0f ? -hi : hi);
    return lo < hi && hi - lo >= 1e-4f * reach && hi - lo >= 1e-6f;
}

#define NAME_RESERVED "is a word the console keeps for itself"
#define SPAN_WANTED   "must be below hi by 0.000001 and by a ten-thousandth of |lo| + |hi|"
#define RATE_WANTED   "must be 0, or 1e-9 to 1e6 spans per second"

static enum err check_channels(const struct config *c, struct config_fault *fault)
{
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &c->measurement[i];
        if (!m->name[0])
            continue;
        if (config_find_measurement(c, m->name) != i)
            return plan_refuse(fault, ERR_CONFLICT, "meas", i + 1, "name", m->name,
                               "is used twice");
        if (reserved(m->name))
            return plan_refuse(fault, ERR_CONFLICT, "meas", i + 1, "name", m->name, NAME_RESERVED);
        if (!span_possible(m->lo, m->hi))
            return plan_refuse(fault, ERR_RANGE, "meas", i + 1, "lo", m->name, SPAN_WANTED);
    }
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        const struct mv_config *o = &c->mv[i];
        if (!o->name[0])
            continue;
        if (config_find_mv(c, o->name) != i)
            return plan_refuse(fault, ERR_CONFLICT, "mv", i + 1, "name", o->name, "is used twice");
        if (config_find_loop(c, o->name) != PLAN_NONE)
            return plan_refuse(fault, ERR_CONFLICT, "mv", i + 1, "name", o->name,
                               "is also the name of a loop");
        if (reserved(o->name))
            return plan_refuse(fault, ERR_CONFLICT, "mv", i + 1, "name", o->name, NAME_RESERVED);
        if (!span_possible(o->lo, o->hi))
            return plan_refuse(fault, ERR_RANGE, "mv", i + 1, "lo", o->name, SPAN_WANTED);
        bool max_fits = o->lo < o->max && o->max <= o->hi;
        if (!(max_fits && o->lo <= o->min && o->min < o->max))
            return plan_refuse(fault, ERR_RANGE, "mv", i + 1, max_fits ? "min" : "max", o->name,
                               "needs lo <= min < max <= hi");
        if (!(o->lo <= o->safe && o->safe <= o->hi))
            return plan_refuse(fault, ERR_RANGE, "mv", i + 1, "safe", o->name,
                               "must lie in lo..hi");
        if (!rate_possible(o->rate_per_s, o->hi - o->lo))
            return plan_refuse(fault, ERR_RANGE, "mv", i + 1, "rate", o->name, RATE_WANTED);
    }
    return ERR_OK;
}

static enum err resolve_loop(struct plan *plan, uint8_t i, struct config_fault *fault)
{
    const struct config *c = &plan->config;
    const struct loop_config *l = &c->loop[i];
    struct loop_plan *p = &plan->loop[i];
    p->used = true;
    if (config_find_loop(c, l->name) != i)
        return plan_refuse(fault, ERR_CONFLICT, "loop", i + 1u, "name", l->name, "is used twice");
    if (reserved(l->name))
        return plan_refuse(fault, ERR_CONFLICT, "loop", i + 1u, "name", l->name, NAME_RESERVED);
    p->pv = config_find_measurement(c, l->pv);
    if (p->pv == PLAN_NONE)
        return plan_refuse(fault, ERR_UNKNOWN, "loop", i + 1u, "pv", l->pv,
                           "must be the name of a configured measurement");
    p->mv = config_find_mv(c, l->out);
    p->inner = config_find_loop(c, l->out);
    if (p->mv == PLAN_NONE && p->inner == PLAN_NONE)
        return plan_refuse(fault, ERR_UNKNOWN, "loop", i + 1u, "out", l->out,
                           "must be the name of a configured manipulated variable or loop");
    if (p->mv != PLAN_NONE) {
        if (plan->owner[p->mv] != PLAN_NONE)
            return plan_refuse(fault, ERR_CONFLICT, "loop", i + 1u, "out", l->out,
                               "is driven by another loop already");
        plan->owner[p->mv] = i;
    }
    if (!(l->sp_lo == 0.0f && l->sp_hi == 0.0f) && !(l->sp_lo < l->sp_hi))
        return plan_refuse(fault, ERR_RANGE, "loop", i + 1u, "sp_lo", l->name,
                           "must be below sp_hi (both 0: the span)");
    const struct measurement_config *m = &c->measurement[p->pv];
    if (!(l->sp_lo == 0.0f && l->sp_hi == 0.0f) && !(m->lo <= l->sp_lo && l->sp_hi <= m->hi))
        return plan_refuse(fault, ERR_RANGE, "loop", i + 1u, l->sp_lo < m->lo ? "sp_lo" : "sp_hi",
                           l->name, "must lie in the span of the measurement");
    if (l->phase >= l->divisor)
        return plan_refuse(fault, ERR_RANGE, "loop", i + 1u, "phase", l->name,
                           "must be below the divisor");
    p->decouple = l->decouple != 0;
    if (p->decouple && p->mv == PLAN_NONE)
        return plan_refuse(fault, ERR_CONFLICT, "loop", i + 1u, "decouple", l->name,
                           "is for loops that drive a manipulated variable themselves");
    if (p->decouple && i >= DECOUPLER_MAX)
        return plan_refuse(fault, ERR_RANGE, "loop", i + 1u, "decouple", l->name,
                           "is for the loops that have a row of `decouple`");
    float h = plan->tick_s * (float)l->divisor;
    struct ramp ramp;
    if (!(h <= BLOCK_INTERVAL_MAX_S))
        return plan_refuse(fault, ERR_RANGE, "loop", i + 1u, "divisor", l->name,
                           "times the base tick must be at most 100000 s");
    if (ramp_init(&ramp, l->sp_ramp_per_min / 60.0f / (m->hi - m->lo), h) != ERR_OK)
        return plan_refuse(fault, ERR_RANGE, "loop", i + 1u, "sp_ramp", l->name,
                           "must be 0 or at least 6e-8 of the span per minute");
    return ERR_OK;
}

/* Orders the loops, outer loops first: repeatedly takes the loops whose outer loop has been taken. Those left over
 * drive each other in a ring. */
static enum err order_loops(struct plan *plan, struct config_fault *fault)
{
    bool taken[CONFIG_LOOPS] = {false};
    uint8_t n = 0;
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++) {
        struct loop_plan *p = &plan->loop[i];
        if (!p->used || p->inner == PLAN_NONE)
            continue;
        struct loop_plan *inner = &plan->loop[p->inner];
        if (inner->outer != PLAN_NONE)
            return plan_refuse(fault, ERR_CONFLICT, "loop", i + 1u, "out", plan->config.loop[i].out,
                               "has its setpoint driven by another loop already");
        inner->outer = i;
    }
    for (unsigned round = 0; round < CONFIG_LOOPS; round++) {
        for (uint8_t i = 0; i < CONFIG_LOOPS; i++) {
            const struct loop_plan *p = &plan->loop[i];
            if (!p->used || taken[i] || !plan_setpoint_ready(plan, i, taken))
                continue;
            taken[i] = true;
            n = plan_list_controllers(plan, i, taken, n);
        }
    }
    plan->listed_end[STAGE_CONTROL] = n;
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        if (plan->loop[i].used && !taken[i])
            return plan_refuse(fault, ERR_CYCLE, "loop", i + 1u, "out", plan->config.loop[i].out,
                               "makes loops drive each other in a ring");
    return ERR_OK;
}

static enum err resolve_interlocks(struct plan *plan, struct config_fault *fault)
{
    for (uint8_t i = 0; i < CONFIG_INTERLOCKS; i++) {
        const struct interlock_config *k = &plan->config.interlock[i];
        plan->interlock[i].measurement = PLAN_NONE;
        if (!k->measurement[0])
            continue;
        plan->interlock[i].measurement = config_find_measurement(&plan->config, k->measurement);
        if (plan->interlock[i].measurement == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "lock", i + 1u, "meas", k->measurement,
                               "must be the name of a configured measurement");
        plan->interlock[i].mv = config_find_mv(&plan->config, k->mv);
        if (plan->interlock[i].mv == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "lock", i + 1u, "mv", k->mv,
                               "must be the name of a configured manipulated variable");
        const struct mv_config *o = &plan->config.mv[plan->interlock[i].mv];
        if (!(o->lo <= k->value && k->value <= o->hi))
            return plan_refuse(fault, ERR_RANGE, "lock", i + 1u, "value", k->mv,
                               "must lie in the span of the manipulated variable");
    }
    return ERR_OK;
}

#define INFER_WANTED                                                                               \
    (CONFIG_BLOCKS ? "must be the name of a configured manipulated variable, or of a measurement " \
                     "that a block "                                                               \
                     "writes"                                                                      \
                   : "must be the name of a configured manipulated variable")

static enum err resolve_inferences(struct plan *plan, struct config_fault *fault)
{
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &plan->config.measurement[i];
        plan->infer[i] = m->name[0] ? config_find_mv(&plan->config, m->infer) : PLAN_NONE;
        if (!m->name[0])
            continue;
        uint8_t estimate =
            CONFIG_BLOCKS ? config_find_measurement(&plan->config, m->infer) : (uint8_t)PLAN_NONE;
        if (plan->infer[i] == PLAN_NONE && estimate != PLAN_NONE &&
            plan_is_estimate(plan, estimate)) {
            if (estimate == i)
                return plan_refuse(fault, ERR_CYCLE, "meas", i + 1u, "infer", m->infer,
                                   "is the measurement itself");
            plan->infer[i] = (uint8_t)(INFER_IS_ESTIMATE | estimate);
        }
        if (m->infer[0] && plan->infer[i] == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "meas", i + 1u, "infer", m->infer, INFER_WANTED);
        if (m->fallback == FALLBACK_SUBSTITUTE &&
            !(m->lo <= m->substitute && m->substitute <= m->hi))
            return plan_refuse(fault, ERR_RANGE, "meas", i + 1u, "substitute", m->name,
                               "must lie in the span of the measurement");
    }
    return ERR_OK;
}

static enum err resolve_alarms(struct plan *plan, struct config_fault *fault)
{
    for (uint8_t i = 0; i < CONFIG_ALARMS; i++) {
        const struct alarm_config *a = &plan->config.alarm[i];
        bool deviation = a->side == ALARM_DEVIATION;
        if (alarm_is_on_event(a)) {
            enum err err = plan_resolve_block_alarm(plan, i, fault);
            if (err)
                return err;
            continue;
        }
        plan->alarm[i] = deviation ? config_find_loop(&plan->config, a->on)
                                   : config_find_measurement(&plan->config, a->on);
        if (a->on[0] && plan->alarm[i] == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "alarm", i + 1u, "on", a->on,
                               deviation ? "must be the name of a configured loop"
                                         : "must be the name of a configured measurement");
    }
    return ERR_OK;
}

enum err plan_set_tick(struct plan *plan, float tick_s, struct config_fault *fault)
{
    const struct config *config = &plan->config;
    uint32_t serial = plan->serial, identity = plan->identity;
    memset(plan, 0, offsetof(struct plan, config));
    plan->serial = serial;
    plan->identity = identity;
    plan->tick_s = config->tick_s > 0.0f ? config->tick_s : (tick_s > 0.0f ? tick_s : 1.0f);
    memset(plan->owner, PLAN_NONE, sizeof plan->owner);
    for (uint8_t b = 0; b < PLAN_BLOCKS; b++)
        plan->block[b].kind = PLAN_NONE;
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++) {
        plan->loop[i].pv = plan->loop[i].mv = PLAN_NONE;
        plan->loop[i].inner = plan->loop[i].outer = PLAN_NONE;
    }
    if (plan->tick_s < TICK_SHORTEST_S)
        return plan_refuse(fault, ERR_RANGE, "tick", 0, "base", "",
                           "must be 0 or at least 0.05 s, the plant's own too");
    enum err err = check_channels(config, fault);
    for (uint8_t i = 0; !err && i < CONFIG_LOOPS; i++)
        if (config->loop[i].name[0]) {
            err = resolve_loop(plan, i, fault);
            if (!err)
                err = plan_check_own(plan, i, fault);
        }
    if (!err)
        err = plan_resolve_numbered(plan, fault);
    if (!err)
        err = order_loops(plan, fault);
    if (!err)
        err = plan_check_numbered(plan, fault);
    if (!err)
        err = plan_check_matrix(plan, fault);
    if (!err)
        err = plan_resolve_feedforwards(plan, fault);
    if (!err)
        err = plan_place_blocks(plan, fault);
    if (!err)
        err = resolve_interlocks(plan, fault);
    if (!err)
        err = resolve_inferences(plan, fault);
    if (!err)
        err = plan_check_sampling(plan, fault);
    if (!err)
        err = plan_check_calibration(plan, fault);
    if (!err)
        err = resolve_alarms(plan, fault);
    if (!err)
        err = plan_check_tests(plan, fault);
    if (!err)
        err = sequence_resolve(plan, fault);
    return err;
}

enum err plan_build(struct plan *plan, const struct config *config, float tick_s,
                    struct config_fault *fault)
{
    if (config != &plan->config)
        /* It is copied as a whole, because unused bytes count in its checksum. */
        memcpy(&plan->config, config, sizeof *config);
    plan->identity = crc32_update(0, &plan->config, CONFIG_CONTENT_BYTES);
    plan->identity = tables_identity(&plan->config, plan->identity);
    return plan_set_tick(plan, tick_s, fault);
}
