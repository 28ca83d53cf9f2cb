/* What `block N` shows of the kind `experiment`, and its model as settings. */
#include "adapt/prbs_inside.h"

#if CONFIG_BLOCKS

/* ---- the model as settings ---- */

#define OF_OUTPUT (EXPERIMENT_A + EXPERIMENT_PAIRS * EXPERIMENT_B)

bool experiment_is_small(const struct experiment_block *b)
{
    return b->outputs <= EXPERIMENT_PAIRS && b->mvs <= EXPERIMENT_PAIRS &&
           b->model.na <= EXPERIMENT_A && b->model.nb <= EXPERIMENT_B;
}

/* Of those that are settings. */
static float model_number(const struct experiment_block *b, unsigned at)
{
    unsigned i = at / OF_OUTPUT, k = at % OF_OUTPUT;
    if (i >= b->outputs)
        return 0;
    if (k < EXPERIMENT_A)
        return k < b->model.na ? (float)b->model.a[i][k] : 0;
    unsigned j = (k - EXPERIMENT_A) / EXPERIMENT_B;
    k = (k - EXPERIMENT_A) % EXPERIMENT_B;
    return j < b->mvs && k < b->model.nb ? (float)b->model.b[i][j][k] : 0;
}

static bool model_is_in_force(const struct experiment_block *b, unsigned from, unsigned n)
{
    for (unsigned at = from; at < from + n; at++)
        if (b->s.model[at] != model_number(b, at))
            return false;
    return true;
}

bool experiment_propose(struct experiment_block *b, struct block_io *io, bool *refused)
{
    *refused = false;
    if (!io->proposal)
        return true;
    if (b->waits_for) { /* there is room again: it is in force, or refused, or rejected */
        *refused = !model_is_in_force(b, b->proposed, b->waits_for);
        if (*refused)
            return false;
        b->proposed = (uint8_t)(b->proposed + b->waits_for);
        b->waits_for = 0;
    }
    unsigned left = EXPERIMENT_MODEL - b->proposed, n = left < PROPOSAL_MAX ? left : PROPOSAL_MAX;
    if (n == 0)
        return false;
    b->waits_for = (uint8_t)n;
    if (model_is_in_force(b, b->proposed, n)) /* already: the next ones in the next step */
        return true;
    for (unsigned k = 0; k < n; k++)
        io->proposal->value[k] =
            (struct proposed_value){proposed_own((uint8_t)(EXPERIMENT_ID_MODEL + b->proposed + k)),
                                    model_number(b, b->proposed + k)};
    io->proposal->n = (uint8_t)n;
    io->proposal->manner =
        b->s.adopt == EXPERIMENT_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
    return true;
}

/* ---- what it shows ---- */

static float part_done(const struct experiment_block *b)
{
    switch (b->stage) {
    case EXPERIMENT_RESTS:
        return 100.0f * (float)b->at / (float)(b->s.rest + b->samples);
    case EXPERIMENT_MOVES:
        return 100.0f * (float)(b->s.rest + b->at) / (float)(b->s.rest + b->samples);
    case EXPERIMENT_FINDS:
    case EXPERIMENT_PROPOSES:
    case EXPERIMENT_DONE:
        return 100;
    default:
        return 0;
    }
}

enum { SHOW_NOISE, SHOW_ERROR, SHOW_LIVE, SHOW_FIT, SHOW_STEP, SHOW_NA, SHOWN };

static float shown_of(const struct experiment_block *b, unsigned which, unsigned i)
{
    switch (which) {
    case SHOW_NOISE:
        return b->noise[i];
    case SHOW_ERROR:
        return b->live_error[i];
    case SHOW_LIVE:
        return b->live_gain[i];
    case SHOW_FIT:
        return b->found[i].fit;
    case SHOW_STEP:
        return b->found[i].step;
    default:
        return b->found[i].na;
    }
}

/* The gains at rest, row by row. */
static const char *describe_gain(const struct experiment_block *b, size_t k, float *value)
{
    static const char *const names[CHANNELS][CHANNELS] = {
        {"gain_11", "gain_12", "gain_13", "gain_14"},
        {"gain_21", "gain_22", "gain_23", "gain_24"},
        {"gain_31", "gain_32", "gain_33", "gain_34"},
        {"gain_41", "gain_42", "gain_43", "gain_44"}};
    size_t i = k / b->mvs, j = k % b->mvs;
    if (i >= b->outputs)
        return NULL;
    *value = (float)b->gain[i][j];
    return names[i][j];
}

const char *experiment_describe(const void *state, size_t i, float *value)
{
    const struct experiment_block *b = state;
    static const char *const names[] = {"stage", "percent", "sample", "samples",
                                        "lost",  "end",     "detail"};
    const float values[] = {(float)b->stage, part_done(b),  (float)b->at,    (float)b->samples,
                            (float)b->lost,  (float)b->end, (float)b->detail};
    static const char *const of_output[SHOWN][CHANNELS] = {
        {"noise_1", "noise_2", "noise_3", "noise_4"}, {"error_1", "error_2", "error_3", "error_4"},
        {"live_1", "live_2", "live_3", "live_4"},     {"fit_1", "fit_2", "fit_3", "fit_4"},
        {"step_1", "step_2", "step_3", "step_4"},     {"na_1", "na_2", "na_3", "na_4"}};
    size_t fixed = sizeof values / sizeof values[0];
    if (i < fixed) {
        *value = values[i];
        return names[i];
    }
    size_t output = (i - fixed) / SHOWN, which = (i - fixed) % SHOWN;
    if (output >= b->outputs)
        return describe_gain(b, i - fixed - (size_t)b->outputs * SHOWN, value);
    *value = shown_of(b, (unsigned)which, (unsigned)output);
    return of_output[which][output];
}

#endif
