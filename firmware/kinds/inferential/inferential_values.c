/* Inner values of a block of kind `inferential`, as `block N` shows them. */
#include "kinds/inferential/inferential_block.h"

const char *inferential_describe(const void *state, size_t i, float *value)
{
    const struct inferential_block *s = state;
    size_t k = i / INFERENTIAL_INNER;
    if (k >= s->loops)
        return NULL;
    const struct inferential *l = &s->loop[k];
    float frequency = 0, damping = 0;
    inferential_predicted(&l->config, l->acts, &frequency, &damping);
    const struct {
        const char *name[INFERENTIAL_LOOPS];
        float value;
    } inner[INFERENTIAL_INNER] = {
        {{"law_1", "law_2"}, l->acts},
        {{"y1_1", "y1_2"}, num_to_float(num_sub(l->t1, l->setpoint)) * l->config.span[PRIMARY]},
        {{"y2_1", "y2_2"}, num_to_float(inferential_away(l)) * l->config.span[SECONDARY]},
        {{"b1_1", "b1_2"}, inferential_load(l, PRIMARY)},
        {{"b2_1", "b2_2"}, inferential_load(l, SECONDARY)},
        {{"prim_1", "prim_2"}, num_to_float(l->primary)},
        {{"sec_1", "sec_2"}, num_to_float(num_sub(l->given, l->primary))},
        {{"sat_1", "sat_2"}, l->cut},
        {{"a1_1", "a1_2"}, l->config.a[PRIMARY]},
        {{"a2_1", "a2_2"}, l->config.a[SECONDARY]},
        {{"kc_1", "kc_2"}, l->config.kc},
        {{"kc2_1", "kc2_2"}, l->config.kc2},
        {{"ko_1", "ko_2"}, l->config.ko},
        {{"freq_1", "freq_2"}, frequency},
        {{"damp_1", "damp_2"}, damping},
    };
    *value = inner[i % INFERENTIAL_INNER].value;
    return inner[i % INFERENTIAL_INNER].name[k];
}
