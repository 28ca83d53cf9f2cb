/* Results of automatic start-up as listings: one fact a line, `name value unit`, for people and programs alike. */
#include <math.h>

#include "base/assertion.h"
#include "commission/commission.h"
#include "commission/words.h"
#include "console/commission_listings.h"
#include "console/commission_structural.h"
#include "console/commission_words.h"
#include "console/phrases.h"

/* What the tests of an input, or of a direction, were like. */
static void tests_of_input(const struct client *c, const struct tested_input *in,
                           const struct mv_config *o, struct text *line)
{
    text_named_float(line, "amplitude", (float)in->amplitude * (o->hi - o->lo));
    text_char(line, ' ');
    commission_unit(line, o->unit);
    text_named_float(line, "half", (float)in->half_s);
    text_str(line, " s rounds ");
    text_u32(line, in->rounds);
    text_named_float(line, "worst", (float)in->worst);
    if (in->skipped)
        text_str(line, " skipped");
    if (in->cut) {
        text_str(line, " cut by ");
        text_str(line, commission_measurement(c, in->cut_by)->name);
    }
    if (in->small)
        text_str(line, " small");
}

static bool input_line(const struct client *c, unsigned k, struct text *line)
{
    const struct tested_input *in = inputs_get(&c->service->commission->inputs, k);
    const struct mv_config *o = commission_output(c, k);
    float span = o->hi - o->lo;
    text_str(line, "input ");
    text_str(line, o->name);
    text_named_float(line, "held", o->lo + (float)in->test_base * span);
    tests_of_input(c, in, o, line);
    return true;
}

/* A response that does not stand out of the noise may be slow and large. The deviation of a lag of a quarter of the level is times this
 * that of lags up to a hundred levels: root of the mean square over their logarithm, of a double step. The analysis uses the quick one. */
#define UNSEEN_TIMES 45.0f

/* Gains in engineering units: what a person would measure. */
static void element_line(const struct client *c, unsigned j, unsigned k, struct text *line)
{
    REFLUX_ASSERT(j < CHANNEL_MAX && k < CHANNEL_MAX);
    const struct element *e = &c->service->commission->work->element[j][k];
    const struct measurement_config *y = commission_measurement(c, j);
    const struct mv_config *u = commission_output(c, k);
    float scale = (y->hi - y->lo) / (u->hi - u->lo);
    const struct shape_found *f = &e->found;
    /* Without a response nothing is known of its times. */
    bool timeless = (e->flags & IDENTIFIED_NO_GAIN) != 0;
    text_str(line, "element ");
    text_str(line, y->name);
    put_word(line, u->name);
    text_named_float(line, "gain", (float)f->shape.gain * scale);
    text_named_float(line, "sd",
                     (float)f->sd[SHAPE_GAIN] * scale * (timeless ? UNSEEN_TIMES : 1.0f));
    text_char(line, ' ');
    commission_unit(line, y->unit);
    text_char(line, '/');
    commission_unit(line, u->unit);
    text_named_float(line, "T", (float)f->shape.lag_s);
    text_named_float(line, "sd", timeless ? NAN : (float)f->sd[SHAPE_LAG]);
    text_named_float(line, "s L", (float)f->shape.dead_time_s);
    text_named_float(line, "sd", timeless ? NAN : (float)f->sd[SHAPE_DEAD]);
    text_str(line, " s");
    if (f->parameters > 3) { /* two lags: their product; and the zero */
        text_named_float(line, "square", (float)f->shape.square_s2);
        text_named_float(line, "sd", (float)f->sd[SHAPE_SQUARE]);
        text_str(line, " s2");
    }
    if (f->parameters > 4) {
        text_named_float(line, "zero", (float)f->shape.zero_s);
        text_named_float(line, "sd", (float)f->sd[SHAPE_ZERO]);
        text_str(line, " s");
    }
    text_named_float(line, "residence", (float)shape_residence_s(&f->shape));
    text_named_float(line, "sd", timeless ? NAN : (float)f->residence_sd_s);
    text_str(line, " s");
    commission_flags(line, e->flags);
}

/* The direction that was tested: its inputs with their shares, in spans, and then what output n - 1 answers to it, in spans as well,
 * beside what the tests of the single inputs say of that. False past the last. */
