/* The stages of a block of the kind `ff_tune`: what follows what, a sample at a time. */
#include "adapt/feedforward_tune_block.h"

#if CONFIG_FEEDFORWARD_TUNE

#define LOOKS_A_STAGE 8u
#define SETTLED_LOOKS 2u
/* In a row, none of which has brought what was promised: then it stays as it is. */
#define CHANGES_MOST 3u
/* r.m.s. of a signal that stands still: fraction of span. */
#define STILL REAL_C(5e-4)

void tune_stage_begins(struct tune *t, enum tune_stage stage)
{
    t->stage = (uint8_t)stage;
    t->stage_samples = t->signal_samples = 0;
    t->handed = false;
}

void tune_learn_stage(struct tune *t, enum tune_stage stage)
{
    tune_stage_begins(t, stage);
    t->anew = true;
    if (stage == TUNE_LOOP)
        t->has_loop = false;
}

/* A stage that learns, or the wait for a silent feedforward before it. */
void tune_begin(struct tune *t)
{
    t->computing = t->reading = false;
    if (t->s.alone && t->running)
        tune_stage_begins(t, TUNE_SILENCES);
    else
        tune_learn_stage(t, tune_is_staged(t) ? TUNE_LOOP : TUNE_DISTURBANCE);
}

/* Nothing more comes of it. One that runs is watched on. */
void tune_end_with(struct tune *t, enum tune_verdict verdict)
{
    t->verdict = (uint8_t)verdict;
    bool routine = verdict == TUNE_NO_BETTER && t->running; /* what it has is as good */
    t->told_verdict = routine ? (uint8_t)TUNE_NONE : t->verdict;
    t->asked_signal = false;
    tune_stage_begins(t, t->running && t->has_model ? TUNE_RUNS : TUNE_IDLE);
    t->since_tuned = 0;
}

/* ---- work ---- */

static void stage_of_loop_over(struct tune *t)
{
    t->has_loop = true;
    tune_learn_stage(t, TUNE_DISTURBANCE);
}

bool tune_stands_still(real_t square)
{
    return !(square > STILL * STILL);
}

/* What the stage should learn from did not move; a response that does not change then says nothing. */
static enum tune_verdict stands_still_in_stage(const struct tune *t)
{
    if (t->stage == TUNE_LOOP)
        return tune_stands_still(t->loop_square) ? TUNE_LOOP_STILL : TUNE_NONE;
    return tune_stands_still(t->move_square) ? TUNE_STILL : TUNE_NONE;
}

static void look_over(struct tune *t)
{
    t->settled_looks = (uint8_t)(t->change * 100 < t->s.settled ? t->settled_looks + 1u : 0u);
    if (t->settled_looks < SETTLED_LOOKS || t->stage_samples < tune_samples(t, t->s.learn_s))
        return;
    if (stands_still_in_stage(t) != TUNE_NONE)
        tune_end_with(t, stands_still_in_stage(t));
    else if (t->stage == TUNE_LOOP)
        stage_of_loop_over(t);
    else if (t->stage == TUNE_DISTURBANCE)
        tune_stage_begins(t, TUNE_COMPUTES);
}

static void candidate_there(struct tune *t)
{
    tune_stage_begins(t, TUNE_TESTS);
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
        tune_end_with(t, (enum tune_verdict)t->outcome);
    else
        candidate_there(t);
}

void tune_work_on(struct tune *t, struct block_io *io)
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

static void learning_on(struct tune *t)
{
    uint32_t wanted = tune_samples(t, t->s.learn_s);
    if (t->computing || !t->free)
        return;
    if (t->stage_samples > 2u * wanted) {
        enum tune_verdict still = stands_still_in_stage(t);
        tune_end_with(t, still != TUNE_NONE ? still : TUNE_SLOW);
    } else if (t->since_look >= wanted / LOOKS_A_STAGE) {
        tune_ask_look(t, true);
    }
}

static void testing_on(struct tune *t)
{
    enum tune_verdict verdict = tune_test_step(t);
    if (verdict == TUNE_ADOPTED) {
        tune_stage_begins(t, TUNE_PROPOSES);
    } else if (verdict == TUNE_NO_BETTER && tune_falls_back(t)) {
        tune_take_rule(t);
        tune_stage_begins(t, TUNE_TESTS);
        tune_test_begin(t);
    } else if (verdict != TUNE_NONE) {
        tune_end_with(t, verdict);
    }
}

/* With `every` and the feedforward on all the time. */
static bool learns_on(const struct tune *t)
{
    return t->s.every_s > 0 && !t->s.alone;
}

static bool is_due(struct tune *t)
{
    return t->s.every_s > 0 && !t->computing && t->since_tuned >= tune_samples(t, t->s.every_s) &&
           (t->s.alone || high_order_samples(tune_model(t)) >= tune_samples(t, t->s.learn_s));
}

static void running_on(struct tune *t)
{
    t->since_tuned++;
    if (is_due(t) && t->s.alone) { /* in turns, as the source */
        t->since_tuned = 0;
        tune_begin(t);
    } else if (is_due(t)) {
        t->since_tuned = 0;
        tune_stage_begins(t, TUNE_COMPUTES);
    } else if (t->since_change > tune_samples(t, t->s.check_s) && t->promised > 0 &&
               t->changes < CHANGES_MOST) {
        t->changes++;
        t->tells |= 1u << TUNE_SAYS_CHANGED;
        t->since_change = 0;
        tune_begin(t);
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
    tune_stage_begins(t, TUNE_IDLE);
    t->again = t->tried <= t->s.tries;
}

void tune_on_sample(struct tune *t)
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
                  (learns_on(t) && t->stage >= TUNE_COMPUTES);
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

#endif
