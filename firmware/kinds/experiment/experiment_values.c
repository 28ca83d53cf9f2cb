/* The inner values of a block of the kind `experiment`. */
#include "kinds/experiment/plant_experiment_block.h"

static const char *describe_run(const struct experiment *e, size_t i, float *value)
{
    float of = e->stage == EXPERIMENT_SETTLES ? (float)e->s.settle : (float)e->wanted;
    float done = e->stage == EXPERIMENT_COMPUTES && e->job
                     ? (float)e->job->finding.output / (float)e->n
                     : (float)e->samples / of;
    const struct {
        const char *name;
        float value;
    } inner[] = {
        {"stage", e->stage},
        {"reason", e->reason},
        {"verdict", e->verdict},
        {"at_fault", e->at_fault},
        {"percent", experiment_runs(e) ? 100 * done : 0},
        {"samples", (float)e->samples},
        {"wanted", (float)e->wanted},
        {"bytes", (float)experiment_job_bytes(e->n, e->wanted)},
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

static const char *describe_output(const struct experiment *e, unsigned k, size_t i, float *value)
{
    const struct experiment_found *f = &e->found[k];
    const float values[OF_OUTPUT] = {f->verdict, f->one_step, f->fit, f->apart, e->live_error[k]};
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

/* At rest, EU per EU: of the model, or while it moves the plant of the recursive estimate. */
static float gain_shown(const struct experiment *e, unsigned i, unsigned j)
{
    const float *a = &e->model[(size_t)i * DIFFERENCE_A_MOST];
    const float *b =
        &e->model[(size_t)e->n * DIFFERENCE_A_MOST + ((size_t)i * e->n + j) * DIFFERENCE_B_MOST];
    float at_rest = 1, sum = 0;
    if (e->stage == EXPERIMENT_EXCITES && e->job)
        return experiment_live_gain(e, i, j);
    for (unsigned k = 0; k < DIFFERENCE_A_MOST; k++)
        at_rest += a[k];
    for (unsigned k = 0; k < DIFFERENCE_B_MOST; k++)
        sum += b[k];
    return at_rest > 1e-6f ? sum / at_rest : 0;
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

/* Coefficients of the model that are there. */
static const char *describe_coefficient(const struct experiment *e, size_t i, float *value)
{
    const float *at = e->model;
    for (unsigned k = 0; k < e->n; k++, at += DIFFERENCE_A_MOST) {
        if (i < e->found[k].na) {
            *value = at[i];
            return a_names[k][i];
        }
        i -= e->found[k].na;
    }
    for (unsigned k = 0; k < e->n; k++)
        for (unsigned j = 0; j < e->n; j++, at += DIFFERENCE_B_MOST) {
            if (i < e->found[k].nb) {
                *value = at[i];
                return b_names[k][j][i];
            }
            i -= e->found[k].nb;
        }
    return NULL;
}

const char *experiment_describe(const void *state, size_t i, float *value)
{
    const struct experiment *e = state;
    size_t n = e->n;
    if (e->law.stage == EXPERIMENT_LAW_REFUSED && i-- == 0) {
        *value = e->law.found.loop;
        return e->law.words;
    }
    if (i < OF_RUN)
        return describe_run(e, i, value);
    i -= OF_RUN;
    if (i < n * OF_OUTPUT)
        return describe_output(e, (unsigned)(i / OF_OUTPUT), i % OF_OUTPUT, value);
    i -= n * OF_OUTPUT;
    if (i < n) {
        *value = (float)experiment_others(e, (unsigned)i);
        return others_names[i];
    }
    i -= n;
    if (i < n * n) {
        *value = gain_shown(e, (unsigned)(i / n), (unsigned)(i % n));
        return gain_names[i / n][i % n];
    }
    return describe_coefficient(e, i - n * n, value);
}
