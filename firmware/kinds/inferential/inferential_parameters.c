#include "kinds/inferential/inferential_parameters.h"

#include "base/assertion.h"
#include "block/refuse.h"
#include "num/real.h"

#define PLACE(field) offsetof(struct inferential_settings, field)
#define OF_LOOP(id, field, name, unit, help, lo, hi, initial)                                      \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE(field), 2, 1, name, unit, help, lo, hi, initial                     \
    }
/* Row: loop; columns: primary, secondary. */
#define OF_BOTH(id, field, name, unit, help, lo, hi, initial)                                      \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE(field), 2, 2, name, unit, help, lo, hi, initial                     \
    }
#define NUMBER(id, field, name, unit, help, lo, hi, initial)                                       \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE(field), 1, 1, name, unit, help, lo, hi, initial                     \
    }
#define WORDS(id, field, rows, name, words, help, initial)                                         \
    {                                                                                              \
        id, BLOCK_WORD, PLACE(field), rows, 1, name, words, help, 0, 0, initial                    \
    }

const struct block_parameter inferential_parameter_rows[INFERENTIAL_PARAMETER_ROWS] = {
    WORDS(1, law, 2, "law", "hold|conventional|cascade|clf", "control law", LAW_CONVENTIONAL),
    WORDS(2, form, 1, "form", "euler|joint", "form of the steps", FORM_EULER),
    {3, BLOCK_U16, PLACE(second), 2, 1, "second", "-",
     "number of its secondary temperature; 0: the k-th", 0, INFERENTIAL_LOOPS, 0},
    OF_BOTH(4, a, "a", "EU/h", "slopes, per unit of the MV; 0: from the next ones", -1e6f, 1e6f, 0),
    WORDS(5, moves, 2, "moves", "none|reflux|heat", "role of the MV", MOVES_NONE),
    OF_BOTH(6, gradient, "gradient", "EU", "from its stage to the next one up; 0: not given", -1000,
            1000, 0),
    OF_BOTH(7, holdup, "holdup", "kmol", "of its stage", 0, 1e6f, 0),
    OF_BOTH(8, lv, "lv", "-", "liquid to vapour in its section", 0.01f, 100, 1),
    OF_LOOP(9, flow, "flow", "kmol", "per unit of the MV", 0, 1e6f, 0),
    WORDS(10, scaling, 1, "scaling", "consistent|printed", "of slopes from gradients",
          SCALING_CONSISTENT),
    {11, BLOCK_U16, PLACE(parts), 1, 1, "parts", "-", "components, for the printed scaling", 2, 10,
     2},
    {12, BLOCK_U16, PLACE(stage), 2, 2, "stage", "-", "number of its stage; 0: not given", 0, 200,
     0},
    OF_LOOP(13, w, "w", "1/h", "4 over the time after which it has settled within 2 %", 0, 1e5f, 0),
    NUMBER(14, kc_w, "kc_w", "-", "kc over w", 0.1f, 10, 2),
    NUMBER(15, kc2_kc, "kc2_kc", "-", "kc2 over kc", 0.1f, 10, 2),
    NUMBER(16, ko_kc, "ko_kc", "-", "ko over kc", 0.1f, 100, 10),
    OF_LOOP(17, wh, "wh", "1/h", "frequency of the holdups; 0: 100 w", 0, 1e6f, 0),
    OF_LOOP(18, kc, "kc", "1/h", "gain of the primary; 0: from w", 0, 1e5f, 0),
    OF_LOOP(19, kc2, "kc2", "1/h", "of the secondary; 0: from kc", 0, 1e5f, 0),
    OF_LOOP(20, ko, "ko", "1/h", "of the observers; 0: from kc", 0, 1e5f, 0),
};
_Static_assert(INFERENTIAL_LOOPS == 2, "rows of the table");

/* ---- slopes and gains ---- */

