#include "kinds/state_law/state_law_job.h"

#include <string.h>

#include "base/text.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

unsigned state_law_loops(const struct block_signal *input, unsigned inputs)
{
    unsigned loops = 0;
    for (unsigned k = 0; k < inputs; k++)
        loops += input[k].is_mv ? 1u : 0u;
    return loops;
}

static void begin_job(struct state_law_job *job, const struct state_law_settings *s, unsigned loops)
{
    memset(job, 0, sizeof *job);
    state_decoupler_config_default(&job->config);
    job->left = s->left;
    job->goal.feedforward = STATE_FEEDFORWARD_OUTPUTS;
    job->linear.loops = (uint8_t)loops;
    job->sampled.period_s = s->period_s;
    job->found.field = job->found.wanted = "";
    for (unsigned i = 0; i < loops; i++) {
        for (unsigned p = 0; p < STATE_POLES; p++)
            job->goal.pole[i][p].re = real_exp(-(real_t)s->period_s / s->tau_s[i]);
        job->goal.integral_s[i] = s->ti_s[i];
        job->goal.derivative_s[i] = s->td_s[i];
    }
    state_decoupler_begin(&job->work);
}

void state_law_job_of_column(struct state_law_job *job, const struct state_law_settings *s,
                             const struct block_signal *input, unsigned inputs,
                             const struct column_record *record)
{
    struct state_law_linear *l = &job->linear;
    begin_job(job, s, state_law_loops(input, inputs));
    job->record = record;
    l->inputs = (uint8_t)inputs;
    l->basis = s->basis;
    for (unsigned k = 0; k < inputs; k++) {
        const uint16_t *place = s->place[k];
        real_t si = s->si[k] < 0 || s->si[k] > 0 ? s->si[k] : ONE;
        l->place[k] = (struct state_law_place){
            .span = si * (input[k].hi - input[k].lo),
            .is = s->is[k],
            .stage = (uint8_t)(place[STATE_LAW_STAGE] ? place[STATE_LAW_STAGE] - 1u : 0),
            .component =
                (uint8_t)(place[STATE_LAW_COMPONENT] ? place[STATE_LAW_COMPONENT] - 1u : 0),
            .is_mv = input[k].is_mv};
    }
}

void state_law_job_of_model(struct state_law_job *job, const struct state_law_settings *s,
                            unsigned loops)
{
    struct state_law_linear *l = &job->linear;
    begin_job(job, s, loops);
    job->phase = STATE_LAW_PHASE_DESIGN;
    l->inputs = (uint8_t)(2u * loops);
    l->seen.rows = l->seen.cols = (uint8_t)loops;
    for (unsigned k = 0; k < loops; k++) {
        l->seen.at[k][k] = ONE;
        l->place[loops + k].is_mv = true;
    }
}

void state_law_words(const struct state_law_found *found, char *text, size_t size)
{
    struct text t = text_on(text, size);
    text_str(&t, "no law: ");
    text_str(&t, found->field);
    text_str(&t, " must be ");
    text_str(&t, found->wanted);
    text_str(&t, "; loop");
}

/* ---- phases ---- */

static void refuse_law(struct state_law_job *job, const char *field, const char *wanted,
                       unsigned loop)
{
    job->found.field = field;
    job->found.wanted = wanted;
    job->found.loop = (uint8_t)loop;
    job->phase = STATE_LAW_PHASE_OVER;
}

static void read_table(struct state_law_job *job)
{
    enum err err = state_law_linear_begin(&job->linear, job->record);
    if (err == ERR_FULL)
        refuse_law(job, "column", "of 16 mole fractions at most, and holdups that do not move", 0);
    else if (err)
        refuse_law(job, "column", "a table that is in order", 0);
    else
        job->phase = STATE_LAW_PHASE_LINEAR;
}

static void linearise_column(struct state_law_job *job)
{
    enum err err = state_law_linear_piece(&job->linear);
    if (err == ERR_OK)
        job->phase = STATE_LAW_PHASE_SAMPLE;
    else if (err != ERR_BUSY)
        refuse_law(job, "column",
                   "a column with a solution around its profile, and flows that are not 0", 0);
}

static void sample(struct state_law_job *job)
{
    real_t period = job->sampled.period_s;
    if (state_model_sample(&job->linear.plant, period, &job->work.at.sampling, &job->sampled))
        refuse_law(job, "period", "shorter", 0);
    else
        job->phase = STATE_LAW_PHASE_DESIGN;
}

static void take_design(struct state_law_job *job)
{
    const struct state_decoupler *d = &job->law;
    struct state_law_found *f = &job->found;
    f->condition = (float)d->condition;
    f->zeros = d->zeros.n;
    f->zero = (float)d->zeros.outermost;
    f->radius = (float)d->radius;
    for (unsigned i = 0; i < d->loops; i++) {
        f->index[i] = d->index[i];
        f->k_star[i] = (float)d->k_star[i];
    }
}

/* As the parameters of the kind are called. */
static const char *called(const char *field)
{
    return strcmp(field, "pole") == 0           ? "tau"
           : strcmp(field, "integral_s") == 0   ? "ti"
           : strcmp(field, "derivative_s") == 0 ? "td"
                                                : field;
}

