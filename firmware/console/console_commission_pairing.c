/* `commission pairing`: the pairs, how certain they are, doubts, and channels left without a loop. */
#include "commission/commission.h"
#include "commission/words.h"
#include "console/commission_listings.h"
#include "console/commission_words.h"
#include "console/phrases.h"

/* A doubt about the pairing as a whole. */
static void doubt_line(const struct analysis *a, unsigned n, struct text *line)
{
    struct words_doubt doubt;
    if (!words_of_doubt(a, n, &doubt))
        return;
    text_str(line, "doubt");
    text_named_float(line, doubt.name, (float)doubt.value);
    put_reason(line, doubt.text);
}

static void names(const struct client *c, unsigned j, unsigned i, struct text *line)
{
    text_str(line, commission_measurement(c, j)->name);
    put_word(
        line,
        commission_output(c, analysis_job_input(&c->service->commission->analysis_job, i))->name);
}

/* A doubt about an element: its tests left something open. */
static void doubt_element_line(const struct client *c, unsigned j, unsigned i, struct text *line)
{
    const struct commission *m = c->service->commission;
    unsigned bits = certainty_flags(&m->work->analysis, (uint8_t)j, (uint8_t)i);
    if (bits == 0)
        return;
    text_str(line, "doubt element ");
    names(c, j, i, line);
    uint8_t k = analysis_job_input(&m->analysis_job, i);
    text_named_float(line, "half", (float)inputs_get(&m->inputs, k)->half_s);
    text_named_float(line, "s needs", (float)commission_half_needed(m, (uint8_t)j, k));
    text_str(line, " s");
    commission_flags(line, bits);
}

/* Loops that run away where the others are in manual. */
static void subset_line(const struct client *c, struct text *line)
{
    const struct analysis *a = &c->service->commission->work->analysis;
    if (a->negative == 0)
        return;
    text_str(line, "subset");
    text_named_float(line, "niederlinski", (float)a->negative_index);
    text_str(line, " of");
    for (unsigned k = 0; k < a->pairs.n; k++) {
        if ((a->negative & (1u << k)) == 0u)
            continue;
        put_word(line, commission_measurement(c, a->pairs.output[k])->name);
    }
}

static void left_line(const char *what, const char *name, const char *reason, struct text *line)
{
    text_str(line, "left");
    text_named_str(line, what, name);
    put_reason(line, reason);
}

/* A channel that was tested and has no loop; false past the last. */
static bool left_over_line(const struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct analysis *a = &m->work->analysis;
    if (n < a->plant.outputs) {
        const char *reason = words_of_left(certainty_output_left(a, (uint8_t)n));
        if (reason[0])
            left_line("measurement", commission_measurement(c, n)->name, reason, line);
        return true;
    }
    n -= a->plant.outputs;
    if (n >= inputs_count(&m->inputs))
        return false;
    const char *reason = inputs_get(&m->inputs, n)->skipped ? "its test was skipped" : "";
    for (uint8_t i = 0; i < a->plant.inputs; i++)
        if (analysis_job_input(&m->analysis_job, i) == n)
            reason = words_of_left(certainty_input_left(a, i));
    if (reason[0])
        left_line("input", commission_output(c, n)->name, reason, line);
    return true;
}

/* A pairing that would do: the inputs of the paired measurements in their order, up to as many as all of them are looked at for. */
static void choice_line(const struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct analysis *a = &m->work->analysis;
    if (n >= a->choice.n || a->choice.n < 2)
        return;
    const struct choice_candidate *one = &a->choice.list[n];
    text_str(line, n == a->choice.chosen ? "choice taken" : "choice");
    text_named_float(line, "sound", (float)one->sound);
    text_named_float(line, "niederlinski", (float)one->niederlinski);
    if (one->has_settings)
        text_named_float(line, "speed", (float)one->speed);
    if (one->negative)
        text_str(line, " subset_negative");
    text_str(line, " inputs");
    for (unsigned k = 0; k < a->pairs.n && a->pairs.n <= CANDIDATES_LOOPS; k++)
        put_word(line,
                 commission_output(c, analysis_job_input(&m->analysis_job, one->input[k]))->name);
}

/* The lines behind the pairs: doubts, and channels left without a loop. */
static bool remarks_line(const struct client *c, unsigned n, struct text *line)
{
    const struct analysis *a = &c->service->commission->work->analysis;
    if (n < WORDS_DOUBTS) {
        doubt_line(a, n, line);
        return true;
    }
    n -= WORDS_DOUBTS;
    unsigned elements = (unsigned)a->plant.outputs * a->plant.inputs;
    if (n < elements) {
        doubt_element_line(c, n / a->plant.inputs, n % a->plant.inputs, line);
        return true;
    }
    n -= elements;
    if (n < CANDIDATES_MAX) {
        choice_line(c, n, line);
        return true;
    }
    n -= CANDIDATES_MAX;
    if (n == 0) {
        subset_line(c, line);
        return true;
    }
    return left_over_line(c, n - 1u, line);
}

bool commission_pairing_line(struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct analysis *a = &m->work->analysis;
    if (commission_has_nothing(c, n, line))
        return n == 0;
    if (n == 0) {
        text_str(line, "pairing ");
        text_str(line, words_of_verdict(a));
        text_named_float(line, "probability", (float)a->probability);
        text_named_float(line, "niederlinski", (float)a->niederlinski);
        text_named_float(line, "determinant", (float)a->determinant);
        return true;
    }
    n--;
    if (n < a->pairs.n) {
        unsigned j = a->pairs.output[n];
        text_str(line, "pair ");
        names(c, j, a->pairs.input[n], line);
        text_named_float(line, "lambda", (float)a->pair_lambda[n]);
        text_named_float(line, "share", (float)a->share[j]);
        if (layout_second(&a->layout) != SECOND_NONE)
            text_named_float(line, "phi", (float)layout_phi(&a->layout, n));
        if (a->designed && a->crossover[n] > REAL_C(0.0)) {
            text_named_float(line, "crossover_lambda", (float)a->crossover_lambda[n]);
            text_named_float(line, "rad_per_s", (float)a->crossover[n]);
        }
        return true;
    }
    n -= a->pairs.n;
    if (n == 0) {
        if (layout_second(&a->layout) != SECOND_NONE) {
            text_str(line, "second_opinion ");
            text_str(line, words_of_second(layout_second(&a->layout)));
        }
        return true;
    }
    n--;
    if (n >= a->plant.outputs)
        return remarks_line(c, n - a->plant.outputs, line);
    if (certainty_is_open(&a->certainty, n)) {
        text_str(line, "open ");
        text_str(line, commission_measurement(c, n)->name);
        text_named_float(line, "share", (float)a->share[n]);
        if (a->rival[n] != INTERACT_NONE) {
            text_str(line, " rival ");
            text_str(
                line,
                a->rival[n] < a->plant.inputs
                    ? commission_output(c, analysis_job_input(&m->analysis_job, a->rival[n]))->name
                    : "-"); /* none of them */
        }
    }
    return true;
}
