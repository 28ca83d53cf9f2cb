#include "exchange/sequence_rows.h"

#include <string.h>

#include "exchange/span.h"

uint8_t sequence_next(const struct config *config, enum sequence_kind kind, int after)
{
    for (int k = after + 1; k < CONFIG_STEPS; k++)
        if (config->step[k].sequence == kind)
            return (uint8_t)k;
    return PLAN_NONE;
}

/* Equal settings have equal bits: unused characters of names are zero, and no number is -0. */
static bool same(const void *a, const void *b, size_t n)
{
    return memcmp(a, b, n) == 0;
}

bool sequence_differs(const struct plan *plan, const struct plan *old)
{
    if (!same(plan->config.step, old->config.step, sizeof plan->config.step) ||
        !same(plan->step, old->step, sizeof plan->step))
        return true;
    /* A sequence knows the loops and outputs that it controls by their places. */
    for (unsigned i = 0; i < CONFIG_LOOPS; i++)
        if (strcmp(plan->config.loop[i].name, old->config.loop[i].name) != 0 ||
            plan->loop[i].mv != old->loop[i].mv)
            return true;
    return false;
}

const char *sequence_state_text(uint8_t state)
{
    static const char *const words[] = {"idle", "running", "held", "confirm", "done", "aborted"};
    return state <= SEQUENCE_ABORTED ? words[state] : "?";
}

const char *sequence_kind_text(uint8_t kind)
{
    return kind == SEQUENCE_START ? "start" : kind == SEQUENCE_STOP ? "stop" : "-";
}

const char *sequence_reason_text(uint8_t reason)
{
    static const char *const words[SEQUENCE_REASONS] = {
        "by the operator",
        "time-out",
        "guard",
        "interlock holds an output elsewhere",
        "loop went to manual",
        "output does not follow",
        "no valid reading of what is waited for",
        "action not possible now",
        "safe state taken",
        "rows changed by a configuration",
        "board was reset",
    };
    return reason < SEQUENCE_REASONS ? words[reason] : "?";
}

bool sequence_reading(const struct supervisor *s, uint8_t measurement, float *value)
{
    const struct measurement_state *m = &s->measurement[measurement];
    const struct measurement_config *c = &s->plan->config.measurement[measurement];
    *value = span_to_eu(m->value, c->lo, c->hi);
    return m->bound && m->seen && !m->alarm && quality_usable(m->quality);
}
