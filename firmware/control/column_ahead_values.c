/* What `block N` shows of the kind `ahead`. */
#include "control/column_ahead_block.h"

#if CONFIG_BLOCKS

enum { VALUE_MISSED, VALUE_BIAS, VALUE_GIVEN, VALUES };

/* B*, row by row. */
static const char *const element[AHEAD_LOOPS][AHEAD_LOOPS] = {
    {"b_11", "b_12", "b_13", "b_14"},
    {"b_21", "b_22", "b_23", "b_24"},
    {"b_31", "b_32", "b_33", "b_34"},
    {"b_41", "b_42", "b_43", "b_44"},
};

static const char *const of_loop[VALUES][AHEAD_LOOPS] = {
    {"missed_1", "missed_2", "missed_3", "missed_4"},
    {"bias_1", "bias_2", "bias_3", "bias_4"},
    {"given_1", "given_2", "given_3", "given_4"},
};

/* Fraction of the PV's span. */
static float part_of_span(const struct ahead *b, unsigned i, real_t si)
{
    return (float)(si / b->pv[i].span);
}

const char *ahead_describe(const void *state, size_t i, float *value)
{
    const struct ahead *b = state;
    unsigned n = b->loops, k = (unsigned)(i % n), which = (unsigned)(i / n);
    if (which < VALUES) {
        *value = which == VALUE_GIVEN
                     ? num_to_float(b->given[k])
                     : part_of_span(b, k, which == VALUE_MISSED ? b->missed[k] : b->bias[k]);
        return of_loop[which][k];
    }
    which -= VALUES;
    if (which >= n)
        return NULL;
    *value = (float)b->law.b[which][k];
    return element[which][k];
}

#endif
