/* Kind `ff_tune`: its stages, what it proposes, and what it may be told. */
#include "adapt/feedforward_tune_block.h"

#if CONFIG_FEEDFORWARD_TUNE

#include <string.h>

#include "base/channel.h"

/* Pieces of work for each second of a step, as the experiment has them. */
#define PIECES_A_SECOND 100.0f
#define PIECES_MOST     1000.0f

#define LOOKS_A_STAGE 8u
#define SETTLED_LOOKS 2u
/* r.m.s. of a signal that stands still: fraction of span. */
#define STILL REAL_C(5e-4)
/* A reading that stays away for so many samples is told. */
#define SENSOR_AWAY 10u
/* Times what a step of the disturbance takes that a proposal waits for it to be over. */
#define CALLS 4u

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

static void stage_begins(struct tune *t, enum tune_stage stage)
{
    t->stage = (uint8_t)stage;
    t->stage_samples = t->signal_samples = 0;
    t->handed = false;
}

static void learn_stage(struct tune *t, enum tune_stage stage)
{
    stage_begins(t, stage);
    t->anew = true;
    if (stage == TUNE_LOOP)
        t->has_loop = false;
}

/* A stage that learns, or the wait for a silent feedforward before it. */
static void begin_tuning(struct tune *t)
{
    t->computing = t->reading = false;
    if (t->s.alone && t->running)
        stage_begins(t, TUNE_SILENCES);
    else
        learn_stage(t, tune_is_staged(t) ? TUNE_LOOP : TUNE_DISTURBANCE);
}

