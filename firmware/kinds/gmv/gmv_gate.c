#include "kinds/gmv/gmv_gate.h"

#include "base/assertion.h"
#include "kinds/gmv/gmv_gate_state.h"
#include "kinds/gmv/gmv_record.h"
#include "num/real.h"

/* Steps over which the information of samples is averaged. */
#define INFORMATION_MEMORY 50.0f

static void forget_quiet(struct gmv_gate *g)
{
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        g->is_quiet[i] = false;
        g->information[i] = 1;
    }
}

void gmv_gate_begin(struct gmv_gate *g)
{
    for (unsigned i = 0; i < GMV_LOOPS; i++)
        g->still_steps[i] = g->spoilt_steps[i] = 0;
    forget_quiet(g);
}

void gmv_gate_thaw(struct gmv_gate *g)
{
    g->frozen = false;
    forget_quiet(g);
}

static enum gmv_rest reason_to_rest(struct gmv_gate *g, const struct gmv_supervise_config *c,
                                    const struct gmv_observation *seen, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    g->still_steps[i] = real_abs(seen->move[i]) >= GMV_STANDS_STILL
                            ? 0
                            : g->still_steps[i] + (g->still_steps[i] < UINT32_MAX);
    if (!(seen->good & (1u << i)))
        g->spoilt_steps[i] = c->reach + 1u;
    else if (g->spoilt_steps[i])
        g->spoilt_steps[i]--;
    if (!(seen->acting & (1u << i)))
        return GMV_RESTS_MANUAL;
    if (g->spoilt_steps[i])
        return GMV_RESTS_READING;
    if (g->still_steps[i] > c->reach)
        return GMV_RESTS_STILL;
    if (c->on && g->is_quiet[i])
        return GMV_RESTS_QUIET;
    return g->frozen ? GMV_RESTS_ASKED : GMV_LEARNS;
}

uint8_t gmv_gate_look(struct gmv_gate *g, const struct gmv_supervise_config *c,
                      const struct gmv_observation *seen, uint8_t *rest)
{
    uint8_t learn = 0;
    for (unsigned i = 0; i < c->loops; i++) {
        rest[i] = (uint8_t)reason_to_rest(g, c, seen, i);
        if (rest[i] == GMV_LEARNS)
            learn = (uint8_t)(learn | (1u << i));
    }
    return learn;
}

/* With constant forgetting v a sample usually carries the information 1 - v for each parameter. */
void gmv_gate_weigh(struct gmv_gate *g, const struct gmv_supervise_config *c,
                    const struct gmv_result *result, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    float usual = (1.0f - result->forgetting[i]) * (float)result->parameters[i];
    float least = c->quiet * usual;
    if (g->is_quiet[i]) {
        g->is_quiet[i] = !(result->information[i] > 2 * least);
        if (!g->is_quiet[i])
            g->information[i] = result->information[i];
        return;
    }
    g->information[i] += (result->information[i] - g->information[i]) / INFORMATION_MEMORY;
    g->is_quiet[i] = g->information[i] < least;
}
