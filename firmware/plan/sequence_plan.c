/* Checks the rows of sequences with the rest of a configuration. */
#include <string.h>

#include "plan/plan_parts.h"
#include "plan/sequence_plan.h"

static enum err refuse_step(struct config_fault *fault, enum err code, unsigned k,
                            const char *field, const char *subject, const char *wanted)
{
    memset(fault, 0, sizeof *fault);
    fault->code = code;
    fault->group = "step";
    fault->index = (uint8_t)(k + 1u);
    fault->field = field;
    fault->wanted = wanted;
    strncpy(fault->subject, subject, sizeof fault->subject - 1);
    return code;
}

static bool within(float x, float lo, float hi)
{
    return lo <= x && x <= hi;
}

static bool is_guard(const struct step_config *c)
{
    return c->action == STEP_GUARD;
}

static bool looks(const struct step_config *c)
{
    return c->until == STEP_ABOVE || c->until == STEP_BELOW || c->until == STEP_STEADY;
}

static enum err resolve_action(struct plan *plan, uint8_t k, struct config_fault *fault)
{
    const struct config *config = &plan->config;
    const struct step_config *c = &config->step[k];
    uint8_t *what = &plan->step[k].what;
    float lo, hi;
    switch (c->action) {
    case STEP_OUT:
        *what = config_find_mv(config, c->what);
        if (*what == PLAN_NONE)
            return refuse_step(fault, ERR_UNKNOWN, k, "what", c->what,
                               "must be the name of a configured manipulated variable");
        plan_manual_limits(plan, *what, &lo, &hi);
        if (!within(c->value, lo, hi))
            return refuse_step(
                fault, ERR_RANGE, k, "value", c->what,
                "must lie in min..max of the manipulated variable, or be its safe value");
        return ERR_OK;
    case STEP_MANUAL:
    case STEP_AUTO:
    case STEP_CASCADE:
    case STEP_SETPOINT:
        *what = config_find_loop(config, c->what);
        if (*what == PLAN_NONE)
            return refuse_step(fault, ERR_UNKNOWN, k, "what", c->what,
                               "must be the name of a configured loop");
        if (c->action == STEP_CASCADE && plan->loop[*what].outer == PLAN_NONE)
            return refuse_step(fault, ERR_CONFLICT, k, "what", c->what,
                               "has no outer loop that drives its setpoint");
        plan_setpoint_limits(plan, *what, &lo, &hi);
        if (c->action == STEP_SETPOINT && !within(c->value, lo, hi))
            return refuse_step(fault, ERR_RANGE, k, "value", c->what,
                               "must lie in the setpoint limits of the loop");
        return ERR_OK;
    case STEP_OFFSET_ON:
    case STEP_OFFSET_OFF:
    case STEP_DROP:
        *what = config_find_measurement(config, c->what);
        if (*what == PLAN_NONE)
            return refuse_step(fault, ERR_UNKNOWN, k, "what", c->what,
                               "must be the name of a configured measurement");
        return ERR_OK;
    default:
        return ERR_OK;
    }
}

static enum err resolve_condition(struct plan *plan, uint8_t k, struct config_fault *fault)
{
    const struct config *config = &plan->config;
    const struct step_config *c = &config->step[k];
    if (is_guard(c) && c->until != STEP_ABOVE && c->until != STEP_BELOW)
        return refuse_step(fault, ERR_CONFLICT, k, "until", "",
                           "of a guard must be above or below");
    if (is_guard(c) && c->otherwise == STEP_GO_ON)
        return refuse_step(fault, ERR_CONFLICT, k, "else", "", "of a guard must be abort or hold");
    if (c->until == STEP_TIME && c->wait_s == 0)
        return refuse_step(fault, ERR_RANGE, k, "hold", "",
                           "must be above 0: it is the time waited");
    if (!looks(c))
        return ERR_OK;
    uint8_t i = config_find_measurement(config, c->measurement);
    if (i == PLAN_NONE)
        return refuse_step(fault, ERR_UNKNOWN, k, "meas", c->measurement,
                           "must be the name of a configured measurement");
    plan->step[k].measurement = i;
    const struct measurement_config *m = &config->measurement[i];
    if (c->until == STEP_STEADY && !(c->limit > 0.0f && c->wait_s > 0))
        return refuse_step(fault, ERR_RANGE, k, c->limit > 0.0f ? "hold" : "limit", c->measurement,
                           "must be above 0: steady is a width and a time");
    if (c->until != STEP_STEADY && !within(c->limit, m->lo, m->hi))
        return refuse_step(fault, ERR_RANGE, k, "limit", c->measurement,
                           "must lie in the span of the measurement");
    return ERR_OK;
}

static enum err check_timeout(const struct step_config *c, uint8_t k, struct config_fault *fault)
{
    bool waits = c->until != STEP_AT_ONCE && !is_guard(c);
    if (!waits && c->timeout_s)
        return refuse_step(fault, ERR_CONFLICT, k, "timeout", "", "is for rows that wait");
    if (waits && looks(c) && !c->timeout_s)
        return refuse_step(fault, ERR_RANGE, k, "timeout", c->measurement,
                           "must be given: no measurement is waited for without end");
    if (waits && c->timeout_s && c->until != STEP_CONFIRM && c->timeout_s <= c->wait_s)
        return refuse_step(fault, ERR_RANGE, k, "timeout", "", "must be longer than hold");
    return ERR_OK;
}

enum err sequence_resolve(struct plan *plan, struct config_fault *fault)
{
    for (uint8_t k = 0; k < CONFIG_STEPS; k++) {
        const struct step_config *c = &plan->config.step[k];
        plan->step[k].what = plan->step[k].measurement = PLAN_NONE;
        if (c->sequence == SEQUENCE_NONE)
            continue;
        plan->has_steps = true;
        enum err err = resolve_action(plan, k, fault);
        if (!err)
            err = resolve_condition(plan, k, fault);
        if (!err)
            err = check_timeout(c, k, fault);
        if (err)
            return err;
    }
    return ERR_OK;
}
