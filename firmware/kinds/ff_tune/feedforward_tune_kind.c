/* Kind `ff_tune`: its settings, its turn in the tick, what it says and may be told. */
#include "kinds/ff_tune/feedforward_tune_block.h"

#include <string.h>

#include "base/channel.h"

/* Pieces of work for each second of a step, as the experiment has them. */
#define PIECES_A_SECOND 100.0f
#define PIECES_MOST     1000.0f

/* A reading that stays away for so many samples is told. */
#define SENSOR_AWAY 10u

static const struct block_event tune_events[TUNE_EVENTS] = {
    [TUNE_SAYS_ADOPTED] = {"adopted", BLOCK_INFO,
                           "a feedforward was taken; what it takes off the squares, tested, %"},
    [TUNE_SAYS_NOT] = {"not", BLOCK_INFO,
                       "none: 2 disturbance still, 3 loop still, 4 slow, 5 no band, 6 unsure, "
                       "7 no model, 8 no better, 9 untested, 10 rejected, 12 stopped, 13+ signal"},
    [TUNE_SAYS_WORSE] = {"worse", BLOCK_ALARM,
                         "the loop was worse than without its feedforward, which is off; by %"},
    [TUNE_SAYS_CHANGED] = {"changed", BLOCK_INFO,
                           "it does less than half of what was tested; it is identified anew; %"},
    [TUNE_SAYS_STILL] =
        {"still", BLOCK_INFO,
         "the disturbance stands still: step it, or set disturb; r.m.s., % of span"},
    [TUNE_SAYS_SENSOR] = {"sensor", BLOCK_ALARM,
                          "a reading is missing; 1 the PV, 2 the disturbance"},
    [TUNE_SAYS_WEAK] = {"weak", BLOCK_INFO,
                        "the test signal is small beside what else moves the PV; set step to, EU"},
};

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

/* But for what it proposes itself. */
static bool tune_differs(const struct tune_settings *before, const struct tune_settings *now)
{
    return memcmp(before, now, offsetof(struct tune_settings, k)) != 0;
}

static void take_grid_and_filters(struct tune *t, const struct block_setup *setup)
{
    float bias = t->s.bias_s > 0 ? t->s.bias_s : 0.25f * t->s.learn_s;
    for (unsigned k = 0; k < TUNE_SIGNALS; k++) {
        enum err none = washout_init(&t->high_pass[k], 1, bias, bias, (float)t->h_s); /* checked */
        (void)none;
    }
    t->y_signal = setup->input[0];
    t->d_signal = setup->input[1];
    t->d_is_mv = setup->input[1].is_mv;
    tune_make_grid(t);
}

/* The element has other numbers, of which the present responses know nothing. */
static void element_changed(struct tune *t, bool is_candidate)
{
    t->running = t->s.k > 0 || t->s.k < 0;
    tune_watch_begin(t);
    t->let_pass = t->asked_signal;
    t->asked_signal = false;
    if (!t->running && (t->again || t->stage == TUNE_SILENCES)) {
        /* The first time with what is known of the loop: that it moved it the wrong way may be the element's doing alone. */
        bool loop_known = t->again && t->has_loop && t->tried == 1 && t->verdict == TUNE_WORSE;
        t->again = false;
        tune_learn_stage(t, tune_is_staged(t) && !loop_known ? TUNE_LOOP : TUNE_DISTURBANCE);
        return;
    }
    if (!is_candidate && t->running)
        t->promised = 0;
    if (tune_is_staged(t) && t->stage != TUNE_LOOP)
        t->anew = true; /* the response to d is another one now */
    if (is_candidate) {
        t->verdict = TUNE_ADOPTED;
        t->tells |= 1u << TUNE_SAYS_ADOPTED;
        tune_stage_begins(t, TUNE_RUNS);
        t->since_tuned = 0;
    }
}

static bool is_candidate(const struct tune *t, const struct tune_settings *s)
{
    const struct feedforward_shape *c = &t->candidate;
    return t->stage == TUNE_PROPOSES && s->k == (float)c->k && s->lead_s == (float)c->lead &&
           s->lag_s == (float)c->lag && s->dead_s == (float)c->dead;
}

static bool element_differs(const struct tune_settings *a, const struct tune_settings *b)
{
    return a->k != b->k || a->lead_s != b->lead_s || a->lag_s != b->lag_s || a->dead_s != b->dead_s;
}

static void begin_without_past(struct tune *t)
{
    tune_samples_begin(t);
    tune_learn_stage(t, TUNE_DISTURBANCE);
    tune_stage_begins(t, TUNE_IDLE);
    t->computing = t->reading = t->has_model = t->has_loop = false;
    t->silencing = t->off_waits = t->again = false;
    t->verdict = TUNE_NONE;
    t->tried = t->changes = 0;
    t->d_square = t->d_most = t->d_learnt = t->d_noise = REAL_C(0.0);
    t->by_itself = false;
    t->d_still = 1;
    if (t->s.begin)
        tune_begin(t);
}

