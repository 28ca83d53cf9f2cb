/* What the console shows of the kind `state_law`. */
#include "kinds/state_law/state_law_block.h"

const char *state_law_describe(const void *state, size_t i, float *value)
{
    const struct state_law_block *b = state;
    const struct state_law_found *f = &b->found;
    const char *const names[] = {"stage",    "index_1",          "K_star_1", "index_2",
                                 "K_star_2", "condition",        "zeros",    "outermost_zero",
                                 "radius",   "radius_by_inputs", "left_of_F"};
    const float values[] = {b->stage,     f->index[0],      f->k_star[0], f->index[1],
                            f->k_star[1], f->condition,     f->zeros,     f->zero,
                            f->radius,    f->inputs_radius, f->left};
    size_t all = sizeof values / sizeof values[0];
    if (b->stage == STATE_LAW_REFUSED && i == 0) {
        *value = f->loop;
        return b->refused;
    }
    i -= b->stage == STATE_LAW_REFUSED ? 1u : 0u;
    if (i >= all)
        return NULL;
    *value = values[i];
    return names[i];
}
