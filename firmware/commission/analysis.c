#include "commission/analysis.h"

#include "base/assertion.h"
#include "commission/analysis_choice.h"
#include "commission/analysis_crossover.h"
#include "commission/analysis_settings.h"
#include "commission/analysis_structure.h"
#include "commission/certainty.h"
#include "exchange/plan.h"
#include "plan/plan_blocks.h"

#include <stddef.h>
#include <string.h>

#define HORIZON REAL_C(5.0) /* times integral and dead time: settling time of a single loop */
/* A decoupler makes the loops depend on each other: it must be better by a tenth in setpoints as in loads. */
#define PAYS       REAL_C(0.81)
#define EXTENSIONS 2u
#define LONGER     REAL_C(4.0) /* times the duration in which a step did not settle */
#define LONGEST_S  REAL_C(1e7) /* longest trial */

_Static_assert(STATIC_DECOUPLER_LOOPS <= DECOUPLER_MAX, "a decoupler of ours fits");

enum err analysis_begin(struct analysis *a, const struct analysis_config *config)
{
    if (!(config->h_s > REAL_C(0.0)) || !(config->confidence > REAL_C(0.5)) ||
        !(config->confidence < REAL_C(1.0)) || !(config->step > REAL_C(0.0)))
        return ERR_RANGE;
    enum err err = interact_check(&a->plant, NULL);
    for (uint8_t j = 0; j < a->plant.outputs && !err; j++)
        err = a->given[j] > a->plant.inputs ? ERR_RANGE : ERR_OK;
    if (err)
        return err;
    memset((char *)a + offsetof(struct analysis, config), 0,
           sizeof *a - offsetof(struct analysis, config));
    a->config = *config;
    a->stage = ANALYSIS_GAINS;
    return gains_begin(&a->work.gains, &a->plant, config->floor);
}

/* Takes the pairs that are given; where they are as many as there can be, the other channels get none. */
static void take_given(const struct analysis *a, struct pairing_config *c)
{
    uint16_t inputs = 0, outputs = 0;
    choice_keep_apart(a, c->apart);
    uint8_t n = 0, most = a->plant.inputs < a->plant.outputs ? a->plant.inputs : a->plant.outputs;
    for (uint8_t j = 0; j < a->plant.outputs; j++) {
        if (a->given[j] == 0)
            continue;
        outputs = (uint16_t)(outputs | 1u << j);
        inputs = (uint16_t)(inputs | 1u << (a->given[j] - 1u));
        n++;
    }
    if (n == most) {
        c->outputs_out = (uint16_t)(c->outputs_out | (0xffffu ^ outputs));
        c->inputs_out = (uint16_t)(0xffffu ^ inputs);
    }
}

static enum err begin_pairing(struct analysis *a)
{
    struct pairing_config c;
    pairing_config_default(&c);
    c.confidence = a->config.confidence;
    c.floor = a->config.floor;
    c.outputs_out = layout_inner_outputs(&a->layout);
    take_given(a, &c);
    a->stage = ANALYSIS_PAIRING;
    return pairing_begin(&a->work.pairing, &a->plant, &c, NULL);
}

static enum err end_gains(struct analysis *a)
{
    const struct gains *g = &a->work.gains;
    memcpy(a->singular, g->singular, sizeof a->singular);
    memcpy(a->weakest, g->weakest, sizeof a->weakest);
    a->condition = g->condition;
    a->condition_scaled = g->condition_scaled;
    a->rank = g->rank;
    a->rank_exact = g->rank_exact;
    uint8_t smaller = a->plant.inputs < a->plant.outputs ? a->plant.inputs : a->plant.outputs;
    a->n_null = (uint8_t)(smaller - g->rank);
    if (gains_null_input(g, 0, a->null_input) != ERR_OK)
        memset(a->null_input, 0, sizeof a->null_input);
    if (gains_null_output(g, 0, a->null_output) != ERR_OK)
        memset(a->null_output, 0, sizeof a->null_output);
    interact_gains(&a->plant, NULL, &a->work.rga.gains);
    a->has_lambda = rga_compute(&a->work.rga.gains, &a->work.rga.work, &a->lambda) == ERR_OK;
    a->stage = ANALYSIS_CASCADES;
    return ERR_OK;
}