/* Nothing more comes of it. One that runs is watched on. */
static void end_with(struct tune *t, enum tune_verdict verdict)
{
    t->verdict = (uint8_t)verdict;
    bool routine = verdict == TUNE_NO_BETTER && t->running; /* what it has is as good */
    t->told_verdict = routine ? (uint8_t)TUNE_NONE : t->verdict;
    t->asked_signal = false;
    stage_begins(t, t->running && t->has_model ? TUNE_RUNS : TUNE_IDLE);
    t->since_tuned = 0;
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
        bool loop_known = t->again && t->has_loop && t->tried == 1;
        t->again = false;
        learn_stage(t, tune_is_staged(t) && !loop_known ? TUNE_LOOP : TUNE_DISTURBANCE);
        return;
    }
    if (!is_candidate && t->running)
        t->promised = 0;
    if (is_candidate) {
        t->verdict = TUNE_ADOPTED;
        t->tells |= 1u << TUNE_SAYS_ADOPTED;
        stage_begins(t, TUNE_RUNS);
        t->since_tuned = 0;
        if (tune_is_staged(t)) /* the response to d is another one now */
            t->anew = true;
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
    learn_stage(t, TUNE_DISTURBANCE);
    stage_begins(t, TUNE_IDLE);
    t->computing = t->reading = t->has_model = t->has_loop = t->silencing = false;
    t->verdict = TUNE_NONE;
    if (t->s.begin)
        begin_tuning(t);
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

/* ---- proposals ---- */

static void put_gain_off(const struct tune *t, struct block_proposal *room)
{
    uint8_t ff = (uint8_t)(t->s.element - 1u);
    room->n = 2;
    room->manner = t->s.protect || t->s.adopt ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
    room->value[0] = (struct proposed_value){proposed_own(TUNE_ID_K), 0};
    room->value[1] = (struct proposed_value){proposed_setting(PROPOSED_FF_GAIN, ff), 0};
}

static void put_candidate(const struct tune *t, struct block_proposal *room)
{
    const struct feedforward_shape *c = &t->candidate;
    const float value[4] = {(float)c->k, (float)c->lead, (float)c->lag, (float)c->dead};
    static const uint32_t field[4] = {PROPOSED_FF_GAIN, PROPOSED_FF_LEAD, PROPOSED_FF_LAG,
                                      PROPOSED_FF_DEAD};
    uint8_t ff = (uint8_t)(t->s.element - 1u);
    room->n = 8;
    room->manner = t->s.adopt == TUNE_ADOPT_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
    for (unsigned k = 0; k < 4; k++) {
        room->value[2 * k] =
            (struct proposed_value){proposed_own((uint8_t)(TUNE_ID_K + k)), value[k]};
        room->value[2 * k + 1] =
            (struct proposed_value){proposed_setting((enum proposed)field[k], ff), value[k]};
    }
}

/* Settings that come into force while a step of the disturbance is under way would keep what the element just gives, which the loop
 * makes room for. A disturbance that never rests is not waited for. */
static bool is_calm(struct tune *t)
{
    uint32_t wanted = (uint32_t)((t->s.lead_s + t->s.lag_s + t->s.dead_s) / (float)t->h_s);
    wanted = 2u * wanted + 4u;
    bool calm = t->d_rests > wanted || t->calls > CALLS * (wanted + 4u) * t->ticks;
    bool wants =
        t->silencing || (!t->handed && (t->stage == TUNE_SILENCES || t->stage == TUNE_PROPOSES));
    t->calls = wants && !calm ? t->calls + 1u : 0;
    return calm || !wants;
}

/* With room again and other settings in force it was refused, or rejected. */
static void propose_on(struct tune *t, struct block_proposal *room)
{
    if (!room || !is_calm(t))
        return;
    if (t->silencing || (t->stage == TUNE_SILENCES && !t->handed)) {
        put_gain_off(t, room);
        t->silencing = false;
        t->handed = true;
        return;
    }
    if (t->stage != TUNE_PROPOSES && t->stage != TUNE_SILENCES)
        return;
    if (t->handed) {
        end_with(t, TUNE_REJECTED);
        return;
    }
    put_candidate(t, room);
    t->handed = true;
}

/* ---- work ---- */

static void stage_of_loop_over(struct tune *t)
{
    t->has_loop = true;
    learn_stage(t, TUNE_DISTURBANCE);
}

static void look_over(struct tune *t)
{
    t->settled_looks = (uint8_t)(t->change * 100 < t->s.settled ? t->settled_looks + 1u : 0u);
    if (t->settled_looks < SETTLED_LOOKS || t->stage_samples < tune_samples(t, t->s.learn_s))
        return;
    if (t->stage == TUNE_LOOP)
        stage_of_loop_over(t);
    else if (t->stage == TUNE_DISTURBANCE)
        stage_begins(t, TUNE_COMPUTES);
}

static void candidate_there(struct tune *t)
{
    stage_begins(t, TUNE_TESTS);
    t->model = t->found;
    t->has_model = true;
    tune_shadows_begin(t);
    tune_test_begin(t);
}

static void work_over(struct tune *t)
{
    t->computing = t->reading = false;
    if (t->outcome != TUNE_NONE && t->look_only)
        return; /* not yet known; the stage's time decides */
    if (t->look_only)
        look_over(t);
    else if (t->outcome != TUNE_NONE)
        end_with(t, (enum tune_verdict)t->outcome);
    else
        candidate_there(t);
}

static void work_on(struct tune *t, struct block_io *io)
{
    if (!t->computing || io->work_wanted)
        return;
    t->reading = t->work == WORK_RESPONSES;
    if (t->work == WORK_NONE) {
        work_over(t);
        return;
    }
    t->pieces = t->piece_most;
    io->ask_work = 1;
}

/* ---- stages, a sample at a time ---- */

static bool stands_still(real_t square)
{
    return !(square > STILL * STILL);
}

static void learning_on(struct tune *t)
{
    uint32_t wanted = tune_samples(t, t->s.learn_s);
    if (t->computing || !t->free)
        return;
    if (t->stage_samples > 2u * wanted) {
        bool of_loop = t->stage == TUNE_LOOP;
        end_with(t, of_loop && stands_still(t->loop_square)    ? TUNE_LOOP_STILL
                    : !of_loop && stands_still(t->move_square) ? TUNE_STILL
                                                               : TUNE_SLOW);
    } else if (t->since_look >= wanted / LOOKS_A_STAGE) {
        tune_ask_look(t, true);
    }
}

static void testing_on(struct tune *t)
{
    enum tune_verdict verdict = tune_test_step(t);
    if (verdict == TUNE_ADOPTED)
        stage_begins(t, TUNE_PROPOSES);
    else if (verdict != TUNE_NONE)
        end_with(t, verdict);
}

static void running_on(struct tune *t)
{
    t->since_tuned++;
    if (t->s.every_s > 0 && !t->computing && t->since_tuned >= tune_samples(t, t->s.every_s) &&
        high_order_samples(tune_model(t)) >= tune_samples(t, t->s.learn_s)) {
        t->since_tuned = 0;
        stage_begins(t, TUNE_COMPUTES);
    } else if (t->since_change > tune_samples(t, t->s.check_s) && t->promised > 0) {
        t->tells |= 1u << TUNE_SAYS_CHANGED;
        t->since_change = 0;
        begin_tuning(t);
    }
}

/* It protects the loop whatever stage it is in. */
static void watch_on(struct tune *t)
{
    enum tune_verdict verdict = tune_watch_step(t);
    if (verdict != TUNE_WORSE || !t->s.protect || t->silencing)
        return;
    t->tells |= 1u << TUNE_SAYS_WORSE;
    t->worse_by = -tune_improvement(t);
    t->silencing = true;
    t->tried = (uint8_t)(t->tried < 255u ? t->tried + 1u : 255u);
    t->verdict = TUNE_WORSE;
    t->asked_signal = false;
    tune_watch_begin(t);
    t->computing = t->reading = false;
    stage_begins(t, TUNE_IDLE);
    t->again = t->tried <= t->s.tries;
}

static void on_sample(struct tune *t)
{
    t->stage_samples++;
    t->signal_samples++;
    if (t->anew && t->free) {
        tune_learn_anew(t);
        t->anew = false;
    }
    if (t->anew)
        return;
    bool learns = t->stage == TUNE_LOOP || t->stage == TUNE_DISTURBANCE ||
                  (t->s.every_s > 0 && t->stage >= TUNE_COMPUTES);
    if (learns)
        tune_learn(t);
    if (t->has_model && (t->running || t->stage == TUNE_TESTS)) {
        tune_shadows_step(t);
        if (t->running)
            watch_on(t);
    }
    if (t->stage == TUNE_LOOP || t->stage == TUNE_DISTURBANCE)
        learning_on(t);
    else if (t->stage == TUNE_COMPUTES && !t->computing && t->free)
        tune_ask_look(t, false);
    else if (t->stage == TUNE_TESTS)
        testing_on(t);
    else if (t->stage == TUNE_RUNS)
        running_on(t);
}

/* ---- what the tick calls ---- */

static void tell_events(struct tune *t, struct block_io *io)
{
    bool still = t->stage == TUNE_DISTURBANCE && stands_still(t->move_square) &&
                 2u * t->stage_samples > tune_samples(t, t->s.learn_s);
    bool away = t->sensor_away > SENSOR_AWAY * t->ticks;
    if (t->told_verdict)
        t->tells |= 1u << TUNE_SAYS_NOT;
    io->raised = (uint16_t)(t->tells | (still ? 1u << TUNE_SAYS_STILL : 0u) |
                            (away ? 1u << TUNE_SAYS_SENSOR : 0u));
    io->event_value[TUNE_SAYS_ADOPTED] = 100 * (float)t->promised;
    io->event_value[TUNE_SAYS_NOT] = t->told_verdict;
    io->event_value[TUNE_SAYS_WORSE] = t->worse_by;
    io->event_value[TUNE_SAYS_CHANGED] = tune_improvement(t);
    io->event_value[TUNE_SAYS_STILL] = 100 * (float)real_sqrt(t->move_square);
    io->event_value[TUNE_SAYS_SENSOR] = io->quality[0] == QUALITY_GOOD ? 2 : 1;
    t->tells = 0;
    t->told_verdict = TUNE_NONE;
}

/* A signal that was refused, or ended by others. */
static void look_at_signal(struct tune *t, const struct block_io *io)
{
    if (t->asked_signal && io->excite_state != EXCITE_RUNS)
        end_with(t, (enum tune_verdict)(TUNE_SIGNAL + io->excite_reason));
}

static void tune_step(void *state, struct block_io *io)
{
    struct tune *t = state;
    io->out[0] = io->in[0];
    bool good = io->quality[0] == QUALITY_GOOD && io->quality[1] == QUALITY_GOOD;
    t->sensor_away = good ? 0 : t->sensor_away + 1u;
    look_at_signal(t, io);
    t->free = !io->work_wanted;
    work_on(t, io);
    if (tune_take(t, io))
        on_sample(t);
    tune_ask_signal(t, io);
    propose_on(t, io->proposal);
    tell_events(t, io);
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

static const char *run_tune(void *state, const float *number)
{
    struct tune *t = state;
    (void)number;
    if (t->stage != TUNE_IDLE && t->stage != TUNE_RUNS)
        return "runs";
    t->tried = 0;
    begin_tuning(t);
    return NULL;
}

static const char *run_stop(void *state, const float *number)
{
    struct tune *t = state;
    (void)number;
    if (t->stage == TUNE_IDLE || t->stage == TUNE_RUNS)
        return "runs_not";
    t->computing = t->reading = false;
    end_with(t, TUNE_STOPPED);
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

static const char *run_reset(void *state, const float *number)
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
    {"tune", NULL, "identify, tune, test, propose", 0, 0, false, ACCESS_ENGINEER, run_tune},
    {"stop", NULL, "give that up", 0, 0, false, ACCESS_OPERATOR, run_stop},
    {"silence", NULL, "propose a feedforward gain of 0", 0, 0, false, ACCESS_OPERATOR, run_silence},
    {"reset", NULL, "P = P(0); what is estimated stays", 0, 0, false, ACCESS_ENGINEER, run_reset},
};

const struct block_kind feedforward_tune_kind = {
    .name = "ff_tune",
    .stage = STAGE_COMPENSATE,
    .parameter = tune_parameter_rows,
    .parameters = TUNE_PARAMETERS,
    .settings_bytes = sizeof(struct tune_settings),
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

#endif
