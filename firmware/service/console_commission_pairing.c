/* `commission pairing`: the pairs, how sure they are, what speaks against them, and what they leave over. */
#include "commission/certainty.h"
#include "commission/commission.h"
#include "service/console.h"

#if COMMISSION_CHANNELS

static const struct measurement_config *measurement(const struct console *c, unsigned j)
{
    return &console_settings(c)->measurement[c->service->commission->measurement[j]];
}

static const struct output_config *output(const struct console *c, unsigned k)
{
    return &console_settings(c)->output[c->service->commission->input[k].output];
}

const char *commission_verdict(const struct analysis *a)
{
    static const char *const words[] = {
        [PAIRING_DETERMINED] = "determined",
        [PAIRING_UNDETERMINED] = "not determined: the gains are not known well enough",
        [PAIRING_SINGULAR] = "not determined: fewer directions than channels",
        [PAIRING_IMPOSSIBLE] = "impossible: no pairs with positive relative gains and indices"};
    const unsigned shape = DOUBT_SHAPE | DOUBT_SHAPE_FINAL;
    if (a->verdict != PAIRING_UNDETERMINED)
        return words[a->verdict];
    if (a->doubts & DOUBT_RANK)
        return words[PAIRING_SINGULAR];
    if ((a->doubts & ~shape) == 0)
        return "not determined: a response is not one that loops are made for";
    if ((a->doubts & ~(shape | DOUBT_SECOND)) == 0)
        return "not determined: gains over residence times give other pairs";
    return words[PAIRING_UNDETERMINED];
}

/* What speaks against the pairing, a line for each; false past the last. */
static bool doubt_line(const struct analysis *a, unsigned n, struct text *line)
{
    switch (n) {
    case 0:
        if (a->doubts & DOUBT_RANK) {
            text_str(line, "doubt");
            text_named_u32(line, "rank", a->rank);
            text_str(line, ": fewer directions than pairs stand out of the errors of the gains");
        }
        return true;
    case 1:
        if (a->doubts & DOUBT_DETERMINANT) {
            text_str(line, "doubt");
            text_named_float(line, "determinant", (float)a->determinant);
            text_str(line, ": standard deviations from 0, where 2.5 are wanted");
        }
        return true;
    case 2:
        if (a->doubts & DOUBT_INTEGRITY) {
            text_str(line, "doubt");
            text_named_float(line, "integrity", (float)a->integrity);
            text_str(line, ": share of draws in which any loops may be in manual, where 0.9 "
                           "is wanted");
        }
        return true;
    default:
        return false;
    }
}

/* Of an element: what its tests left open. */
static void doubt_element_line(const struct console *c, unsigned j, unsigned i, struct text *line)
{
    const struct commission *m = c->service->commission;
    unsigned bits = certainty_flags(&m->work.analysis, (uint8_t)j, (uint8_t)i);
    if (bits == 0)
        return;
    text_str(line, "doubt element ");
    text_str(line, measurement(c, j)->name);
    text_char(line, ' ');
    text_str(line, output(c, m->column[i])->name);
    commission_flags(line, bits);
}

/* Loops that run away where the others are in manual. */
static void subset_line(const struct console *c, struct text *line)
{
    const struct analysis *a = &c->service->commission->work.analysis;
    if (a->negative == 0)
        return;
    text_str(line, "subset");
    text_named_float(line, "niederlinski", (float)a->negative_index);
    text_str(line, " of");
    for (unsigned k = 0; k < a->pairs.n; k++) {
        if (!(a->negative >> k & 1u))
            continue;
        text_char(line, ' ');
        text_str(line, measurement(c, a->pairs.output[k])->name);
    }
}

static void left_line(const char *what, const char *name, const char *others, enum left_over why,
                      struct text *line)
{
    text_str(line, "left ");
    text_str(line, what);
    text_char(line, ' ');
    text_str(line, name);
    if (why == LEFT_UNSEEN) {
        text_str(line, ": no gain of it stands out of its errors");
    } else {
        text_str(line, ": more of these than of the ");
        text_str(line, others);
        text_str(line, ", and the others go better together");
    }
}

/* What was tested and has no loop; false past the last. */
static bool left_over_line(const struct console *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct analysis *a = &m->work.analysis;
    if (n < a->plant.outputs) {
        enum left_over why = certainty_output_left(a, (uint8_t)n);
        if (why != LEFT_NOT)
            left_line("measurement", measurement(c, n)->name, "inputs", why, line);
        return true;
    }
    n -= a->plant.outputs;
    if (n < a->plant.inputs) {
        enum left_over why = certainty_input_left(a, (uint8_t)n);
        if (why != LEFT_NOT)
            left_line("input", output(c, m->column[n])->name, "measurements", why, line);
        return true;
    }
    n -= a->plant.inputs;
    if (n < m->inputs && m->input[n].skipped) {
        text_str(line, "left input ");
        text_str(line, output(c, n)->name);
        text_str(line, ": its test was skipped");
    }
    return n < m->inputs;
}

/* After the pairs: what speaks against them, and what they leave over. */
static bool remarks_line(const struct console *c, unsigned n, struct text *line)
{
    const struct analysis *a = &c->service->commission->work.analysis;
    if (doubt_line(a, n, line))
        return true;
    n -= 3u;
    unsigned elements = (unsigned)a->plant.outputs * a->plant.inputs;
    if (n < elements) {
        doubt_element_line(c, n / a->plant.inputs, n % a->plant.inputs, line);
        return true;
    }
    n -= elements;
    if (n == 0) {
        subset_line(c, line);
        return true;
    }
    return left_over_line(c, n - 1u, line);
}

bool commission_pairing_line(struct console *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct analysis *a = &m->work.analysis;
    if (commission_has_nothing(c, n, line))
        return n == 0;
    if (n == 0) {
        text_str(line, "pairing ");
        text_str(line, commission_verdict(a));
        text_named_float(line, "probability", (float)a->probability);
        text_named_float(line, "niederlinski", (float)a->niederlinski);
        text_named_float(line, "determinant", (float)a->determinant);
        text_named_float(line, "integrity", (float)a->integrity);
        return true;
    }
    n--;
    if (n < a->pairs.n) {
        unsigned j = a->pairs.output[n];
        text_str(line, "pair ");
        text_str(line, measurement(c, j)->name);
        text_char(line, ' ');
        text_str(line, output(c, m->column[a->pairs.input[n]])->name);
        text_named_float(line, "lambda", (float)a->pair_lambda[n]);
        text_named_float(line, "share", (float)a->share[j]);
        if (a->second != SECOND_NONE)
            text_named_float(line, "phi", (float)a->pair_phi[n]);
        return true;
    }
    n -= a->pairs.n;
    if (n == 0) {
        if (a->second != SECOND_NONE)
            text_str(line,
                     a->second == SECOND_AGREES
                         ? "second_opinion agrees: gains over residence times give the same pairs"
                         : "second_opinion differs: gains over residence times give other "
                           "pairs; see the dynamic relative gains");
        return true;
    }
    n--;
    if (n >= a->plant.outputs)
        return remarks_line(c, n - a->plant.outputs, line);
    if (a->ambiguous_outputs >> n & 1u) {
        text_str(line, "open ");
        text_str(line, measurement(c, n)->name);
        text_named_float(line, "share", (float)a->share[n]);
        if (a->rival[n] != INTERACT_NONE) {
            text_str(line, " rival ");
            text_str(line, a->rival[n] < a->plant.inputs ? output(c, m->column[a->rival[n]])->name
                                                         : "-"); /* none of them */
        }
    }
    return true;
}

#endif
