#include "commission/margin_probe.h"

#include "base/assertion.h"
#include "commission/margin_probe_state.h"

void margin_probe_enter(struct margin_probe *p, bool is_rest, bool is_return)
{
    p->raised = (p->raised && is_return) || (p->repeats && !is_rest);
}

void margin_probe_raise(struct margin_probe *p, uint8_t k)
{
    REFLUX_ASSERT(k < CONFIG_LOOPS);
    if (p->predicted && p->predicted[k].planned)
        p->raised = true;
}

bool margin_probe_is_restless(const struct margin_probe *p, const struct trial_step *t,
                              const struct adoption_loop *loop,
                              const struct adoption_channel *channel, uint8_t k, real_t step)
{
    REFLUX_ASSERT(k < CONFIG_LOOPS);
    return trial_step_is_restless(t, loop, channel, step, p->predicted[k].left);
}
