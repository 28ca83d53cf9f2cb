/* Kind `experiment`: what the tick calls. */
#include "adapt/prbs_inside.h"

#if CONFIG_BLOCKS

#include <string.h>

#include "base/workspace.h"

#define WORKSPACE_HOLDER "an experiment"
#define WORKSPACE_FREES  "block N stop"

/* After which the model is taken, and steps at most. */
#define FIND_S     10.0f
#define STEPS_MOST 250.0f

enum experiment_event {
    EVENT_BEGUN,
    EVENT_FOUND,
    EVENT_DOUBT,
    EVENT_ABORT,
    EVENT_ADOPTED_MODEL,
    EXPERIMENT_EVENTS
};

static const struct block_event experiment_events[EXPERIMENT_EVENTS] = {
    [EVENT_BEGUN] = {"begun", BLOCK_INFO, "the MVs move, samples"},
    [EVENT_FOUND] = {"found", BLOCK_INFO,
                     "a model; part of the movement that it explains, least of all outputs"},
    [EVENT_DOUBT] = {"doubt", BLOCK_ALARM,
                     "no model to rely on; 1 still, 2 unstable, 3 unexplained"},
    [EVENT_ABORT] = {"abort", BLOCK_ALARM,
                     "ended; 2 reach, 3 reading, 4 MV, 5 workspace, 6 away or settings"},
    [EVENT_ADOPTED_MODEL] = {"adopted", BLOCK_INFO, "the model is in the settings, -"},
};

/* ---- settings ---- */

static uint32_t experiment_bytes(const struct block_setup *setup)
{
    (void)setup;
    return (uint32_t)((sizeof(struct experiment_block) + 7u) & ~(size_t)7u);
}

static uint16_t experiment_history(const struct block_setup *setup)
{
    (void)setup;
    return 1;
}

static bool is_under_way(const struct experiment_block *b)
{
    return b->stage >= EXPERIMENT_BEGINS && b->stage <= EXPERIMENT_FINDS;
}

static void give_back_workspace(struct experiment_block *b)
{
    if (b->work && workspace_shared())
        workspace_end(workspace_shared(), b->lease);
    b->work = NULL;
}

static void end_experiment(struct experiment_block *b, enum experiment_end end)
{
    b->stage = EXPERIMENT_ENDED;
    b->end = (uint8_t)end;
}

/* Whether only the model in force is another. Records are compared by their bytes, as the supervisor does. */
static bool asks_for_the_same(const struct experiment_settings *a,
                              const struct experiment_settings *b)
{
    const size_t before = offsetof(struct experiment_settings, model),
                 behind = before + sizeof a->model;
    const char *x = (const char *)a, *y = (const char *)b;
    return memcmp(x, y, before) == 0 && memcmp(x + behind, y + behind, sizeof *a - behind) == 0;
}

static enum err experiment_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct experiment_block *b = state;
    const struct experiment_settings *s = setup->settings;
    if (!retune)
        memset(b, 0, sizeof *b);
    if (is_under_way(b) && !(b->interval_s == setup->interval_s && asks_for_the_same(&b->s, s)))
        end_experiment(b, END_AWAY);
    b->s = *s;
    b->interval_s = setup->interval_s;
    b->outputs = (uint8_t)experiment_outputs(setup);
    b->mvs = (uint8_t)(setup->inputs - b->outputs);
    if (!is_under_way(b)) {
        b->ratio = experiment_ratio(setup);
        b->samples = experiment_samples(s);
    }
    return ERR_OK;
}

/* ---- stages ---- */

static void begin_rest(struct experiment_block *b)
{
    b->stage = EXPERIMENT_RESTS;
    b->at = b->lost = 0;
    b->ticks = b->lost_in_a_row = 0;
    b->anew = true;
    memset(b->level, 0, sizeof b->level);
    memset(b->square, 0, sizeof b->square);
    memset(b->sum, 0, sizeof b->sum);
    memset(b->found, 0, sizeof b->found);
    memset(b->gain, 0, sizeof b->gain);
    for (unsigned i = 0; i < CHANNELS; i++)
        if (decimator_init(&b->filter[i], b->ratio, (real_t)b->s.cutoff) != ERR_OK)
            end_experiment(b, END_AWAY); /* check() looked at both */
}

