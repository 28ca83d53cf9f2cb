/* Feedforwards of a plan: what they look at, their places in the arena, and that none drives itself. */
#include <string.h>

#include "feedforward/feedforward.h"
#include "supervise/arena.h"
#include "supervise/plan_parts.h"

_Static_assert(CONFIG_FEEDFORWARDS <= 8, "a bit for each in check_feedforward_rings");

void plan_feedforward_span(const struct plan *plan, uint8_t element, float *lo, float *hi)
{
    uint8_t from = plan->feedforward[element].from;
    bool output = plan->feedforward[element].from_output;
    const struct measurement_config *m = &plan->config.measurement[from];
    const struct output_config *o = &plan->config.output[from];
    *lo = output ? o->lo : m->lo;
    *hi = output ? o->hi : m->hi;
}

struct feedforward_config plan_feedforward(const struct plan *plan, uint8_t element)
{
    const struct ff_config *f = &plan->config.feedforward[element];
    float lo, hi;
    plan_feedforward_span(plan, element, &lo, &hi);
    return (struct feedforward_config){
        .gain = f->gain,
        .lead_s = f->lead_s,
        .lag_s = f->lag_s,
        .dead_time_s = f->dead_s,
        .reference = (f->reference - lo) / (hi - lo),
        .out_lo = f->lo,
        .out_hi = f->hi,
    };
}

/* Feedforwards that pass a manipulated variable on, in a ring, would drive themselves; one onto its own source is the
 * shortest ring. What each reaches, through any number of others: */
static enum err check_feedforward_rings(const struct plan *plan, struct config_fault *fault)
{
    uint8_t reach[CONFIG_FEEDFORWARDS];
    for (uint8_t i = 0; i < CONFIG_FEEDFORWARDS; i++) {
        reach[i] = 0;
        for (uint8_t k = 0; k < CONFIG_FEEDFORWARDS; k++)
            if (plan->feedforward[i].from != PLAN_NONE && plan->feedforward[k].from_output &&
                plan->feedforward[k].from == plan->feedforward[i].to)
                reach[i] = (uint8_t)(reach[i] | 1u << k);
    }
    for (uint8_t through = 0; through < CONFIG_FEEDFORWARDS; through++)
        for (uint8_t i = 0; i < CONFIG_FEEDFORWARDS; i++)
            if ((reach[i] & (1u << through)) != 0u)
                reach[i] = (uint8_t)(reach[i] | reach[through]);
    for (uint8_t i = 0; i < CONFIG_FEEDFORWARDS; i++)
        if ((reach[i] & (1u << i)) != 0u)
            return plan_refuse(fault, ERR_CYCLE, "ff", i + 1u, "from",
                               plan->config.feedforward[i].from, "makes a ring of feedforwards");
    return ERR_OK;
}

/* A measurement of that name, or else a manipulated variable. */
static void resolve_source(struct plan *plan, uint8_t i)
{
    const char *from = plan->config.feedforward[i].from;
    plan->feedforward[i].from = config_find_measurement(&plan->config, from);
    plan->feedforward[i].from_output = plan->feedforward[i].from == PLAN_NONE;
    if (plan->feedforward[i].from_output)
        plan->feedforward[i].from = config_find_output(&plan->config, from);
}

enum err plan_resolve_feedforwards(struct plan *plan, struct config_fault *fault)
{
    uint8_t placed[PLACED_KINDS];
    arena_count(plan, placed);
    uint32_t used = arena_state_bytes(placed) / (uint32_t)sizeof(num_t);
    uint32_t end = PLAN_ARENA_BYTES / (uint32_t)sizeof(num_t);
    for (uint8_t i = 0; i < CONFIG_FEEDFORWARDS; i++) {
        const struct ff_config *f = &plan->config.feedforward[i];
        plan->feedforward[i].from = PLAN_NONE;
        if (!f->from[0])
            continue;
        resolve_source(plan, i);
        if (plan->feedforward[i].from == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "ff", i + 1u, "from", f->from,
                               "must be a configured measurement or manipulated variable");
        plan->feedforward[i].to = config_find_output(&plan->config, f->to);
        if (plan->feedforward[i].to == PLAN_NONE ||
            plan->owner[plan->feedforward[i].to] == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "ff", i + 1u, "to", f->to,
                               "must be a manipulated variable that a loop drives");
        struct feedforward_config element = plan_feedforward(plan, i);
        const char *field, *wanted;
        enum err err = feedforward_validate(&element, plan->tick_s, &field, &wanted);
        if (err && strcmp(field, "h_s") == 0)
            return plan_refuse(fault, err, "tick", 0, "base", f->from, wanted);
        if (err)
            return plan_refuse(fault, err, "ff", i + 1u,
                               strcmp(field, "out_lo") == 0   ? "lo"
                               : strcmp(field, "out_hi") == 0 ? "hi"
                                                              : plan_parameter_field(field),
                               f->from, wanted);
        uint32_t bytes = (uint32_t)feedforward_bytes(&element, plan->tick_s);
        used += bytes / (uint32_t)sizeof(num_t);
        if (used * sizeof(num_t) > PLAN_ARENA_BYTES) {
            err = plan_refuse(fault, ERR_MEMORY, "ff", i + 1u, "dead", f->from,
                              "dead times need more memory than this board has");
            fault->bytes = used * (uint32_t)sizeof(num_t);
            return err;
        }
        end -= bytes / (uint32_t)sizeof(num_t);
        plan->feedforward[i].line = (uint16_t)end;
        plan->feedforward[i].bytes = (uint16_t)bytes;
    }
    return check_feedforward_rings(plan, fault);
}