/* Takes the pairs in the order of the outputs, and what the draws say of them. */
static enum err end_pairing(struct analysis *a)
{
    const struct pairing *p = &a->work.pairing;
    a->verdict = p->verdict;
    a->pairs = p->pairs;
    a->niederlinski = p->niederlinski;
    a->probability = p->probability;
    memcpy(a->pair_lambda, p->lambda, sizeof a->pair_lambda);
    memcpy(a->share, p->share, sizeof a->share);
    memcpy(a->rival, p->rival, sizeof a->rival);
    a->determinant = p->determinant;
    a->channels = p->channels;
    a->negative = p->negative;
    a->negative_index = p->negative_index;
    a->certainty.ambiguous_outputs = p->ambiguous_outputs;
    a->stage = ANALYSIS_DONE;
    if (a->pairs.n == 0)
        return ERR_OK;
    a->stage = ANALYSIS_CANDIDATES;
    return choice_begin(a);
}

static enum err end_choice(struct analysis *a)
{
    a->verdict = PAIRING_DETERMINED;
    certainty_of_gains(a, &a->verdict);
    a->stage = ANALYSIS_SECOND;
    return ERR_BUSY;
}

static enum err end_second(struct analysis *a)
{
    analysis_ask_second(a);
    bool determined = a->verdict == PAIRING_DETERMINED;
    a->stage = determined ? ANALYSIS_STRUCTURE : ANALYSIS_DONE;
    return determined ? ERR_BUSY : ERR_OK;
}

static enum err do_structure(struct analysis *a)
{
    analysis_find_structure(a);
    analysis_close_inner_loops(a, &a->plant);
    a->stage = ANALYSIS_DECOUPLER;
    return ERR_BUSY;
}

static void identity(struct matrix *d, uint8_t n)
{
    memset(d, 0, sizeof *d);
    d->rows = d->cols = n;
    for (uint8_t k = 0; k < n; k++)
        d->value[k][k] = REAL_C(1.0);
}

/* Designs a decoupler for a block that single loops would control badly. */
static void decouple_block(struct analysis *a, const struct block *block)
{
    REFLUX_ASSERT(a->pairs.n <= INTERACT_MAX);
    struct pairs part = {0};
    uint8_t place[INTERACT_MAX];
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        if (!(block->pairs >> k & 1u))
            continue;
        place[part.n] = k;
        part.output[part.n] = a->pairs.output[k];
        part.input[part.n++] = a->pairs.input[k];
    }
    struct static_decoupler_config c;
    static_decoupler_config_default(&c);
    enum err err = static_decoupler(&a->plant, &part, &c, &a->work.decoupler.work,
                                    &a->work.decoupler.result, NULL);
    if (err) {
        a->decoupler = err == ERR_FULL ? DECOUPLER_TOO_MANY : DECOUPLER_ILL;
        return;
    }
    if (a->decoupler == DECOUPLER_NOT_NEEDED)
        a->decoupler = DECOUPLER_USED;
    for (uint8_t i = 0; i < part.n; i++)
        for (uint8_t j = 0; j < part.n; j++)
            a->d.value[place[i]][place[j]] = a->work.decoupler.result.d.value[i][j];
}

/* The firmware takes a decoupler whose every part has an inverse: any loop may go to manual. */
static bool firmware_takes(const struct matrix *d)
{
    float matrix[DECOUPLER_MAX][DECOUPLER_MAX] = {{0.0f}};
    for (unsigned i = 0; i < d->rows; i++)
        for (unsigned j = 0; j < d->cols; j++)
            matrix[i][j] = (float)d->value[i][j];
    return plan_accepts_matrix(matrix, (uint8_t)d->rows);
}

