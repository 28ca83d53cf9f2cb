/* The inner values of a block of the kind `ff_tune`. */
#include "kinds/ff_tune/feedforward_tune_block.h"

static float percent_done(const struct tune *t)
{
    float wanted = (float)tune_samples(t, t->s.learn_s);
    if (t->stage == TUNE_LOOP || t->stage == TUNE_DISTURBANCE)
        return 100 * (float)t->stage_samples / wanted;
    return t->stage == TUNE_TESTS ? 100 * (float)t->parts / TUNE_PARTS : 0;
}

static float band_edge(const struct tune *t, bool upper)
{
    if (!t->band_to)
        return 0;
    return (float)t->omega[upper ? t->band_to - 1u : t->band_from];
}

/* |Gd/Gp| where the band begins, and its standard deviation: the gain that matters most. */
static const struct high_order_point *low_point(const struct tune *t)
{
    return &t->ratio.at[t->band_from];
}

const char *tune_describe(const void *state, size_t i, float *value)
{
    const struct tune *t = state;
    const struct {
        const char *name;
        float value;
    } inner[] = {
        {"stage", t->stage},
        {"verdict", t->verdict},
        {"percent", percent_done(t)},
        {"learns", t->learns},
        {"change", 100 * (float)t->change},
        {"move", 100 * (float)real_sqrt(t->move_square)},
        {"noise_d", (t->d_signal.hi - t->d_signal.lo) * (float)real_sqrt(t->d_noise)},
        {"band_lo", band_edge(t, false)},
        {"band_hi", band_edge(t, true)},
        {"ratio", (float)cplx_abs(low_point(t)->is)},
        {"ratio_sd", (float)low_point(t)->sd},
        {"doubted", 100 * (float)t->spread},
        {"gain_u", (float)t->model.is.gain},
        {"lag_u", (float)t->model.is.time_constant_s},
        {"dead_u", (float)t->model.is.dead_time_s},
        {"off", 100 * (float)t->model.off},
        {"found_k", (float)t->candidate.k},
        {"found_lead", (float)t->candidate.lead},
        {"found_lag", (float)t->candidate.lag},
        {"found_dead", (float)t->candidate.dead},
        {"J", (float)t->search.j},
        {"J0", (float)t->search.j0},
        {"by_rule", t->by_rule},
        {"case", t->rule.which},
        {"gain_d", (float)t->rule.path.is.gain},
        {"lag_d", (float)t->rule.path.is.time_constant_s},
        {"dead_d", (float)t->rule.path.is.dead_time_s},
        {"rule_k", (float)t->rule.shape.k},
        {"rule_lead", (float)t->rule.shape.lead},
        {"rule_lag", (float)t->rule.shape.lag},
        {"rule_dead", (float)t->rule.shape.dead},
        {"rule_J", (float)t->rule.j},
        {"promised", 100 * (float)t->promised},
        {"does", tune_improvement(t)},
        {"tried", t->tried},
    };
    if (i >= sizeof inner / sizeof inner[0])
        return NULL;
    *value = inner[i].value;
    return inner[i].name;
}