static bool direction_line(const struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    unsigned k = inputs_count(&m->inputs);
    if (!inputs_has_direction(&m->inputs) || n > outputs_count(&m->outputs))
        return false;
    const struct tested_input *in = inputs_get(&m->inputs, k);
    if (n == 0) {
        text_str(line, "direction");
        for (unsigned i = 0; i < k; i++)
            text_named_float(line, commission_output(c, i)->name, (float)m->work->share[i]);
        tests_of_input(c, in, &client_settings(c)->mv[in->output], line);
        return true;
    }
    if (in->rounds == 0)
        return true;
    const struct element *e = &m->work->element[n - 1u][k];
    real_t sum = REAL_C(0.0), variance = REAL_C(0.0);
    for (unsigned i = 0; i < k; i++) {
        const struct shape_found *f = &m->work->element[n - 1u][i].found;
        real_t sd = m->work->share[i] * f->sd[SHAPE_GAIN];
        sum += m->work->share[i] * f->shape.gain;
        variance += sd * sd;
    }
    text_str(line, "along ");
    text_str(line, commission_measurement(c, n - 1u)->name);
    text_named_float(line, "gain", (float)e->found.shape.gain);
    text_named_float(line, "sd", (float)e->found.sd[SHAPE_GAIN]);
    text_named_float(line, "of single inputs", (float)sum);
    text_named_float(line, "sd", (float)real_sqrt(variance));
    commission_flags(line, e->flags);
    return true;
}

/* Gives the estimates from moments and plateaus of the same test. */
static void second_line(const struct client *c, unsigned j, unsigned k, struct text *line)
{
    REFLUX_ASSERT(j < CHANNEL_MAX && k < CHANNEL_MAX);
    const struct element *e = &c->service->commission->work->element[j][k];
    const struct measurement_config *y = commission_measurement(c, j);
    const struct mv_config *u = commission_output(c, k);
    float scale = (y->hi - y->lo) / (u->hi - u->lo);
    text_str(line, "moments ");
    text_str(line, y->name);
    put_word(line, u->name);
    text_named_float(line, "gain", (float)e->moments.gain * scale);
    text_named_float(line, "T", (float)e->moments.time_constant_s);
    text_named_float(line, "L", (float)e->moments.dead_time_s);
    text_named_float(line, "plateau", (float)e->plateau_gain * scale);
    commission_flags(line, e->moments_flags);
}

bool commission_model_line(struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    unsigned inputs = inputs_count(&m->inputs), outputs = outputs_count(&m->outputs);
    if (inputs == 0 || requests_begin(&m->requests))
        return false; /* or may be overwritten at any time */
    if (by_relay_is_latest(&m->by_relay))
        return commission_relay_line(c, n, line); /* of one loop, and no model */
    if (!commission_keeps(m)) {
        if (n == 0)
            text_str(line, RESULTS_DISCARDED);
        return n == 0;
    }
    if (n == 0)
        operate_startup_shown(&c->session);
    if (n < inputs)
        return input_line(c, n, line);
    n -= inputs;
    if (n < outputs) {
        const struct measurement_config *y = commission_measurement(c, n);
        text_str(line, "output ");
        text_str(line, y->name);
        text_named_float(line, "noise", (float)outputs_noise(&m->outputs)[n] * (y->hi - y->lo));
        text_char(line, ' ');
        commission_unit(line, y->unit);
        /* Its rest, from the operating point: all of it, and what no drift explains. */
        text_named_float(line, "moved", (float)origin_moved(&m->origin, n) * (y->hi - y->lo));
        text_named_float(line, "left", (float)origin_left(&m->origin, n) * (y->hi - y->lo));
        return true;
    }
    n -= outputs;
    unsigned j = n / 2u % outputs, k = n / 2u / outputs;
    if (k >= inputs)
        return direction_line(c, n - 2u * outputs * inputs, line);
    if (inputs_get(&m->inputs, k)->rounds == 0)
        return true;
    if (n % 2u == 0)
        element_line(c, j, k, line);
    else
        second_line(c, j, k, line);
    return true;
}

static void gains_summary(const struct analysis *a, unsigned n, struct text *line)
{
    if (n == 0) {
        text_str(line, "rank ");
        text_u32(line, a->rank);
        text_str(line, " exact ");
        text_u32(line, a->rank_exact);
        text_named_float(line, "condition", (float)a->condition);
        text_named_float(line, "scaled", (float)a->condition_scaled);
        return;
    }
    text_str(line, "singular");
    unsigned most = a->plant.outputs < a->plant.inputs ? a->plant.outputs : a->plant.inputs;
    for (unsigned i = 0; i < most; i++) {
        text_char(line, ' ');
        text_float(line, (float)a->singular[i]);
    }
}

static void null_line(const struct client *c, bool outputs, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct analysis *a = &m->work->analysis;
    unsigned n = outputs ? a->plant.outputs : a->plant.inputs;
    text_str(line, outputs ? "null outputs" : "null inputs");
    for (unsigned i = 0; i < n; i++) {
        put_word(line, outputs
                           ? commission_measurement(c, i)->name
                           : commission_output(c, analysis_job_input(&m->analysis_job, i))->name);
        text_char(line, ' ');
        text_float(line, (float)(outputs ? a->null_output[i] : a->null_input[i]));
    }
}