static enum err tune_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct tune *t = state;
    const struct tune_settings *s = setup->settings;
    if (!retune)
        memset(t, 0, tune_bytes(setup));
    bool whole = !retune || tune_differs(&t->s, s);
    bool proposed = retune && !whole && is_candidate(t, s);
    bool other = retune && element_differs(&t->s, s);
    t->s = *s;
    t->ticks = (uint16_t)tune_ticks(setup);
    t->tick_s = setup->interval_s;
    t->h_s = setup->interval_s * (real_t)t->ticks;
    float pieces = PIECES_A_SECOND * setup->interval_s;
    t->piece_most = (uint16_t)(pieces < 1 ? 1 : pieces < PIECES_MOST ? pieces : PIECES_MOST);
    tune_shapes(s, t->shape);
    if (whole) {
        take_grid_and_filters(t, setup);
        begin_without_past(t);
    }
    if (whole || other)
        element_changed(t, proposed);
    return ERR_OK;
}

/* ---- what the tick calls ---- */

static void tell_tuning_events(struct tune *t, struct block_io *io)
{
    bool still = (t->stage == TUNE_LOOP || t->stage == TUNE_DISTURBANCE) && tune_waits(t) &&
                 2u * t->d_still > tune_samples(t, t->s.learn_s);
    bool away = t->sensor_away > SENSOR_AWAY * t->ticks;
    if (t->told_verdict)
        t->tells |= 1u << TUNE_SAYS_NOT;
    io->raised = (uint16_t)(t->tells | (still ? 1u << TUNE_SAYS_STILL : 0u) |
                            (away ? 1u << TUNE_SAYS_SENSOR : 0u));
    if (t->told_verdict && tune_step_wanted(t) > 0)
        io->raised |= 1u << TUNE_SAYS_WEAK;
    io->event_value[TUNE_SAYS_WEAK] = tune_step_wanted(t);
    io->event_value[TUNE_SAYS_ADOPTED] = 100 * (float)t->promised;
    io->event_value[TUNE_SAYS_NOT] = t->told_verdict;
    io->event_value[TUNE_SAYS_WORSE] = t->worse_by;
    io->event_value[TUNE_SAYS_CHANGED] = t->changed_to;
    io->event_value[TUNE_SAYS_STILL] = 100 * (float)real_sqrt(t->d_square);
    io->event_value[TUNE_SAYS_SENSOR] = io->quality[0] == QUALITY_GOOD ? 2 : 1;
    t->tells = 0;
    t->told_verdict = TUNE_NONE;
}

/* A signal that was refused, or ended by others. */
static void look_at_signal(struct tune *t, const struct block_io *io)
{
    if (t->asked_signal && io->excite_state != EXCITE_RUNS)
        tune_end_with(t, (enum tune_verdict)(TUNE_SIGNAL + io->excite_reason));
}

static void tune_step(void *state, struct block_io *io)
{
    struct tune *t = state;
    io->out[0] = io->in[0];
    bool good = io->quality[0] == QUALITY_GOOD && io->quality[1] == QUALITY_GOOD;
    t->sensor_away = good ? 0 : t->sensor_away + 1u;
    look_at_signal(t, io);
    t->free = !io->work_wanted;
    tune_work_on(t, io);
    if (tune_take(t, io))
        tune_on_sample(t);
    tune_ask_signal(t, io);
    tune_propose_on(t, io);
    tell_tuning_events(t, io);
}

/* What the controller has to give is what the MV is to be: nothing is in between. */
static void tune_pass(void *state, struct block_io *io)
{
    (void)state;
    io->out[0] = io->in[0];
}

/* It was not called for a while: what the models look back at has a gap. */
static void tune_follow(void *state, struct block_io *io)
{
    struct tune *t = state;
    io->out[0] = io->in[0];
    if (io->going_on & 1u)
        return;
    tune_samples_begin(t);
    if (t->has_model)
        tune_shadows_begin(t);
}

/* ---- verbs ---- */

static const char *run_tune_element(void *state, const float *number)
{
    struct tune *t = state;
    (void)number;
    if (t->stage != TUNE_IDLE && t->stage != TUNE_RUNS)
        return "runs";
    t->tried = t->changes = 0;
    t->by_itself = false;
    tune_begin(t);
    return NULL;
}

static const char *run_stop_tuning(void *state, const float *number)
{
    struct tune *t = state;
    (void)number;
    if (t->stage == TUNE_IDLE || t->stage == TUNE_RUNS)
        return "runs_not";
    t->computing = t->reading = false;
    tune_end_with(t, TUNE_STOPPED);
    return NULL;
}

static const char *run_silence(void *state, const float *number)
{
    struct tune *t = state;
    (void)number;
    if (!t->running)
        return "is_off";
    t->silencing = true;
    return NULL;
}

static const char *run_reset_model(void *state, const float *number)
{
    struct tune *t = state;
    (void)number;
    if (t->computing || !t->free)
        return "computes";
    high_order_reset(tune_model(t));
    t->settled_looks = 0;
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
    .event = tune_events,
    .events = TUNE_EVENTS,
    .bytes = tune_bytes,
    .check = tune_check,
    .configure = tune_configure,
    .step = tune_step,
    .back_calculate = tune_pass,
    .follow = tune_follow,
    .describe = tune_describe,
};