static void without_decoupler(struct analysis *a, enum analysis_decoupler reason)
{
    a->decoupler = reason;
    identity(&a->d, a->pairs.n);
}

/* There are no settings with the present decoupler. */
static enum err no_design(struct analysis *a, enum err reason)
{
    a->design_error = reason;
    a->stage = ANALYSIS_ALTERNATIVE;
    return ERR_OK;
}

static enum err begin_settings(struct analysis *a)
{
    a->stage = ANALYSIS_SETTINGS;
    enum err err = settings_begin(a, a->decoupler == DECOUPLER_USED);
    return err ? no_design(a, err) : ERR_OK;
}

static enum err do_decoupler(struct analysis *a)
{
    /* The firmware's matrix takes a limited number of loops, whichever they are. */
    bool spanned = a->pairs.n <= STATIC_DECOUPLER_LOOPS;
    without_decoupler(a, spanned ? DECOUPLER_NOT_NEEDED : DECOUPLER_TOO_MANY);
    const struct structure *s = layout_structure(&a->layout);
    for (uint8_t b = 0; spanned && s && b < s->blocks; b++)
        if (s->block[b].mimo)
            decouple_block(a, &s->block[b]);
    if (a->decoupler == DECOUPLER_USED && !firmware_takes(&a->d))
        without_decoupler(a, DECOUPLER_ILL);
    a->compares = a->decoupler == DECOUPLER_USED;
    return begin_settings(a);
}

static void set_horizon(struct analysis *a)
{
    a->horizon_s = REAL_C(0.0);
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        real_t dead = a->plant.element[a->pairs.output[k]][a->pairs.input[k]].dead_time_s;
        real_t h = HORIZON * (a->loops.tuning[k].ti_s + dead);
        a->horizon_s = h > a->horizon_s ? h : a->horizon_s;
    }
}

/* duration_s 0: fifteen times the slowest loop by itself; interaction may make loops far slower. */
static enum err begin_prediction(struct analysis *a, real_t duration_s)
{
    struct trial_config c = {.loop = a->turn,
                             .load = a->load,
                             .size = a->config.step,
                             .duration_s = duration_s,
                             .mark_s = a->horizon_s,
                             .setpoint_weight = REAL_C(1.0)};
    a->stage = ANALYSIS_PREDICTION;
    enum err err = trial_begin(&a->work.trial, &a->plant, &a->loops, &c);
    return err ? no_design(a, ERR_UNSUPPORTED) : ERR_OK;
}

static enum err end_rule(struct analysis *a, enum err err)
{
    if (err)
        return no_design(a, err);
    a->stage = ANALYSIS_ROBUST;
    err = settings_begin_search(a, a->config.members);
    return err ? no_design(a, ERR_UNSUPPORTED) : ERR_OK;
}

static enum err end_settings_search(struct analysis *a, enum err err)
{
    if (err)
        return no_design(a, err);
    if (analysis_loops(a) > a->config.loops_max)
        return no_design(a, ERR_FULL);
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        if (!analysis_loop_takes(&a->loops.tuning[k]))
            return no_design(a, ERR_UNSUPPORTED);
    }
    a->bounded = true;
    a->load = false;
    a->turn = 0;
    set_horizon(a);
    return begin_prediction(a, REAL_C(0.0));
}

static enum err end_design(struct analysis *a)
{
    if (!a->bounded)
        return no_design(a, ERR_RANGE);
    a->designed = true;
    a->stage = ANALYSIS_ALTERNATIVE;
    return ERR_OK;
}

/* Adds the integrals of the errors of all loops after the step of one. */
static void count(struct analysis *a)
{
    const struct trial *t = &a->work.trial;
    struct analysis_figures *f = &a->figures[a->decoupler != DECOUPLER_USED];
    real_t *sum = a->load ? &f->loads : &f->setpoints;
    for (uint8_t k = 0; k < a->pairs.n; k++)
        *sum += t->loop[k].iae / (a->config.step * (real_t)a->pairs.n);
}

