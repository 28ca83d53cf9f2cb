/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "kinds/derived/derived_parameters.h"

#include "block/refuse.h"

#define PLACE(field) offsetof(struct derived_settings, field)
#define POINTS(id, type, field, name, unit, help, lo, hi, initial)                                 \
    {                                                                                              \
        id, type, PLACE(field), DERIVED_POINTS, 1, name, unit, help, lo, hi, initial               \
    }

const struct block_parameter derived_parameter_rows[DERIVED_PARAMETER_ROWS] = {
    POINTS(1, BLOCK_WORD, form, "is", "sum|mean|rate|total|boil", "form", 0, 0, DERIVED_SUM),
    {2, BLOCK_FLOAT, PLACE(weight), DERIVED_POINTS, DERIVED_INPUTS, "weight", "-",
     "of each input; 0: not used", -1e9f, 1e9f, 0},
    POINTS(3, BLOCK_FLOAT, zero, "zero", "EU", "added to the weighted inputs", -1e9f, 1e9f, 0),
    POINTS(4, BLOCK_U16, by, "by", "-", "input that divides a sum, pressure of boil; 0: none", 0,
           DERIVED_INPUTS, 0),
    POINTS(5, BLOCK_FLOAT, reference, "at", "EU", "neutral value of `by`", 0, 1e9f, 0),
    POINTS(6, BLOCK_U16, power, "power", "-", "of by/at", 1, 2, 1),
    POINTS(7, BLOCK_FLOAT, ahead_s, "ahead", "s", "sum: time to look ahead", 0, 1e5f, 0),
    POINTS(8, BLOCK_FLOAT, lag_s, "lag", "s", "of rates", 0, 1e5f, 10),
    POINTS(9, BLOCK_U16, least, "least", "-", "mean: inputs that must be usable; 0: all", 0,
           DERIVED_INPUTS, 0),
    POINTS(10, BLOCK_WORD, per, "per", "s|min|h", "time in the unit of the flow", 0, 0,
           DERIVED_PER_S),
    POINTS(11, BLOCK_FLOAT, wrap, "wrap", "EU", "a counter begins anew there; 0: no counter", 0,
           1e9f, 0),
    POINTS(12, BLOCK_FLOAT, cut, "cut", "EU", "total: smaller flows are none", 0, 1e9f, 0),
    POINTS(13, BLOCK_FLOAT, slope, "slope", "K", "boil: rise by a unit of pressure", -1e6f, 1e6f,
           0),
    POINTS(14, BLOCK_FLOAT, bend, "bend", "-", "boil: of the rise over ln p", 0, 0.5f, 0.1f),
};

/* Returns what is wrong with point k, in words, and with which parameter, or NULL. */
static const char *derived_wrong(const struct derived_settings *s, unsigned inputs, unsigned k,
                                 const char **field)
{
    unsigned used = 0, form = s->form[k];
    bool boils = form == DERIVED_BOIL, flows = form == DERIVED_RATE || form == DERIVED_TOTAL;
    *field = "weight";
    for (unsigned i = 0; i < DERIVED_INPUTS; i++) {
        float w = s->weight[k][i];
        if ((w != 0 && i >= inputs) || (w < 0 && form == DERIVED_MEAN))
            return "must be of an input, and positive in a mean";
        used += w != 0 ? 1u : 0u;
    }
    if (!used)
        return "needs one for each point";
    *field = "least";
    if (s->least[k] > used)
        return "must be at most the number of inputs";
    *field = "by";
    if (s->by[k] > inputs || (boils ? !s->by[k] : s->by[k] && form != DERIVED_SUM))
        return "must be an input, of sum and boil only";
    *field = "at";
    if (s->by[k] && !(s->reference[k] > 0))
        return "must be above 0";
    *field = "wrap";
    if (s->wrap[k] > 0 && (!flows || used > 1))
        return "needs rate or total, and one input";
    *field = "ahead";
    if (s->ahead_s[k] > 0 && (form != DERIVED_SUM || !(s->lag_s[k] > 0)))
        return "needs a sum and a lag";
    return NULL;
}

enum err derived_check(const struct block_setup *setup, struct block_fault *fault)
{
    if (!setup->points)
        return block_refuse(fault, 0, "points", "needs one at least");
    for (unsigned k = 0; k < setup->points; k++) {
        const char *field, *wrong = derived_wrong(setup->settings, setup->inputs, k, &field);
        if (wrong)
            return block_refuse(fault, 0, field, wrong);
    }
    return ERR_OK;
}
