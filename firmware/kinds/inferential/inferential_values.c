#include "kinds/inferential/inferential_values.h"

#include "base/assertion.h"

const char *inferential_value(const struct inferential *l, unsigned k, size_t i, float *value)
{
    REFLUX_ASSERT(k < INFERENTIAL_LOOPS);
    float frequency = 0, damping = 0;
    const struct inferential_config *c = inferential_config(l);
    const struct inferential_inner last = inferential_inner(l);
    inferential_predicted(c, inferential_acts(l), &frequency, &damping);
    const struct {
        const char *name[INFERENTIAL_LOOPS];
        float value;
    } inner[INFERENTIAL_VALUES] = {
        {{"law_1", "law_2"}, inferential_acts(l)},
        {{"y1_1", "y1_2"}, num_to_float(last.y1) * c->span[PRIMARY]},
        {{"y2_1", "y2_2"}, num_to_float(inferential_away(l)) * c->span[SECONDARY]},
        {{"b1_1", "b1_2"}, inferential_load(l, PRIMARY)},
        {{"b2_1", "b2_2"}, inferential_load(l, SECONDARY)},
        {{"prim_1", "prim_2"}, num_to_float(last.primary)},
        {{"sec_1", "sec_2"}, num_to_float(last.secondary)},
        {{"sat_1", "sat_2"}, last.cut},
        {{"a1_1", "a1_2"}, c->a[PRIMARY]},
        {{"a2_1", "a2_2"}, c->a[SECONDARY]},
        {{"kc_1", "kc_2"}, c->kc},
        {{"kc2_1", "kc2_2"}, c->kc2},
        {{"ko_1", "ko_2"}, c->ko},
        {{"freq_1", "freq_2"}, frequency},
        {{"damp_1", "damp_2"}, damping},
    };
    *value = inner[i].value;
    return inner[i].name[k];
}