static enum err end_load(struct analysis *a)
{
    count(a);
    a->load = false;
    a->bounded = a->bounded && a->work.trial.bounded;
    return ++a->turn < a->pairs.n ? begin_prediction(a, REAL_C(0.0)) : end_design(a);
}

static enum err end_prediction(struct analysis *a)
{
    REFLUX_ASSERT(a->turn < a->pairs.n);
    const struct trial *t = &a->work.trial;
    if (a->extended == 0) /* later ones may have longer samples */
        a->tried[a->turn] = t->mark;
    real_t longer_s = LONGER * t->duration_s;
    if (longer_s > LONGEST_S)
        longer_s = LONGEST_S;
    if (t->bounded && t->loop[a->turn].settled_s >= REAL_C(0.95) * t->duration_s &&
        a->extended < EXTENSIONS && t->duration_s < longer_s) {
        a->extended++;
        return begin_prediction(a, longer_s);
    }
    a->extended = 0;
    a->predicted[a->turn] = t->loop[a->turn];
    a->bounded = a->bounded && t->bounded;
    if (a->compares) { /* its load next, for as long */
        count(a);
        a->load = true;
        return begin_prediction(a, t->duration_s);
    }
    return ++a->turn < a->pairs.n ? begin_prediction(a, REAL_C(0.0)) : end_design(a);
}

static void keep_decoupled(struct analysis *a)
{
    struct analysis_design *d = &a->decoupled;
    d->loops = a->loops;
    d->sensitivity = a->sensitivity;
    d->horizon_s = a->horizon_s;
    memcpy(d->predicted, a->predicted, sizeof d->predicted);
    memcpy(d->tried, a->tried, sizeof d->tried);
    d->d = a->d;
}

static void take_decoupled(struct analysis *a)
{
    const struct analysis_design *d = &a->decoupled;
    a->decoupler = DECOUPLER_USED;
    a->d = d->d;
    a->loops = d->loops;
    a->sensitivity = d->sensitivity;
    a->horizon_s = d->horizon_s;
    memcpy(a->predicted, d->predicted, sizeof a->predicted);
    memcpy(a->tried, d->tried, sizeof a->tried);
    a->designed = true;
    a->design_error = ERR_OK;
}

/* The decoupler is better, setpoints and loads together. A decoupler always helps setpoints, but often not loads. */
static bool decoupler_pays(const struct analysis *a)
{
    const struct analysis_figures *with = &a->figures[0], *without = &a->figures[1];
    return with->setpoints * with->loads < PAYS * without->setpoints * without->loads;
}

/* Predicts the step of the next loop with its gain raised, or ends the analysis. */
static enum err begin_probe(struct analysis *a)
{
    if (a->turn >= a->pairs.n) {
        a->stage = ANALYSIS_DONE;
        return ERR_OK;
    }
    struct trial_config c = {.loop = a->turn,
                             .size = a->config.step,
                             .duration_s = a->horizon_s,
                             .mark_s = a->horizon_s,
                             .setpoint_weight = REAL_C(1.0),
                             .raise = a->config.probe};
    enum err err = trial_begin(&a->work.trial, &a->plant, &a->loops, &c);
    if (!err)
        return ERR_BUSY;
    a->stage = ANALYSIS_DONE; /* the loops are not probed then */
    return ERR_OK;
}

static enum err end_probe(struct analysis *a)
{
    REFLUX_ASSERT(a->turn < a->pairs.n);
    const struct trial *t = &a->work.trial;
    const struct trial_mark *before = &a->tried[a->turn];
    struct trial_probe *p = &a->probe[a->turn];
    for (uint8_t l = 0; l < a->pairs.n && t->bounded; l++) {
        real_t ratio =
            before->moved[l] > REAL_C(0.0) ? t->mark.moved[l] / before->moved[l] : REAL_C(1.0);
        p->moved = ratio > p->moved ? ratio : p->moved;
    }
    p->others = t->mark.others;
    p->left = t->mark.left / a->config.step;
    a->turn++;
    return begin_probe(a);
}