static void begin_moving(struct experiment_block *b)
{
    struct prbs_settings signal;
    experiment_signal(&b->s, b->mvs, &signal);
    prbs_init(&b->prbs, &signal);
    b->at = 0;
    b->stage = EXPERIMENT_MOVES;
}

static num_t kept_in_span(float x)
{
    return num_from_float(x < 0 ? 0 : x > 1 ? 1 : x);
}

static void ask_to_move(const struct experiment_block *b, struct block_io *io)
{
    for (unsigned j = 0; j < b->mvs; j++) {
        float amplitude = b->s.amplitude[j],
              move = b->s.move[j] > 0 ? b->s.move[j] : 1.5f * amplitude;
        num_t size = num_from_float(amplitude);
        io->excite[j] =
            (struct block_excitation){.what = EXCITE_INPUT,
                                      .which = (uint8_t)(b->outputs + j),
                                      .value = b->signal[j] < 0 ? num_neg(size) : size,
                                      .amplitude = size,
                                      .lo = kept_in_span(b->level[CHANNELS + j] - move),
                                      .hi = kept_in_span(b->level[CHANNELS + j] + move)};
    }
}

static uint8_t steps_to_find(const struct experiment_block *b)
{
    float steps = FIND_S / b->interval_s;
    return (uint8_t)(steps < 1.0f ? 1.0f : steps > STEPS_MOST ? STEPS_MOST : steps);
}

static void take_a_sample(struct experiment_block *b, const real_t *y, const real_t *u)
{
    if (b->stage == EXPERIMENT_RESTS) {
        experiment_rest(b, y, u);
        if (b->at <= b->s.rest)
            return;
        begin_moving(b);
    }
    experiment_record(b, y, u);
    if (b->at < b->samples)
        prbs_step(&b->prbs, b->signal);
    else
        b->stage = EXPERIMENT_FINDS;
}

/* While it rests or moves. */
static void rest_or_move(struct experiment_block *b, struct block_io *io)
{
    real_t y[CHANNELS], u[CHANNELS];
    bool moved = b->stage == EXPERIMENT_MOVES;
    if (moved && (io->excite_state == EXCITE_REFUSED || io->excite_state == EXCITE_ENDED)) {
        b->detail = io->excite_reason;
        end_experiment(b, END_MV);
        return;
    }
    enum experiment_end end = experiment_watch(b, io);
    if (end) {
        end_experiment(b, end);
        return;
    }
    if (experiment_take(b, io, y, u))
        take_a_sample(b, y, u);
    if (b->stage == EXPERIMENT_MOVES)
        ask_to_move(b, io);
    if (moved && b->stage == EXPERIMENT_FINDS) {
        experiment_begin_finding(b);
        io->ask_work = steps_to_find(b);
    }
}

static void take_what_was_found(struct experiment_block *b)
{
    uint8_t output = 0;
    enum experiment_doubt doubt = experiment_take_model(b, &output);
    if (doubt) {
        end_experiment(b, END_DOUBT);
        b->detail = (uint8_t)doubt;
        return;
    }
    b->proposed = b->waits_for = 0;
    b->stage = experiment_is_small(b) ? EXPERIMENT_PROPOSES : EXPERIMENT_DONE;
}

/* ---- verbs ---- */

static const char *run_start(void *state, const float *number)
{
    struct experiment_block *b = state;
    (void)number;
    if (is_under_way(b))
        return "runs already";
    if (!workspace_shared())
        return "no workspace";
    b->wants_start = true;
    return NULL;
}

static const char *run_stop(void *state, const float *number)
{
    struct experiment_block *b = state;
    (void)number;
    if (!is_under_way(b) && b->stage != EXPERIMENT_PROPOSES)
        return "does not run";
    b->wants_stop = true;
    return NULL;
}

static const struct block_verb experiment_verbs[] = {
    {.name = "start",
     .help = "rests, then moves all MVs by their amplitudes, then finds a model",
     .access = ACCESS_ENGINEER,
     .run = run_start},
    {.name = "stop",
     .help = "MVs go back to where they were, nothing is found",
     .access = ACCESS_OPERATOR,
     .run = run_stop},
};

/* ---- steps ---- */

/* The plant was away, or the board has just begun. */
static void experiment_follow(void *state, struct block_io *io)
{
    struct experiment_block *b = state;
    (void)io;
    if (is_under_way(b))
        end_experiment(b, END_AWAY);
}