static void design(struct state_law_job *job)
{
    struct state_decoupler_refusal reason;
    enum err err = state_decoupler_part(&job->sampled, &job->config, &job->goal, &job->work,
                                        &job->law, &reason);
    if (err == ERR_BUSY)
        return;
    take_design(job);
    if (err)
        refuse_law(job, called(reason.field), reason.wanted,
                   reason.loop == STATE_LOOP_NONE ? 0 : reason.loop + 1u);
    else
        job->phase = STATE_LAW_PHASE_INPUTS;
}

/* told <- weights seen, weights such that it is as near to F as the inputs let it: F pinv(seen), rows of one size. */
static enum err weigh(struct state_law_job *job)
{
    const struct matrix *seen = &job->linear.seen;
    struct matrix *rows = &job->linear.plant.a, *inverse = &job->linear.plant.e;
    real_t size[MATRIX_MAX] = {ZERO};
    *rows = *seen; /* plant has been sampled: there is room in it */
    for (size_t k = 0; k < rows->rows; k++) {
        size[k] = ZERO;
        for (size_t j = 0; j < rows->cols; j++)
            if (real_abs(rows->at[k][j]) > size[k])
                size[k] = real_abs(rows->at[k][j]);
        if (!(size[k] > ZERO))
            return ERR_SINGULAR;
        for (size_t j = 0; j < rows->cols; j++)
            rows->at[k][j] /= size[k];
    }
    enum err err = matrix_pseudo_inverse(rows, &job->work.at.pseudo_inverse, inverse);
    if (!err)
        err = matrix_multiply(&job->law.f, inverse, &job->weights);
    for (size_t i = 0; !err && i < job->weights.rows; i++)
        for (size_t k = 0; k < job->weights.cols; k++)
            job->weights.at[i][k] /= size[k];
    return err ? err : matrix_multiply(&job->weights, seen, &job->told);
}

/* Of the largest element, what is left of F. */
static real_t left_of_f(const struct matrix *f, const struct matrix *told)
{
    real_t most = ZERO, left = ZERO;
    for (size_t i = 0; i < f->rows; i++)
        for (size_t k = 0; k < f->cols; k++) {
            real_t off = real_abs(f->at[i][k] - told->at[i][k]), size = real_abs(f->at[i][k]);
            left = off > left ? off : left;
            most = size > most ? size : most;
        }
    return most > ZERO ? left / most : ZERO;
}

static void put_law(struct state_law_job *job)
{
    struct state_law_found *to = &job->found;
    size_t state = 0, known = 0;
    for (unsigned k = 0; k < job->linear.inputs; k++) {
        const struct state_law_place *place = &job->linear.place[k];
        bool of_stage = state_law_is_of_stage(place->is);
        if (place->is_mv)
            continue;
        for (unsigned i = 0; i < job->linear.loops; i++)
            to->f[i][k] = (float)(of_stage ? job->weights.at[i][state] : job->law.tf.at[i][known]);
        if (of_stage)
            state++;
        else
            known++;
    }
    for (unsigned i = 0; i < job->linear.loops; i++)
        for (unsigned j = 0; j < job->linear.loops; j++)
            to->g[i][j] = (float)job->law.g.at[i][j];
}

static void go_to_inputs(struct state_law_job *job)
{
    if (weigh(job)) {
        refuse_law(job, "inputs", "of stages of their own: two tell of the same mole fraction", 0);
        return;
    }
    job->found.left = 100 * (float)left_of_f(&job->law.f, &job->told);
    if (!(job->found.left <= job->left)) {
        refuse_law(job, "inputs", "those that F needs: they leave out more of it than left allows",
                   0);
        return;
    }
    put_law(job);
    job->phase = STATE_LAW_PHASE_LOOP;
}

static void judge_inputs(struct state_law_job *job)
{
    const struct state_law law = {&job->told, &job->law.g, job->law.integral_s,
                                  job->law.derivative_s};
    real_t radius = ZERO;
    enum err err = state_loop_radius(&job->sampled, &law, &job->work.at.zeros, &radius);
    job->found.inputs_radius = (float)radius;
    if (err || !(radius < ONE))
        refuse_law(job, "inputs",
                   "those that F needs: with what they tell alone the loop is not stable", 0);
    job->phase = STATE_LAW_PHASE_OVER;
}

bool state_law_job_piece(struct state_law_job *job)
{
    switch (job->phase) {
    case STATE_LAW_PHASE_TABLE:
        read_table(job);
        break;
    case STATE_LAW_PHASE_LINEAR:
        linearise_column(job);
        break;
    case STATE_LAW_PHASE_SAMPLE:
        sample(job);
        break;
    case STATE_LAW_PHASE_DESIGN:
        design(job);
        break;
    case STATE_LAW_PHASE_INPUTS:
        go_to_inputs(job);
        break;
    case STATE_LAW_PHASE_LOOP:
        judge_inputs(job);
        break;
    default:
        break;
    }
    return job->phase != STATE_LAW_PHASE_OVER;
}
