/* Kind `ff_tune`: gives the parts of a block their places, and hands settings, steps and verbs to its stages. */
#include <string.h>

#include "kinds/ff_tune/feedforward_tune.h"
#include "kinds/ff_tune/tune_disturbance.h"
#include "kinds/ff_tune/tune_events.h"
#include "kinds/ff_tune/tune_proposals.h"
#include "kinds/ff_tune/tune_responses.h"
#include "kinds/ff_tune/tune_samples.h"
#include "kinds/ff_tune/tune_search.h"
#include "kinds/ff_tune/tune_state.h"
#include "kinds/ff_tune/tune_test.h"
#include "kinds/ff_tune/tune_values.h"

struct tune_parts tune_parts_of(struct tune *t)
{
    return (struct tune_parts){.context = &t->context,
                               .stages = &t->stages,
                               .samples = &t->samples,
                               .disturbance = &t->disturbance,
                               .learner = &t->learner,
                               .estimator = (struct high_order *)(void *)t->estimator,
                               .responses = &t->responses,
                               .paths = &t->paths,
                               .search = &t->search,
                               .shadows = &t->shadows,
                               .test = &t->test,
                               .watch = &t->watch,
                               .signals = &t->signals,
                               .proposals = &t->proposals,
                               .events = &t->events};
}

/* ---- settings ---- */

static uint32_t tune_bytes(const struct block_setup *setup)
{
    return (uint32_t)((sizeof(struct tune) + 7u) & ~(size_t)7u) + tune_model_bytes(setup->settings);
}

static uint16_t tune_history(const struct block_setup *setup)
{
    (void)setup;
    return 1;
}

/* The settings that the block proposes itself are no difference. */
static bool tune_differs(const struct tune_settings *before, const struct tune_settings *after)
{
    return memcmp(before, after, offsetof(struct tune_settings, k)) != 0;
}

static bool is_candidate(const struct tune *t, const struct tune_settings *s)
{
    const struct feedforward_shape *c = tune_candidate(&t->search);
    return tune_stages_stage(&t->stages) == TUNE_PROPOSES && s->k == (float)c->k &&
           s->lead_s == (float)c->lead && s->lag_s == (float)c->lag && s->dead_s == (float)c->dead;
}

static bool element_differs(const struct tune_settings *a, const struct tune_settings *b)
{
    return a->k != b->k || a->lead_s != b->lead_s || a->lag_s != b->lag_s || a->dead_s != b->dead_s;
}

static enum err tune_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct tune *t = state;
    const struct tune_parts parts = tune_parts_of(t);
    const struct tune_settings *s = setup->settings;
    if (!retune)
        memset(t, 0, tune_bytes(setup));
    bool whole = !retune || tune_differs(&t->context.s, s);
    bool proposed = retune && !whole && is_candidate(t, s);
    bool other = retune && element_differs(&t->context.s, s);
    tune_context_take(&t->context, setup);
    if (whole) {
        tune_samples_configure(&t->samples, &t->context);
        tune_responses_grid(&t->responses, &t->context);
        tune_stages_reset(&parts);
    }
    if (whole || other)
        tune_stages_element(&parts, proposed);
    return ERR_OK;
}

/* ---- what the tick and the main loop call ---- */

static void raise_tune_events(const struct tune_parts *p, struct block_io *io)
{
    enum tune_stage stage = tune_stages_stage(p->stages);
    bool still = (stage == TUNE_LOOP || stage == TUNE_DISTURBANCE) &&
                 tune_waits_for_disturbance(p) &&
                 2u * tune_disturbance_still(p->disturbance) >
                     tune_samples_in(p->context, p->context->s.learn_s);
    const struct tune_event_values values = {
        .still = still,
        .d = (float)real_sqrt(tune_disturbance_square(p->disturbance)),
        .promised = (float)tune_test_promised(p->test),
        .step_wanted = tune_step_wanted(p)};
    tune_events_raise(p->events, p->context, io, &values);
}

static void tune_step(void *state, struct block_io *io)
{
    const struct tune_parts parts = tune_parts_of(state);
    io->members.out[0] = io->members.in[0];
    tune_stages_step(&parts, io);
    raise_tune_events(&parts, io);
}

/* The controller has to give what the MV is to be: nothing is in between. */
static void tune_pass(void *state, struct block_io *io)
{
    (void)state;
    io->members.out[0] = io->members.in[0];
}

static void tune_follow(void *state, struct block_io *io)
{
    const struct tune_parts parts = tune_parts_of(state);
    io->members.out[0] = io->members.in[0];
    if (!(io->members.going_on & 1u))
        tune_stages_gap(&parts);
}

static bool tune_work(void *state)
{
    const struct tune_parts p = tune_parts_of(state);
    return tune_search_piece(p.search, p.context, p.responses, p.paths, p.estimator,
                             tune_stages_stage(p.stages) == TUNE_LOOP);
}

static const char *tune_describe(const void *state, size_t i, float *value)
{
    /* Nothing behind it writes. */
    const struct tune_parts parts = tune_parts_of((struct tune *)(uintptr_t)state);
    return tune_value(&parts, i, value);
}

/* ---- verbs ---- */

static const char *run_tune_element(void *state, const float *number)
{
    const struct tune_parts parts = tune_parts_of(state);
    (void)number;
    return tune_stages_tune(&parts);
}

static const char *run_stop_tuning(void *state, const float *number)
{
    const struct tune_parts parts = tune_parts_of(state);
    (void)number;
    return tune_stages_stop(&parts);
}

static const char *run_silence(void *state, const float *number)
{
    struct tune *t = state;
    (void)number;
    if (!tune_stages_element_acts(&t->stages))
        return "is_off";
    tune_silence(&t->proposals);
    return NULL;
}

static const char *run_reset_model(void *state, const float *number)
{
    const struct tune_parts parts = tune_parts_of(state);
    (void)number;
    if (tune_search_computes(parts.search) || !tune_search_is_idle(parts.search))
        return "computes";
    high_order_reset(parts.estimator);
    tune_responses_unsettle(parts.responses);
    return NULL;
}

static const struct block_verb tune_verbs[] = {
    {"tune", NULL, "identify, tune, test, propose", 0, 0, false, ACCESS_ENGINEER, run_tune_element},
    {"stop", NULL, "give that up", 0, 0, false, ACCESS_OPERATOR, run_stop_tuning},
    {"silence", NULL, "switch the feedforward off", 0, 0, false, ACCESS_OPERATOR, run_silence},
    {"reset", NULL, "P = P(0); what is estimated stays", 0, 0, false, ACCESS_ENGINEER,
     run_reset_model},
};

const struct block_kind feedforward_tune_kind = {
    .name = "ff_tune",
    .stage = STAGE_COMPENSATE,
    .parameter = tune_parameter_rows,
    .parameters = TUNE_PARAMETERS,
    .settings_bytes = sizeof(struct tune_settings),
    .names = TUNE_ID_BLOCK,
    .named_kind = "leadlag",
    .members_most = 1,
    .inputs_most = 2,
    .bad_input = BAD_INPUT_IS_TOLD,
    .history = tune_history,
    .work = tune_work,
    .verb = tune_verbs,
    .verbs = sizeof tune_verbs / sizeof tune_verbs[0],
    .event = tune_event_rows,
    .events = TUNE_EVENTS,
    .bytes = tune_bytes,
    .check = tune_check,
    .configure = tune_configure,
    .step = tune_step,
    .back_calculate = tune_pass,
    .follow = tune_follow,
    .describe = tune_describe,
};