/* The settings are chosen. */
static enum err begin_probes(struct analysis *a)
{
    bool wanted = a->designed && a->config.probe > REAL_C(0.0);
    a->stage = wanted ? ANALYSIS_PROBES : ANALYSIS_DONE;
    a->turn = 0;
    return wanted ? begin_probe(a) : ERR_OK;
}

/* Chooses between two designs: the one with decoupler is made first, then the one without. */
static enum err choose(struct analysis *a)
{
    if (a->decoupler == DECOUPLER_USED) {
        a->has_decoupled = a->designed;
        if (a->designed)
            keep_decoupled(a);
        without_decoupler(a, a->designed ? DECOUPLER_NO_BETTER : DECOUPLER_ILL);
        a->compares = a->designed;
        a->designed = false;
        a->design_error = ERR_OK;
        return begin_settings(a);
    }
    if (a->has_decoupled && (!a->designed || decoupler_pays(a)))
        take_decoupled(a);
    a->turn = 0;
    a->stage = a->designed ? ANALYSIS_CROSSOVER : ANALYSIS_DONE;
    if (a->designed)
        analysis_crossover_begin(a, 0);
    return ERR_OK;
}

static enum err next_crossover(struct analysis *a)
{
    enum err err = analysis_crossover_step(a, a->turn);
    if (err)
        return err;
    if (++a->turn >= a->pairs.n)
        return begin_probes(a);
    analysis_crossover_begin(a, a->turn);
    return ERR_BUSY;
}

/* Result of a stage that may have begun another one: ERR_BUSY while there is more to do. */
static enum err more(const struct analysis *a, enum err err)
{
    return err || a->stage == ANALYSIS_DONE ? err : ERR_BUSY;
}

enum err analysis_step(struct analysis *a)
{
    enum err err;
    switch (a->stage) {
    case ANALYSIS_GAINS:
        err = gains_step(&a->work.gains);
        return err ? err : more(a, end_gains(a));
    case ANALYSIS_CASCADES:
        analysis_find_cascades(a);
        return more(a, begin_pairing(a));
    case ANALYSIS_PAIRING:
        err = pairing_step(&a->work.pairing);
        return err ? err : more(a, end_pairing(a));
    case ANALYSIS_CANDIDATES:
        err = choice_find(a);
        if (err)
            return err;
        a->stage = ANALYSIS_CHOICE;
        return ERR_BUSY;
    case ANALYSIS_CHOICE:
        err = choice_step(a);
        return err ? err : end_choice(a);
    case ANALYSIS_SECOND:
        return end_second(a);
    case ANALYSIS_STRUCTURE:
        return do_structure(a);
    case ANALYSIS_DECOUPLER:
        return more(a, do_decoupler(a));
    case ANALYSIS_SETTINGS:
        err = settings_by_rule(a);
        return err == ERR_BUSY ? err : more(a, end_rule(a, err));
    case ANALYSIS_ROBUST:
        err = settings_by_search(a);
        return err == ERR_BUSY ? err : more(a, end_settings_search(a, err));
    case ANALYSIS_PREDICTION:
        err = trial_step(&a->work.trial);
        if (err)
            return err;
        return more(a, a->load ? end_load(a) : end_prediction(a));
    case ANALYSIS_ALTERNATIVE:
        return more(a, choose(a));
    case ANALYSIS_CROSSOVER:
        return next_crossover(a);
    case ANALYSIS_PROBES:
        err = trial_step(&a->work.trial);
        if (!err)
            err = end_probe(a);
        return err;
    default:
        return ERR_OK;
    }
}
