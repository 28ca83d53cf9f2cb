/* The stages of a block of the kind `ff_tune`: what follows what, a sample at a time. */
#include "kinds/ff_tune/feedforward_tune_block.h"

#define LOOKS_A_STAGE 8u
#define SETTLED_LOOKS 2u
/* Times `settled` that a response may still change when the time of a stage is over. */
#define UNSETTLED 5.0f
/* A test signal that was too small: how many times as large the next one should be. */
#define STEP_MORE_LEAST 2.0f
#define STEP_MORE_MOST  10.0f
/* In a row, none of which has brought what was promised: then it stays as it is. */
#define CHANGES_MOST 3u
/* An element may do less than half of what was tested for this part of `check`. */
#define CHANGED_PART 0.5f
/* Less than this, %, is not worth an element that acts. */
#define OF_NO_USE 10.0f
/* r.m.s. of a signal that stands still: fraction of span. */
#define STILL REAL_C(5e-4)

void tune_stage_begins(struct tune *t, enum tune_stage stage)
{
    t->stage = (uint8_t)stage;
    t->stage_samples = t->signal_samples = 0;
    t->d_moved = !t->d_still;
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

/* Doubt and change of a response grow with what else moves the PV and shrink with the test signal. A response that is not there at all
 * tells nothing: then twice as much is asked for. */
float tune_step_wanted(const struct tune *t)
{
    float times = STEP_MORE_LEAST;
    if (t->verdict == TUNE_SLOW)
        times = (float)t->change * 100 / t->s.settled;
    else if (t->verdict == TUNE_UNSURE)
        times = (float)t->spread * 100 / t->s.confident;
    else if (t->verdict != TUNE_NO_MODEL && t->verdict != TUNE_NO_BAND)
        return 0;
    times = times > STEP_MORE_LEAST ? times : STEP_MORE_LEAST;
    return t->s.step * (times < STEP_MORE_MOST ? times : STEP_MORE_MOST);
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
    if (t->stage == TUNE_LOOP && !tune_waits(t))
        return tune_stands_still(t->loop_square) ? TUNE_LOOP_STILL : TUNE_NONE;
    return tune_stands_still(t->move_square) ? TUNE_STILL : TUNE_NONE;
}

static void stage_over(struct tune *t)
{
    if (stands_still_in_stage(t) != TUNE_NONE)
        tune_end_with(t, stands_still_in_stage(t));
    else if (t->stage == TUNE_LOOP)
        stage_of_loop_over(t);
    else if (t->stage == TUNE_DISTURBANCE)
        tune_stage_begins(t, TUNE_COMPUTES);
}

static void look_over(struct tune *t)
{
    t->settled_looks = (uint8_t)(t->change * 100 < t->s.settled ? t->settled_looks + 1u : 0u);
    if (t->settled_looks >= SETTLED_LOOKS && t->stage_samples >= tune_samples(t, t->s.learn_s))
        stage_over(t);
}

static void candidate_there(struct tune *t)
{
    tune_stage_begins(t, TUNE_TESTS);
    t->model = t->found;
    t->has_model = true;
    t->d_learnt = t->move_square;
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
        if (t->change * 100 < UNSETTLED * t->s.settled || stands_still_in_stage(t) != TUNE_NONE)
            stage_over(t); /* whether what was learnt is good enough is tested behind it */
        else
            tune_end_with(t, TUNE_SLOW);
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

/* Off at once, and then anew, or not. */
static void switch_off(struct tune *t, bool again)
{
    t->silencing = true;
    t->asked_signal = false;
    tune_watch_begin(t);
    t->computing = t->reading = false;
    tune_stage_begins(t, TUNE_IDLE);
    t->again = again;
    t->by_itself = true; /* what follows */
}

/* It does less than half of what was tested. Under a test signal on the setpoint nothing is watched: so that it may not act then. */
static void no_longer_does_it(struct tune *t)
{
    bool anew = t->changes < CHANGES_MOST;
    bool off =
        t->s.protect && (anew ? t->s.step > 0 : t->as_alone || tune_improvement(t) < OF_NO_USE);
    t->since_change = 0;
    if (!anew && !off)
        return;
    t->tells |= 1u << TUNE_SAYS_CHANGED;
    t->changed_to = tune_improvement(t);
    t->changes = (uint8_t)(t->changes + anew);
    if (off && !anew)
        t->verdict = t->told_verdict = TUNE_NO_BETTER;
    if (off) {
        switch_off(t, anew);
    } else {
        t->by_itself = true;
        tune_begin(t);
    }
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
    } else if (t->since_change > tune_samples(t, CHANGED_PART * t->s.check_s) && t->promised > 0) {
        no_longer_does_it(t);
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
    t->tried = (uint8_t)(t->tried < 255u ? t->tried + 1u : 255u);
    t->verdict = TUNE_WORSE;
    switch_off(t, t->tried <= t->s.tries);
}

void tune_on_sample(struct tune *t)
{
    tune_look_at_disturbance(t);
    /* A disturbance that has come to rest takes nothing of a stage's time; one that never moved is told as still. */
    t->stage_samples += !tune_waits(t) || !t->d_moved;
    t->signal_samples++;
    if (t->anew && t->free) {
        tune_learn_anew(t);
        t->anew = false;
    }
    if (t->anew)
        return;
    bool learns = !tune_waits(t) && (t->stage == TUNE_LOOP || t->stage == TUNE_DISTURBANCE ||
                                     (learns_on(t) && t->stage >= TUNE_COMPUTES));
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
