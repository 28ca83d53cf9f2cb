#include "law/state_law_job.h"

#include <string.h>

#include "base/assertion.h"
#include "base/text.h"
#include "law/state_law_job_state.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

void state_law_job_begin(struct state_law_job *job, const struct state_law_settings *s,
                         unsigned loops)
{
    REFLUX_ASSERT(loops <= STATE_LAW_LOOPS);
    memset(job, 0, sizeof *job);
    state_decoupler_config_default(&job->config);
    job->left = s->left;
    job->goal.feedforward = STATE_FEEDFORWARD_OUTPUTS;
    job->loops = (uint8_t)loops;
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

void state_law_job_add_input(struct state_law_job *job, bool is_mv, bool of_stage)
{
    REFLUX_ASSERT(job->inputs < BLOCK_INPUTS_MAX);
    job->is_mv[job->inputs] = is_mv;
    job->of_stage[job->inputs++] = of_stage;
}

struct state_model *state_law_job_plant(struct state_law_job *job)
{
    return &job->plant;
}

struct matrix *state_law_job_seen(struct state_law_job *job)
{
    return &job->seen;
}

struct state_model *state_law_job_sampled(struct state_law_job *job)
{
    return &job->sampled;
}

void state_law_job_of_model(struct state_law_job *job, const struct state_law_settings *s,
                            unsigned loops)
{
    state_law_job_begin(job, s, loops);
    job->phase = STATE_LAW_PHASE_DESIGN;
    job->seen.rows = job->seen.cols = (uint8_t)loops;
    for (unsigned k = 0; k < loops; k++) {
        job->seen.value[k][k] = ONE;
        state_law_job_add_input(job, false, true);
    }
    for (unsigned k = 0; k < loops; k++)
        state_law_job_add_input(job, true, false);
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

void state_law_job_refuse(struct state_law_job *job, const char *field, const char *wanted,
                          unsigned loop)
{
    job->found.field = field;
    job->found.wanted = wanted;
    job->found.loop = (uint8_t)loop;
    job->phase = STATE_LAW_PHASE_OVER;
}

static void sample(struct state_law_job *job)
{
    real_t period = job->sampled.period_s;
    if (state_model_sample(&job->plant, period, &job->work.at.sampling, &job->sampled))
        state_law_job_refuse(job, "period", "shorter", 0);
    else
        job->phase = STATE_LAW_PHASE_DESIGN;
}

static void take_design(struct state_law_job *job)
{
    const struct state_decoupler *d = &job->law;
    struct state_law_found *f = &job->found;
    REFLUX_ASSERT(d->loops <= STATE_LAW_LOOPS);
    f->condition = (float)d->condition;
    f->zeros = d->zeros.n;
    f->zero = (float)d->zeros.outermost;
    f->radius = (float)d->radius;
    for (unsigned i = 0; i < d->loops; i++) {
        f->index[i] = d->index[i];
        f->k_star[i] = (float)d->k_star[i];
    }
}

/* Returns the name of the parameter for a field. */
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
        state_law_job_refuse(job, called(reason.field), reason.wanted,
                             reason.loop == STATE_LOOP_NONE ? 0 : reason.loop + 1u);
    else
        job->phase = STATE_LAW_PHASE_INPUTS;
}

/* from_inputs <- weights seen, weights such that it is as near to F as the inputs let it: F pinv(seen), rows of one size. */
static enum err weigh(struct state_law_job *job)
{
    REFLUX_ASSERT(job->seen.rows <= MATRIX_MAX && job->seen.cols <= MATRIX_MAX);
    const struct matrix *seen = &job->seen;
    struct matrix *rows = &job->plant.a, *inverse = &job->plant.e;
    real_t size[MATRIX_MAX] = {ZERO};
    *rows = *seen; /* plant has been sampled: there is room in it */
    for (size_t k = 0; k < rows->rows; k++) {
        size[k] = ZERO;
        for (size_t j = 0; j < rows->cols; j++)
            if (real_abs(rows->value[k][j]) > size[k])
                size[k] = real_abs(rows->value[k][j]);
        if (!(size[k] > ZERO))
            return ERR_SINGULAR;
        for (size_t j = 0; j < rows->cols; j++)
            rows->value[k][j] /= size[k];
    }
    enum err err = matrix_pseudo_inverse(rows, &job->work.at.pseudo_inverse, inverse);
    if (!err)
        err = matrix_multiply(&job->law.f, inverse, &job->weights);
    for (size_t i = 0; !err && i < job->weights.rows; i++)
        for (size_t k = 0; k < job->weights.cols; k++)
            job->weights.value[i][k] /= size[k];
    return err ? err : matrix_multiply(&job->weights, seen, &job->from_inputs);
}

/* Returns the largest error of an element of F, part of the largest element. */
static real_t left_of_f(const struct matrix *f, const struct matrix *from_inputs)
{
    real_t most = ZERO, left = ZERO;
    for (size_t i = 0; i < f->rows; i++)
        for (size_t k = 0; k < f->cols; k++) {
            real_t off = real_abs(f->value[i][k] - from_inputs->value[i][k]),
                   size = real_abs(f->value[i][k]);
            left = off > left ? off : left;
            most = size > most ? size : most;
        }
    return most > ZERO ? left / most : ZERO;
}

static void put_law(struct state_law_job *job)
{
    struct state_law_found *to = &job->found;
    size_t state = 0, known = 0;
    for (unsigned k = 0; k < job->inputs; k++) {
        bool of_stage = job->of_stage[k];
        if (job->is_mv[k])
            continue;
        REFLUX_ASSERT(k < STATE_FEEDBACK_INPUTS);
        for (unsigned i = 0; i < job->loops; i++)
            to->f[i][k] =
                (float)(of_stage ? job->weights.value[i][state] : job->law.tf.value[i][known]);
        if (of_stage)
            state++;
        else
            known++;
    }
    for (unsigned i = 0; i < job->loops; i++)
        for (unsigned j = 0; j < job->loops; j++)
            to->g[i][j] = (float)job->law.g.value[i][j];
}

static void go_to_inputs(struct state_law_job *job)
{
    if (weigh(job)) {
        state_law_job_refuse(job, "inputs",
                             "of stages of their own: two tell of the same mole fraction", 0);
        return;
    }
    job->found.left = 100 * (float)left_of_f(&job->law.f, &job->from_inputs);
    if (!(job->found.left <= job->left)) {
        state_law_job_refuse(job, "inputs",
                             "those that F needs: they leave out more of it than left allows", 0);
        return;
    }
    put_law(job);
    job->phase = STATE_LAW_PHASE_LOOP;
}

static void judge_inputs(struct state_law_job *job)
{
    const struct state_law law = {&job->from_inputs, &job->law.g, job->law.integral_s,
                                  job->law.derivative_s};
    real_t radius = ZERO;
    enum err err = state_loop_radius(&job->sampled, &law, &job->work.at.zeros, &radius);
    job->found.inputs_radius = (float)radius;
    if (err || !(radius < ONE))
        state_law_job_refuse(job, "inputs",
                             "those that F needs: with what they tell alone the loop is not stable",
                             0);
    job->phase = STATE_LAW_PHASE_OVER;
}

bool state_law_job_piece(struct state_law_job *job)
{
    switch (job->phase) {
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

bool state_law_job_is_over(const struct state_law_job *job)
{
    return job->phase == STATE_LAW_PHASE_OVER;
}

const struct state_law_found *state_law_job_found(const struct state_law_job *job)
{
    return &job->found;
}
