/* What `block N` shows of the kind `ahead`. */
#include "kinds/ahead/column_ahead_block.h"

enum { VALUE_MISSED, VALUE_BIAS, VALUE_GIVEN, VALUE_DOUBT, VALUES };

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
    {"doubt_1", "doubt_2", "doubt_3", "doubt_4"},
};

/* Of a loop; missed and bias as fractions of the PV's span. */
static real_t value_of_loop(const struct ahead *b, unsigned which, unsigned k)
{
    switch (which) {
    case VALUE_MISSED:
        return b->missed[k] / b->pv[k].span;
    case VALUE_BIAS:
        return b->bias[k] / b->pv[k].span;
    case VALUE_GIVEN:
        return num_to_float(b->given[k]);
    default:
        return b->worse[k];
    }
}

const char *ahead_describe(const void *state, size_t i, float *value)
{
    const struct ahead *b = state;
    unsigned n = b->loops, k = (unsigned)(i % n), which = (unsigned)(i / n);
    if (which < VALUES) {
        *value = (float)value_of_loop(b, which, k);
        return of_loop[which][k];
    }
    which -= VALUES;
    if (which >= n)
        return NULL;
    *value = (float)b->law.b[which][k];
    return element[which][k];
}