/* Returns a slope with the sign of the gradient; 0 where no gradient is given. Frau (4.5), docs/methods/inferential.md. */
static float slope_from_gradient(const struct inferential_settings *c, unsigned k, unsigned i)
{
    float size = c->flow[k] * c->gradient[k][i];
    if (c->scaling == SCALING_PRINTED)
        size *= (float)c->parts;
    if (!(c->holdup[k][i] > 0) || c->moves[k] == MOVES_NONE)
        return 0;
    return (c->moves[k] == MOVES_HEAT ? -size * c->lv[k][i] : size) / c->holdup[k][i];
}

static float slope_of(const struct inferential_settings *c, unsigned k, unsigned i)
{
    return c->a[k][i] != 0 ? c->a[k][i] : slope_from_gradient(c, k, i);
}

/* Holdups are so much faster than the temperature, and the observer has to be so much slower. */
#define HOLDUPS_FASTER  100.0f
#define OBSERVER_SLOWER 3.0f

/* Returns the fastest observer, 1/h; 0: it is not known. */
static float fastest_observer(const struct inferential_settings *c, unsigned k)
{
    return (c->wh[k] > 0 ? c->wh[k] : HOLDUPS_FASTER * c->w[k]) / OBSERVER_SLOWER;
}

static void gains_of(const struct inferential_settings *c, unsigned k,
                     struct inferential_config *out)
{
    float most = fastest_observer(c, k);
    out->kc = c->kc[k] > 0 ? c->kc[k] : c->kc_w * c->w[k];
    out->kc2 = c->kc2[k] > 0 ? c->kc2[k] : c->kc2_kc * out->kc;
    out->ko = c->ko_kc * out->kc;
    if (most > 0 && out->ko > most)
        out->ko = most;
    if (c->ko[k] > 0)
        out->ko = c->ko[k];
}

unsigned inferential_second(const struct block_setup *setup, unsigned k)
{
    const struct inferential_settings *c = setup->settings;
    unsigned seconds =
        setup->inputs > setup->members ? setup->inputs - (unsigned)setup->members : 0;
    unsigned n = c->second[k] ? c->second[k] - 1u : k;
    return n < seconds ? n : INFERENTIAL_NONE;
}

void inferential_config_of(const struct block_setup *setup, unsigned k,
                           struct inferential_config *out)
{
    REFLUX_ASSERT(k < setup->members && setup->inputs >= setup->members);
    const struct inferential_settings *c = setup->settings;
    unsigned second = inferential_second(setup, k);
    const struct block_signal *mv = &setup->input[setup->inputs - setup->members + k];
    const struct block_signal *t2 =
        second == INFERENTIAL_NONE ? &setup->pv[k] : &setup->input[second];
    *out = (struct inferential_config){.law = c->law[k],
                                       .form = c->form,
                                       .a = {slope_of(c, k, PRIMARY), slope_of(c, k, SECONDARY)},
                                       .interval_h = setup->interval_s / 3600,
                                       .span = {setup->pv[k].hi - setup->pv[k].lo, t2->hi - t2->lo},
                                       .u_span = mv->hi - mv->lo};
    gains_of(c, k, out);
}

/* ---- check ---- */

static bool uses_second_of(const struct inferential_settings *c, unsigned k)
{
    return c->law[k] == LAW_CASCADE || c->law[k] == LAW_CLF;
}

static enum err check_inputs(const struct block_setup *setup, struct block_fault *fault)
{
    if (setup->members < 1 || setup->members > INFERENTIAL_LOOPS)
        return block_refuse(fault, 0, "loops", "needs one or two");
    if (setup->inputs < setup->members)
        return block_refuse(fault, 0, "inputs", "needs the MV of each loop last, in their order");
    unsigned seconds = setup->inputs - (unsigned)setup->members;
    if (seconds > INFERENTIAL_LOOPS)
        return block_refuse(fault, 0, "inputs", "needs no more than two secondary temperatures");
    for (unsigned j = 0; j < seconds; j++)
        if (setup->input[j].is_mv)
            return block_refuse(fault, 0, "inputs", "needs temperatures, then the MV of each loop");
    for (unsigned k = 0; k < setup->members; k++)
        if ((setup->present & (1u << k)) &&
            setup->input[seconds + k].is_mv != setup->member[k].drives_mv)
            return block_refuse(fault, k, "inputs",
                                setup->member[k].drives_mv
                                    ? "needs the MV of each loop last, in their order"
                                    : "needs the PV of the loop that is driven, as its MV");
    return ERR_OK;
}