bool commission_gains_line(struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct analysis *a = &m->work->analysis;
    if (commission_has_nothing(c, n, line))
        return n == 0;
    if (n < 2) {
        gains_summary(a, n, line);
        return true;
    }
    if (n < 4) {
        if (a->n_null)
            null_line(c, n == 3, line);
        return true;
    }
    n -= 4;
    if (n > a->plant.outputs || (n > 0 && !a->has_lambda))
        return false;
    if (n == 0) {
        text_str(line, a->has_lambda ? "rga" : "rga none: the gains have no inverse");
        for (unsigned k = 0; a->has_lambda && k < a->plant.inputs; k++) {
            put_word(line, commission_output(c, analysis_job_input(&m->analysis_job, k))->name);
        }
        return true;
    }
    text_str(line, "rga ");
    text_str(line, commission_measurement(c, n - 1u)->name);
    for (unsigned k = 0; k < a->plant.inputs; k++) {
        text_char(line, ' ');
        text_float(line, (float)a->lambda.value[n - 1u][k]);
    }
    return true;
}

static void why_not(const struct analysis *a, struct text *line)
{
    text_str(line, "no proposal: ");
    if (a->verdict != PAIRING_DETERMINED) {
        text_str(line, "pairing ");
        text_str(line, words_of_verdict(a));
    } else {
        text_str(line, words_of_no_design(a->design_error));
    }
}

static void decoupler_words(const struct analysis *a, struct text *line)
{
    text_str(line, "decoupler ");
    text_str(line, words_of_decoupler(a->decoupler));
    const struct analysis_figures *with = &a->figures[0], *without = &a->figures[1];
    if (!(with->setpoints > REAL_C(0.0)) || !(without->setpoints > REAL_C(0.0)))
        return;
    text_str(line, "; integral of the error, s, after setpoints");
    text_named_float(line, "with", (float)with->setpoints);
    text_named_float(line, "without", (float)without->setpoints);
    text_str(line, ", after loads");
    text_named_float(line, "with", (float)with->loads);
    text_named_float(line, "without", (float)without->loads);
}

static void proposed_loop_line(const struct client *c, unsigned k, struct text *line)
{
    REFLUX_ASSERT(k < INTERACT_MAX);
    const struct commission *m = c->service->commission;
    const struct analysis *a = &m->work->analysis;
    const struct tuning *t = &a->loops.tuning[k];
    const struct trial_loop *p = &a->predicted[k];
    const struct measurement_config *y = commission_measurement(c, a->pairs.output[k]);
    text_str(line, "loop ");
    text_str(line, y->name);
    put_word(line,
             commission_output(c, analysis_job_input(&m->analysis_job, a->pairs.input[k]))->name);
    text_named_float(line, "gain", (float)t->gain);
    text_named_float(line, "ti", (float)t->ti_s);
    text_named_float(line, "td", (float)t->td_s);
    text_str(line, t->action == TUNING_DIRECT ? " direct" : " reverse");
    text_named_float(line, "step", (float)a->config.step * (y->hi - y->lo));
    text_named_float(line, "iae", (float)p->iae * (y->hi - y->lo));
    text_named_float(line, "overshoot", (float)p->peak);
    text_named_float(line, "settles", (float)p->settled_s);
}

bool commission_proposal_line(struct client *c, unsigned n, struct text *line)
{
    const struct analysis *a = &c->service->commission->work->analysis;
    if (by_relay_is_latest(&c->service->commission->by_relay))
        return commission_relay_line(c, n, line);
    if (commission_has_nothing(c, n, line))
        return n == 0;
    if (!a->designed) {
        if (n == 0)
            why_not(a, line);
        return n == 0;
    }
    if (n == 0) {
        text_str(line, "settings PI for the worst of the plants drawn");
        text_named_float(line, "Ms", (float)a->sensitivity.s_worst);
        text_named_float(line, "nominal", (float)a->sensitivity.s_nominal);
        text_named_float(line, "Mt", (float)a->sensitivity.t_worst);
        text_named_float(line, "nominal", (float)a->sensitivity.t_nominal);
        if (a->sensitivity.factor < REAL_C(1.0))
            text_named_float(line, "lowered", (float)a->sensitivity.factor);
        text_named_float(line, "blocks", (float)layout_blocks(&a->layout));
        text_named_float(line, "parts", (float)layout_parts(&a->layout));
        return true;
    }
    if (n == 1) {
        decoupler_words(a, line);
        return true;
    }
    if (n - 2u >= a->pairs.n)
        return commission_structural_line(c, n - 2u - a->pairs.n, line);
    proposed_loop_line(c, n - 2u, line);
    return true;
}
