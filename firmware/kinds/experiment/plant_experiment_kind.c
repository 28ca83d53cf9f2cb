/* Kind `experiment`: its stages, and what it may be told. */
#include "kinds/experiment/plant_experiment_block.h"

#include <string.h>

#include "base/channel.h"
#include "base/workspace.h"

/* Pieces of work for each second of a step: about a quarter of the time of a board. */
#define PIECES_A_SECOND 100.0f
#define PIECES_MOST     1000.0f

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

/* ---- settings ---- */

/* Of the model. */
static size_t experiment_numbers(size_t n)
{
    return n * DIFFERENCE_A_MOST + n * n * DIFFERENCE_B_MOST;
}

static uint32_t experiment_bytes(const struct block_setup *setup)
{
    size_t numbers = experiment_numbers(setup->inputs / 2u);
    return (uint32_t)((sizeof(struct experiment) + numbers * sizeof(float) + 7u) & ~(size_t)7u);
}

static uint16_t experiment_history(const struct block_setup *setup)
{
    (void)setup;
    return 1;
}

/* But for the model, which it proposes itself. */
static bool differs(const struct experiment_settings *before, const struct experiment_settings *now)
{
    const char *a = (const char *)before, *b = (const char *)now;
    return memcmp(a, b, offsetof(struct experiment_settings, known)) != 0;
}

static enum err experiment_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct experiment *e = state;
    const struct experiment_settings *s = setup->settings;
    uint16_t ticks = (uint16_t)experiment_ticks(setup);
    if (!retune)
        memset(e, 0, experiment_bytes(setup));
    else if (experiment_runs(e) && (differs(&e->s, s) || e->ticks != ticks))
        experiment_abort(e, REASON_SETTINGS);
    if (retune && differs(&e->s, s)) {
        experiment_law_stop(e, "settings", "left as they are while the law is found");
        e->law.proposes = false;
    }
    e->law.to = s->law && !setup->named_other ? setup->named : NULL;
    e->law.decoupler = s->law && setup->named_other ? setup->named : NULL;
    e->step_s = setup->interval_s;
    e->s = *s;
    e->n = (uint8_t)(setup->inputs / 2u);
    memcpy(e->input, setup->input, (size_t)2 * e->n * sizeof e->input[0]);
    e->ticks = ticks;
    e->wanted = experiment_samples(s);
    float pieces = PIECES_A_SECOND * setup->interval_s;
    e->piece_most = (uint16_t)(pieces < 1 ? 1 : pieces < PIECES_MOST ? pieces : PIECES_MOST);
    return ERR_OK;
}

/* ---- stages ---- */

void experiment_abort(struct experiment *e, enum experiment_reason reason)
{
    experiment_end_lease(e);
    e->stage = EXPERIMENT_ABORTED;
    e->reason = (uint8_t)reason;
    e->asked_signal = false;
    e->tells = EVENT_ABORTED + 1;
}

static void stage_begins(struct experiment *e, enum experiment_stage stage)
{
    e->stage = (uint8_t)stage;
    e->samples = 0;
}

static void begin_settling(struct experiment *e)
{
    for (unsigned i = 0; i < e->n; i++) {
        enum err none = decimator_init(&e->filter[i], e->ticks, e->s.cutoff); /* checked */
        (void)none;
        e->level[i] = e->rest[i] = e->applied[i] = 0;
        e->gaps[i] = 0;
        e->out[i] = 0;
        e->sum[i] = (struct experiment_sum){0};
    }
    e->settled = 0;
    stage_begins(e, EXPERIMENT_SETTLES);
}

static void begin_signal(struct experiment *e)
{
    struct prbs_settings settings = {.inputs = e->n,
                                     .bits = (uint8_t)e->s.bits,
                                     .independence = PRBS_SHIFTS,
                                     .clock = e->s.clock};
    for (unsigned j = 0; j < e->n; j++)
        settings.amplitude[j] = e->s.amplitude[j] / (e->input[e->n + j].hi - e->input[e->n + j].lo);
    prbs_init(&e->prbs, &settings);
    stage_begins(e, EXPERIMENT_EXCITES);
}

/* The workspace, and a reading of everything. */
static void wait_for_workspace(struct experiment *e, struct block_io *io)
{
    bool whole = true;
    for (unsigned i = 0; i < e->n; i++)
        whole = whole && io->quality[i] == QUALITY_GOOD;
    if (e->job && whole)
        begin_settling(e);
    else if (io->work_done && !e->job)
        experiment_abort(e, REASON_WORKSPACE);
    else if (!e->job && !io->work_wanted)
        io->ask_work = 1;
}

static void settle_on(struct experiment *e, const struct block_io *io)
{
    if (!experiment_settle(e, io))
        return;
    if (e->at_fault)
        experiment_abort(e, REASON_UNSTEADY);
    else
        begin_signal(e);
}

