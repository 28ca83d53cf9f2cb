#include "kinds/ff_tune/tune_values.h"

#include "base/assertion.h"
#include "kinds/ff_tune/tune_disturbance.h"
#include "kinds/ff_tune/tune_learner.h"
#include "kinds/ff_tune/tune_search.h"
#include "kinds/ff_tune/tune_test.h"

static float percent_done(const struct tune_parts *p)
{
    float wanted = (float)tune_samples_in(p->context, p->context->s.learn_s);
    enum tune_stage stage = tune_stages_stage(p->stages);
    if (stage == TUNE_LOOP || stage == TUNE_DISTURBANCE)
        return 100 * (float)tune_stages_samples(p->stages) / wanted;
    return stage == TUNE_TESTS ? 100 * (float)tune_test_parts(p->test) / TUNE_PARTS : 0;
}

static float band_edge(const struct tune_band *b, bool upper)
{
    REFLUX_ASSERT(b->from < FEEDFORWARD_POINTS && b->to <= FEEDFORWARD_POINTS);
    if (!b->to)
        return 0;
    return (float)b->omega[upper ? b->to - 1u : b->from];
}

static const char names[][11] = {
    "stage",     "verdict",  "percent",   "learns",     "change",    "move",       "noise_d",
    "band_lo",   "band_hi",  "ratio",     "ratio_sd",   "doubted",   "gain_u",     "lag_u",
    "dead_u",    "off",      "found_k",   "found_lead", "found_lag", "found_dead", "J",
    "J0",        "by_rule",  "case",      "gain_d",     "lag_d",     "dead_d",     "rule_k",
    "rule_lead", "rule_lag", "rule_dead", "rule_J",     "promised",  "does",       "tried",
};

const char *tune_value(const struct tune_parts *p, size_t i, float *value)
{
    const struct block_signal *d = &p->context->d_signal;
    const struct tune_band *band = tune_responses_band(p->responses);
    /* |Gd/Gp| where the band begins, and its standard deviation: the gain that matters most. */
    const struct high_order_point *low = &band->ratio[band->from];
    const struct tune_model *model = tune_shadows_model(p->shadows);
    const struct feedforward_shape *found = tune_candidate(p->search);
    const struct feedforward_search *search = tune_search_result(p->search);
    const struct tune_rule *rule = tune_paths_rule(p->paths);
    const float values[] = {
        (float)tune_stages_stage(p->stages),
        (float)tune_stages_verdict(p->stages),
        percent_done(p),
        tune_learner_learns(p->learner),
        100 * (float)tune_responses_change(p->responses),
        100 * (float)real_sqrt(tune_learner_move_square(p->learner)),
        (d->hi - d->lo) * (float)real_sqrt(tune_disturbance_noise(p->disturbance)),
        band_edge(band, false),
        band_edge(band, true),
        (float)cplx_abs(low->value),
        (float)low->sd,
        100 * (float)tune_search_spread(p->search),
        (float)model->element.gain,
        (float)model->element.time_constant_s,
        (float)model->element.dead_time_s,
        100 * (float)model->misfit,
        (float)found->k,
        (float)found->lead,
        (float)found->lag,
        (float)found->dead,
        (float)search->j,
        (float)search->j0,
        tune_candidate_is_rule(p->search),
        rule->number,
        (float)rule->path.element.gain,
        (float)rule->path.element.time_constant_s,
        (float)rule->path.element.dead_time_s,
        (float)rule->shape.k,
        (float)rule->shape.lead,
        (float)rule->shape.lag,
        (float)rule->shape.dead,
        (float)rule->j,
        100 * (float)tune_test_promised(p->test),
        tune_does(p),
        (float)tune_stages_times_off(p->stages),
    };
    _Static_assert(sizeof values / sizeof values[0] == sizeof names / sizeof names[0],
                   "a name each");
    if (i >= sizeof names / sizeof names[0])
        return NULL;
    *value = values[i];
    return names[i];
}
