#include "kinds/experiment/experiment_values.h"

#include "kinds/experiment/experiment_finding.h"
#include "kinds/experiment/experiment_job.h"
#include "kinds/experiment/experiment_law.h"
#include "kinds/experiment/experiment_lease.h"
#include "kinds/experiment/experiment_model.h"
#include "kinds/experiment/experiment_record.h"

static float part_done(const struct experiment_parts *p)
{
    const struct experiment_context *c = p->context;
    enum experiment_stage stage = experiment_stages_stage(p->stages);
    struct experiment_job *job = experiment_leased(p->lease);
    if (stage == EXPERIMENT_COMPUTES && job) {
        const struct experiment_finding *f = experiment_job_finding(job);
        return (float)plant_finding_done(experiment_finding_result(f)) / (float)c->n;
    }
    float all = stage == EXPERIMENT_SETTLES ? (float)c->s.settle : (float)c->wanted;
    return (float)experiment_record_samples(p->record) / all;
}

static const char *describe_run(const struct experiment_parts *p, size_t i, float *value)
{
    const struct experiment_context *c = p->context;
    const struct {
        const char *name;
        float value;
    } inner[] = {
        {"stage", (float)experiment_stages_stage(p->stages)},
        {"reason", (float)experiment_stages_reason(p->stages)},
        {"verdict", (float)experiment_stages_verdict(p->stages)},
        {"at_fault", (float)experiment_stages_at_fault(p->stages)},
        {"percent", experiment_runs(p->stages) ? 100 * part_done(p) : 0},
        {"samples", (float)experiment_record_samples(p->record)},
        {"wanted", (float)c->wanted},
        {"bytes", (float)experiment_job_bytes(c->n, c->wanted)},
    };
    *value = inner[i].value;
    return inner[i].name;
}
#define OF_RUN 8u

#define OF_OUTPUT 5u
static const char output_names[EXPERIMENT_MOST][OF_OUTPUT][12] = {
    {"verdict_1", "one_step_1", "fit_1", "apart_1", "live_1"},
    {"verdict_2", "one_step_2", "fit_2", "apart_2", "live_2"},
    {"verdict_3", "one_step_3", "fit_3", "apart_3", "live_3"},
    {"verdict_4", "one_step_4", "fit_4", "apart_4", "live_4"},
};

static const char *describe_output(const struct experiment_parts *p, unsigned k, size_t i,
                                   float *value)
{
    const struct experiment_found *f = experiment_model_found(p->model, k);
    const float values[OF_OUTPUT] = {f->verdict, f->one_step, f->fit, f->apart,
                                     experiment_live_error(p->record, k)};
    *value = values[i];
    return output_names[k][i];
}

static const char others_names[EXPERIMENT_MOST][9] = {"others_1", "others_2", "others_3",
                                                      "others_4"};

#define GAINS(i)                                                                                   \
    {                                                                                              \
        "gain" #i "1", "gain" #i "2", "gain" #i "3", "gain" #i "4"                                 \
    }
static const char gain_names[EXPERIMENT_MOST][EXPERIMENT_MOST][7] = {GAINS(1), GAINS(2), GAINS(3),
                                                                     GAINS(4)};

/* Gain at rest, EU per EU: of the model, or while it moves the plant of the recursive estimate. */
static float gain_shown(const struct experiment_parts *p, unsigned i, unsigned j)
{
    struct experiment_job *job = experiment_leased(p->lease);
    if (experiment_stages_stage(p->stages) == EXPERIMENT_EXCITES && job)
        return experiment_live_gain(experiment_job_rows(job), p->context, i, j);
    return experiment_model_gain(p->coefficients, p->context->n, i, j);
}

#define NAMES_A(i)                                                                                 \
    {                                                                                              \
        "a" #i "_1", "a" #i "_2", "a" #i "_3", "a" #i "_4"                                         \
    }
static const char a_names[EXPERIMENT_MOST][DIFFERENCE_A_MOST][5] = {NAMES_A(1), NAMES_A(2),
                                                                    NAMES_A(3), NAMES_A(4)};
#define NAMES_B(i, j)                                                                              \
    {                                                                                              \
        "b" #i #j "_1", "b" #i #j "_2", "b" #i #j "_3", "b" #i #j "_4", "b" #i #j "_5",            \
            "b" #i #j "_6", "b" #i #j "_7", "b" #i #j "_8"                                         \
    }
#define NAMES_ROW(i)                                                                               \
    {                                                                                              \
        NAMES_B(i, 1), NAMES_B(i, 2), NAMES_B(i, 3), NAMES_B(i, 4)                                 \
    }
static const char b_names[EXPERIMENT_MOST][EXPERIMENT_MOST][DIFFERENCE_B_MOST][6] = {
    NAMES_ROW(1), NAMES_ROW(2), NAMES_ROW(3), NAMES_ROW(4)};

/* The coefficients that the orders of the model have. */
static const char *describe_coefficient(const struct experiment_parts *p, size_t i, float *value)
{
    const float *at = p->coefficients;
    unsigned n = p->context->n;
    for (unsigned k = 0; k < n; k++, at += DIFFERENCE_A_MOST) {
        unsigned na = experiment_model_found(p->model, k)->na;
        if (i < na) {
            *value = at[i];
            return a_names[k][i];
        }
        i -= na;
    }
    for (unsigned k = 0; k < n; k++)
        for (unsigned j = 0; j < n; j++, at += DIFFERENCE_B_MOST) {
            unsigned nb = experiment_model_found(p->model, k)->nb;
            if (i < nb) {
                *value = at[i];
                return b_names[k][j][i];
            }
            i -= nb;
        }
    return NULL;
}

const char *experiment_value(const struct experiment_parts *p, size_t i, float *value)
{
    const char *refused = experiment_law_words(p->law);
    size_t n = p->context->n;
    if (refused && i-- == 0) {
        *value = experiment_law_loop(p->law);
        return refused;
    }
    if (i < OF_RUN)
        return describe_run(p, i, value);
    i -= OF_RUN;
    if (i < n * OF_OUTPUT)
        return describe_output(p, (unsigned)(i / OF_OUTPUT), i % OF_OUTPUT, value);
    i -= n * OF_OUTPUT;
    if (i < n) {
        *value = (float)experiment_others(p->record, (unsigned)i);
        return others_names[i];
    }
    i -= n;
    if (i < n * n) {
        *value = gain_shown(p, (unsigned)(i / n), (unsigned)(i % n));
        return gain_names[i / n][i % n];
    }
    return describe_coefficient(p, i - n * n, value);
}