static void excite_on(struct experiment *e, struct block_io *io)
{
    if (!experiment_record(e, io)) {
        experiment_ask_signal(e, io);
        return;
    }
    e->asked_signal = false;
    stage_begins(e, EXPERIMENT_COMPUTES);
}

static void tell_of_model(struct experiment *e)
{
    stage_begins(e, EXPERIMENT_DONE);
    e->tells = (e->verdict == PLANT_USABLE ? EVENT_MODEL : EVENT_NO_MODEL) + 1;
    if (e->verdict == PLANT_USABLE)
        experiment_propose(e);
}

static void compute_on(struct experiment *e, struct block_io *io)
{
    if (io->work_wanted)
        return;
    if (e->job->over) {
        experiment_take_model(e);
        experiment_end_lease(e);
        tell_of_model(e);
        return;
    }
    e->pieces = e->piece_most;
    io->ask_work = 1;
}

/* ---- what the tick calls ---- */

static void keep_workspace(struct experiment *e)
{
    if (!experiment_runs(e)) {
        experiment_end_lease(e);
    } else if (e->job && !workspace_renew(workspace_shared(), e->lease)) {
        e->job = NULL;
        experiment_abort(e, REASON_WORKSPACE);
    }
}

static void go_on_with_stage(struct experiment *e, struct block_io *io)
{
    enum experiment_reason reason = REASON_NONE;
    if (e->asked_signal && io->excite_state != EXCITE_RUNS)
        reason = (enum experiment_reason)(REASON_EXCITE + io->excite_reason);
    else if (e->stage <= EXPERIMENT_EXCITES)
        reason = experiment_read(e, io);
    if (reason != REASON_NONE)
        experiment_abort(e, reason);
    else if (e->stage == EXPERIMENT_ASKED)
        wait_for_workspace(e, io);
    else if (e->stage == EXPERIMENT_SETTLES)
        settle_on(e, io);
    else if (e->stage == EXPERIMENT_EXCITES)
        excite_on(e, io);
    else
        compute_on(e, io);
}

static float value_of_end(const struct experiment *e)
{
    if (e->tells == EVENT_LAW + 1)
        return e->law.found.radius;
    if (e->tells == EVENT_NO_LAW + 1)
        return e->law.found.loop;
    if (e->tells == EVENT_ABORTED + 1)
        return e->reason;
    if (e->tells == EVENT_NO_MODEL + 1)
        return e->verdict;
    float least = e->found[0].fit;
    for (unsigned i = 1; i < e->n; i++)
        least = e->found[i].fit < least ? e->found[i].fit : least;
    return least;
}

static void experiment_step(void *state, struct block_io *io)
{
    struct experiment *e = state;
    keep_workspace(e);
    if (experiment_runs(e))
        go_on_with_stage(e, io);
    experiment_proposals_step(e, io->proposal);
    experiment_law_step(e, io);
    io->withdraws = !e->proposes && !e->law.proposes;
    io->raised = 0;
    if (e->tells) {
        io->raised = (uint16_t)(1u << (e->tells - 1u));
        io->event_value[e->tells - 1u] = value_of_end(e);
        e->tells = 0;
    }
}

/* The plant was away: what is in the record has a gap. Where it is whole the model is found all the same. */
static void experiment_follow(void *state, struct block_io *io)
{
    struct experiment *e = state;
    (void)io;
    if (experiment_runs(e) && e->stage != EXPERIMENT_COMPUTES)
        experiment_abort(e, REASON_PLANT);
}

/* ---- verbs ---- */

static const char *run_start(void *state, const float *number)
{
    struct experiment *e = state;
    (void)number;
    if (experiment_runs(e) || experiment_law_runs(e))
        return "runs";
    e->reason = REASON_NONE;
    e->verdict = PLANT_UNJUDGED;
    e->at_fault = 0;
    e->proposes = false;
    memset(e->gap, 0, sizeof e->gap);
    memset(e->gaps, 0, sizeof e->gaps);
    memset(e->found, 0, sizeof e->found);
    memset(e->model, 0, experiment_numbers(e->n) * sizeof e->model[0]);
    stage_begins(e, EXPERIMENT_ASKED);
    return NULL;
}

static const char *run_stop(void *state, const float *number)
{
    struct experiment *e = state;
    (void)number;
    if (experiment_law_runs(e)) {
        experiment_law_stop(e, "it", "let go on to its end");
        return NULL;
    }
    if (experiment_runs(e))
        experiment_abort(e, REASON_STOPPED);
    else if (!e->proposes && !e->law.proposes)
        return "runs not";
    e->proposes = e->law.proposes = false;
    return NULL;
}

static const char *run_law(void *state, const float *number)
{
    struct experiment *e = state;
    (void)number;
    return experiment_runs(e) ? "runs" : experiment_law_begin(e);
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