/* Refuses a stage that is given twice. */
static enum err check_stages(const struct block_setup *setup, struct block_fault *fault)
{
    const struct inferential_settings *c = setup->settings;
    for (unsigned k = 0; k < setup->members; k++) {
        uint16_t own = c->stage[k][PRIMARY], second = c->stage[k][SECONDARY];
        if (own && own == second)
            return block_refuse(fault, k, "stage", "needs two different stages for a loop");
        if (k && own && own == c->stage[0][PRIMARY])
            return block_refuse(fault, k, "stage", "needs a stage of its own for each loop");
    }
    return ERR_OK;
}

static enum err check_slope(const struct inferential_settings *c, unsigned k, unsigned i,
                            struct block_fault *fault)
{
    float sign = c->moves[k] == MOVES_HEAT ? -c->gradient[k][i] : c->gradient[k][i];
    if (slope_of(c, k, i) == 0)
        return block_refuse(fault, k, "a", "needs a slope, or moves, gradient, holdup and flow");
    if (c->moves[k] != MOVES_NONE && c->a[k][i] * sign < 0)
        return block_refuse(fault, k, "a",
                            "has the wrong sign for its gradient: positive feedback");
    return ERR_OK;
}

static enum err check_gains(const struct inferential_settings *c, unsigned k,
                            struct block_fault *fault)
{
    float most = fastest_observer(c, k);
    if (!(c->w[k] > 0) && !(c->kc[k] > 0))
        return block_refuse(fault, k, "w", "must be above 0, or kc given");
    if (most > 0 && c->ko[k] > most)
        return block_refuse(fault, k, "ko", "must be a third of wh or less");
    return ERR_OK;
}

/* In a column both temperatures of a loop go the same way; where they do not, they are not of one column. */
static enum err check_signs(const struct inferential_settings *c, unsigned k,
                            struct block_fault *fault)
{
    if (slope_of(c, k, PRIMARY) * slope_of(c, k, SECONDARY) < 0)
        return block_refuse(fault, k, "a", "needs slopes of the same sign in a loop");
    return ERR_OK;
}

static enum err check_loop(const struct block_setup *setup, unsigned k, struct block_fault *fault)
{
    const struct inferential_settings *c = setup->settings;
    struct inferential_config config;
    const char *field = "";
    if (c->law[k] == LAW_HOLD)
        return ERR_OK;
    enum err err = check_gains(c, k, fault);
    if (!err)
        err = check_slope(c, k, PRIMARY, fault);
    if (!err && uses_second_of(c, k)) {
        if (inferential_second(setup, k) == INFERENTIAL_NONE)
            return block_refuse(fault, k, "inputs", "needs the secondary temperature of its law");
        err = check_slope(c, k, SECONDARY, fault);
        if (!err)
            err = check_signs(c, k, fault);
    }
    if (err)
        return err;
    inferential_config_of(setup, k, &config);
    const char *wrong = inferential_wrong(&config, &field);
    return wrong ? block_refuse(fault, k, field, wrong) : ERR_OK;
}

enum err inferential_check(const struct block_setup *setup, struct block_fault *fault)
{
    enum err err = check_inputs(setup, fault);
    if (!err)
        err = check_stages(setup, fault);
    for (unsigned k = 0; k < setup->members && !err; k++)
        if (setup->present & (1u << k))
            err = check_loop(setup, k, fault);
    return err;
}
