/* Kind `experiment`: gives the parts of a block their places, and hands settings, steps and verbs to its stages. */
#include <string.h>

#include "kinds/experiment/experiment_model.h"
#include "kinds/experiment/experiment_settings.h"
#include "kinds/experiment/experiment_state.h"
#include "kinds/experiment/experiment_values.h"

static const struct block_event experiment_events[EXPERIMENT_EVENTS] = {
    [EVENT_MODEL] = {"model", BLOCK_INFO, "a usable model; the least simulated fit, %"},
    [EVENT_NO_MODEL] = {"no_model", BLOCK_INFO,
                        "none that is usable; 2 unsure, 3 slow, 4 poor, 5 unstable, 6 untold, "
                        "10 loops"},
    [EVENT_ABORTED] = {"aborted", BLOCK_INFO,
                       "1 stop, 2 band, 3 reading, 4 unsteady, 5 workspace, 6 settings, 7 plant, "
                       "11 and more: test signal"},
    [EVENT_LAW] = {"law", BLOCK_INFO, "a law, which is proposed; the loops' largest pole, -"},
    [EVENT_NO_LAW] = {"no_law", BLOCK_INFO, "no law, `block N` says why; of which loop"},
};

struct experiment_parts experiment_parts_of(struct plant_experiment *e)
{
    return (struct experiment_parts){.context = &e->context,
                                     .stages = &e->stages,
                                     .record = &e->record,
                                     .lease = &e->lease,
                                     .model = &e->model,
                                     .coefficients = e->coefficients,
                                     .proposals = &e->proposals,
                                     .law = &e->law,
                                     .loops = &e->loops};
}

/* ---- settings ---- */

static uint32_t experiment_bytes(const struct block_setup *setup)
{
    size_t numbers = experiment_coefficients(setup->inputs / 2u);
    return (uint32_t)((sizeof(struct plant_experiment) + numbers * sizeof(float) + 7u) &
                      ~(size_t)7u);
}

static uint16_t experiment_history(const struct block_setup *setup)
{
    (void)setup;
    return 1;
}

/* The model, which the block proposes itself, is no difference. */
static bool differs(const struct experiment_settings *before,
                    const struct experiment_settings *after)
{
    return memcmp(before, after, offsetof(struct experiment_settings, known)) != 0;
}

static enum err experiment_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct plant_experiment *e = state;
    const struct experiment_parts parts = experiment_parts_of(e);
    bool other = retune && differs(&e->context.s, setup->settings);
    if (!retune)
        memset(e, 0, experiment_bytes(setup));
    else if (other || e->context.ticks != (uint16_t)experiment_ticks(setup))
        experiment_stages_settings(&parts);
    if (other)
        experiment_stages_law_settings(&parts);
    experiment_context_take(&e->context, setup);
    return ERR_OK;
}

/* ---- what the tick and the main loop call ---- */

static void experiment_step(void *state, struct block_io *io)
{
    const struct experiment_parts parts = experiment_parts_of(state);
    experiment_stages_step(&parts, io);
}

static void experiment_follow(void *state, struct block_io *io)
{
    const struct experiment_parts parts = experiment_parts_of(state);
    (void)io;
    experiment_stages_gap(&parts);
}

static bool experiment_work(void *state)
{
    const struct experiment_parts parts = experiment_parts_of(state);
    return experiment_stages_work(&parts);
}

static const char *experiment_describe(const void *state, size_t i, float *value)
{
    /* Nothing behind it writes. */
    const struct experiment_parts parts =
        experiment_parts_of((struct plant_experiment *)(uintptr_t)state);
    return experiment_value(&parts, i, value);
}

/* ---- verbs ---- */

static const char *run_start(void *state, const float *number)
{
    const struct experiment_parts parts = experiment_parts_of(state);
    (void)number;
    return experiment_stages_start(&parts);
}

static const char *run_stop(void *state, const float *number)
{
    const struct experiment_parts parts = experiment_parts_of(state);
    (void)number;
    return experiment_stages_stop(&parts);
}

static const char *run_law(void *state, const float *number)
{
    const struct experiment_parts parts = experiment_parts_of(state);
    (void)number;
    return experiment_stages_design(&parts);
}

static const struct block_verb experiment_verbs[] = {
    {"start", NULL, "rest, move the MVs, find the model", 0, 0, false, ACCESS_ENGINEER, run_start},
    {"stop", NULL, "the MVs return to where they rested", 0, 0, false, ACCESS_OPERATOR, run_stop},
    {"design", NULL, "what the blocks of law and place compute with, from the kept model", 0, 0,
     false, ACCESS_ENGINEER, run_law},
};

const struct block_kind experiment_kind = {
    .name = "experiment",
    .stage = STAGE_ESTIMATE,
    .parameter = experiment_parameter_rows,
    .parameters = EXPERIMENT_PARAMETERS,
    .settings_bytes = sizeof(struct experiment_settings),
    .names = 17,
    .named_kind = "state_law",
    .other_kind = "polynomial",
    .inputs_most = 2 * EXPERIMENT_MOST,
    .bad_input = BAD_INPUT_IS_TOLD,
    .history = experiment_history,
    .work = experiment_work,
    .verb = experiment_verbs,
    .verbs = sizeof experiment_verbs / sizeof experiment_verbs[0],
    .event = experiment_events,
    .events = EXPERIMENT_EVENTS,
    .bytes = experiment_bytes,
    .check = experiment_check,
    .configure = experiment_configure,
    .step = experiment_step,
    .follow = experiment_follow,
    .describe = experiment_describe,
};