static void hear_verbs(struct experiment_block *b)
{
    if (b->wants_stop && (is_under_way(b) || b->stage == EXPERIMENT_PROPOSES)) {
        b->detail = 0;
        end_experiment(b, END_BY_HAND);
    }
    b->wants_stop = false;
}

static void begin_if_asked(struct experiment_block *b, struct block_io *io)
{
    if (!b->wants_start || is_under_way(b) || io->work_wanted)
        return;
    give_back_workspace(b);
    b->wants_start = false;
    b->end = b->detail = 0;
    b->stage = EXPERIMENT_BEGINS;
    io->ask_work = 1;
}

static void propose_model(struct experiment_block *b, struct block_io *io, uint16_t *raised)
{
    bool refused;
    if (experiment_propose(b, io, &refused))
        return;
    b->stage = EXPERIMENT_DONE;
    if (!refused)
        *raised = (uint16_t)(*raised | 1u << EVENT_ADOPTED_MODEL);
}

static float least_fit(const struct experiment_block *b)
{
    float least = 1;
    for (unsigned i = 0; i < b->outputs; i++)
        least = b->found[i].fit < least ? b->found[i].fit : least;
    return least;
}

static void tell_stage(const struct experiment_block *b, struct block_io *io, uint16_t raised)
{
    if (b->stage == EXPERIMENT_MOVES)
        raised = (uint16_t)(raised | 1u << EVENT_BEGUN);
    if (b->stage == EXPERIMENT_PROPOSES || b->stage == EXPERIMENT_DONE)
        raised = (uint16_t)(raised | 1u << EVENT_FOUND);
    if (b->stage == EXPERIMENT_ENDED && b->end != END_BY_HAND)
        raised = (uint16_t)(raised | 1u << (b->end == END_DOUBT ? EVENT_DOUBT : EVENT_ABORT));
    io->raised = raised;
    io->event_value[EVENT_BEGUN] = (float)b->samples;
    io->event_value[EVENT_FOUND] = least_fit(b);
    io->event_value[EVENT_DOUBT] = b->detail;
    io->event_value[EVENT_ABORT] = b->end;
}

static void experiment_step(void *state, struct block_io *io)
{
    struct experiment_block *b = state;
    uint16_t raised = 0;
    bool has_workspace = b->work && workspace_renew(workspace_shared(), b->lease);
    hear_verbs(b);
    begin_if_asked(b, io);
    switch (b->stage) {
    case EXPERIMENT_BEGINS:
        if (!io->work_done)
            break;
        if (has_workspace)
            begin_rest(b);
        else
            end_experiment(b, END_WORKSPACE);
        break;
    case EXPERIMENT_RESTS:
    case EXPERIMENT_MOVES:
        if (has_workspace)
            rest_or_move(b, io);
        else
            end_experiment(b, END_WORKSPACE);
        break;
    case EXPERIMENT_FINDS:
        if (io->work_done && has_workspace)
            take_what_was_found(b);
        else if (!has_workspace || !io->work_wanted)
            end_experiment(b, END_WORKSPACE);
        break;
    case EXPERIMENT_PROPOSES:
        propose_model(b, io, &raised);
        break;
    default:
        break;
    }
    if (!is_under_way(b) && !io->work_wanted)
        give_back_workspace(b);
    tell_stage(b, io, raised);
}

/* Main loop. */
static bool experiment_work(void *state)
{
    struct experiment_block *b = state;
    struct workspace *w = workspace_shared();
    void *memory = NULL;
    if (!w)
        return false;
    if (b->stage == EXPERIMENT_FINDS)
        return b->work && workspace_renew(w, b->lease) && experiment_find_piece(b);
    if (b->stage == EXPERIMENT_BEGINS && !b->work &&
        workspace_lease_for_now(w, WORKSPACE_HOLDER, WORKSPACE_FREES,
                                experiment_work_bytes(&b->s, b->outputs, b->mvs), &b->lease,
                                &memory) == ERR_OK)
        experiment_place_work(b, memory);
    return false;
}

const struct block_kind experiment_kind = {
    .name = "experiment",
    .stage = STAGE_ESTIMATE,
    .parameter = experiment_parameter_rows,
    .parameters = EXPERIMENT_PARAMETER_ROWS,
    .settings_bytes = sizeof(struct experiment_settings),
    .inputs_most = 2 * DIFFERENCE_MOST,
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

#endif
