#include "kinds/ff_tune/tune_stages.h"

#include "base/channel.h"
#include "kinds/ff_tune/tune_disturbance.h"
#include "kinds/ff_tune/tune_events.h"
#include "kinds/ff_tune/tune_learner.h"
#include "kinds/ff_tune/tune_proposals.h"
#include "kinds/ff_tune/tune_search.h"
#include "kinds/ff_tune/tune_signals.h"
#include "kinds/ff_tune/tune_stages_state.h"
#include "kinds/ff_tune/tune_watch.h"

#define LOOKS_A_STAGE 8u
/* Times `settled` that a response may still change when the time of a stage is over. */
#define UNSETTLED 5.0f
/* A test signal that was too small: how many times as large the next one should be. */
#define STEP_MORE_LEAST 2.0f
#define STEP_MORE_MOST  10.0f
/* An element that takes off less than this, %, is not worth having. */
#define NO_USE 10.0f

static bool learns_loop(const struct tune_stages *s)
{
    return s->stage == TUNE_LOOP;
}

static bool stage_learns(const struct tune_stages *s)
{
    return learns_loop(s) || s->stage == TUNE_DISTURBANCE;
}

static void begin_tune_stage(const struct tune_parts *p, enum tune_stage stage)
{
    p->stages->stage = (uint8_t)stage;
    p->stages->samples = 0;
    tune_signals_begin(p->signals);
    p->stages->moved = !tune_disturbance_still(p->disturbance);
    tune_proposals_begin(p->proposals);
}

/* A stage that learns, from the next sample on for which the work is over. */
static void begin_learning(const struct tune_parts *p, enum tune_stage stage)
{
    begin_tune_stage(p, stage);
    p->stages->anew = true;
    if (stage == TUNE_LOOP)
        p->stages->has_loop = false;
}

/* The first stage that learns, or the wait for a silent feedforward before it. */
static void begin_tuning(const struct tune_parts *p)
{
    tune_search_cancel(p->search);
    if (p->context->s.alone && p->stages->acts)
        begin_tune_stage(p, TUNE_SILENCES);
    else
        begin_learning(p, tune_is_staged(p->context) ? TUNE_LOOP : TUNE_DISTURBANCE);
}

/* The identification ends without an element. One that acts is watched on. */
static void end_tuning(const struct tune_parts *p, enum tune_verdict verdict)
{
    struct tune_stages *s = p->stages;
    s->verdict = (uint8_t)verdict;
    /* The element that acts is as good as the candidate. */
    bool routine = verdict == TUNE_NO_BETTER && s->acts;
    tune_events_ended(p->events, routine ? TUNE_NONE : verdict);
    tune_signals_stop(p->signals);
    begin_tune_stage(p, s->acts && s->has_model ? TUNE_RUNS : TUNE_IDLE);
    s->since_tuned = 0;
}

static void forget_tries(const struct tune_parts *p)
{
    p->stages->tried = 0;
    tune_watch_forget_changes(p->watch);
    p->stages->unasked = false;
}

/* ---- settings ---- */

static void begin_samples(const struct tune_parts *p)
{
    tune_samples_begin(p->samples);
    high_order_interrupt(p->estimator);
}

void tune_stages_reset(const struct tune_parts *p)
{
    struct tune_stages *s = p->stages;
    begin_samples(p);
    begin_learning(p, TUNE_DISTURBANCE);
    begin_tune_stage(p, TUNE_IDLE);
    tune_search_cancel(p->search);
    tune_proposals_forget(p->proposals);
    s->has_model = s->has_loop = s->again = false;
    s->verdict = TUNE_NONE;
    forget_tries(p);
    tune_disturbance_begin(p->disturbance);
    if (p->context->s.begin)
        begin_tuning(p);
}

void tune_stages_element(const struct tune_parts *p, bool is_candidate)
{
    struct tune_stages *s = p->stages;
    bool staged = tune_is_staged(p->context);
    s->acts = p->context->s.k > 0 || p->context->s.k < 0;
    tune_watch_begin(p->watch);
    tune_signals_pause(p->signals);
    if (!s->acts && (s->again || s->stage == TUNE_SILENCES)) {
        /* The first time the responses of the loop are kept: that it moved the wrong way may be the element's doing alone. */
        bool loop_known = s->again && s->has_loop && s->tried == 1 && s->verdict == TUNE_WORSE;
        s->again = false;
        begin_learning(p, staged && !loop_known ? TUNE_LOOP : TUNE_DISTURBANCE);
        return;
    }
    if (!is_candidate && s->acts)
        tune_test_forget(p->test);
    /* The response to d has changed with the element. */
    if (staged && s->stage != TUNE_LOOP)
        s->anew = true;
    if (is_candidate) {
        s->verdict = TUNE_ADOPTED;
        tune_events_adopted(p->events);
        begin_tune_stage(p, TUNE_RUNS);
        s->since_tuned = 0;
    }
}

void tune_stages_gap(const struct tune_parts *p)
{
    begin_samples(p);
    if (p->stages->has_model)
        tune_shadows_begin(p->shadows, p->context);
}

/* ---- values ---- */

/* Doubt and change of a response grow with what else moves the PV and shrink with the test signal. Where there is no response at all the block
 * asks for twice as much. */
float tune_step_wanted(const struct tune_parts *p)
{
    const struct tune_settings *set = &p->context->s;
    uint8_t verdict = p->stages->verdict;
    float times = STEP_MORE_LEAST;
    if (verdict == TUNE_SLOW)
        times = (float)tune_responses_change(p->responses) * 100 / set->settled;
    else if (verdict == TUNE_UNSURE)
        times = (float)tune_search_spread(p->search) * 100 / set->confident;
    else if (verdict != TUNE_NO_MODEL && verdict != TUNE_NO_BAND)
        return 0;
    times = times > STEP_MORE_LEAST ? times : STEP_MORE_LEAST;
    return set->step * (times < STEP_MORE_MOST ? times : STEP_MORE_MOST);
}

float tune_does(const struct tune_parts *p)
{
    return p->stages->acts ? tune_improvement(p->watch, p->context) : 0;
}

enum tune_stage tune_stages_stage(const struct tune_stages *s)
{
    return (enum tune_stage)s->stage;
}

enum tune_verdict tune_stages_verdict(const struct tune_stages *s)
{
    return (enum tune_verdict)s->verdict;
}

uint32_t tune_stages_samples(const struct tune_stages *s)
{
    return s->samples;
}

unsigned tune_stages_times_off(const struct tune_stages *s)
{
    return s->tried;
}

bool tune_stages_element_acts(const struct tune_stages *s)
{
    return s->acts;
}

/* ---- test signals ---- */

static bool may_move_disturbance(const struct tune_context *c)
{
    return c->d_signal.is_mv && c->s.disturb > 0;
}

bool tune_waits_for_disturbance(const struct tune_parts *p)
{
    /* The loop is found best where the disturbance rests. But unasked, the block moves nothing that rests. */
    bool of_setpoints = learns_loop(p->stages) && !(p->stages->unasked && p->context->s.step > 0);
    return tune_disturbance_still(p->disturbance) && !of_setpoints &&
           !may_move_disturbance(p->context);
}

static void ask_test_signals(const struct tune_parts *p, struct block_io *io)
{
    const struct tune_context *c = p->context;
    uint8_t stage = p->stages->stage;
    bool of_setpoint = stage == TUNE_LOOP || (stage == TUNE_DISTURBANCE && !tune_is_staged(c));
    bool on_setpoint = c->s.step > 0 && of_setpoint && !tune_waits_for_disturbance(p);
    bool of_disturbance = stage == TUNE_DISTURBANCE || stage == TUNE_TESTS;
    tune_signals_ask(p->signals, c, io, on_setpoint, may_move_disturbance(c) && of_disturbance);
}

/* ---- work ---- */

/* The stage should learn from something that did not move. A response that does not change says nothing then. */
static enum tune_verdict stands_still_in_stage(const struct tune_parts *p)
{
    if (learns_loop(p->stages) && !tune_waits_for_disturbance(p))
        return tune_stands_still(tune_learner_loop_square(p->learner)) ? TUNE_LOOP_STILL
                                                                       : TUNE_NONE;
    return tune_stands_still(tune_learner_move_square(p->learner)) ? TUNE_STILL : TUNE_NONE;
}

static void end_tune_stage(const struct tune_parts *p)
{
    enum tune_verdict still = stands_still_in_stage(p);
    if (still != TUNE_NONE) {
        end_tuning(p, still);
    } else if (learns_loop(p->stages)) {
        p->stages->has_loop = true;
        begin_learning(p, TUNE_DISTURBANCE);
    } else if (p->stages->stage == TUNE_DISTURBANCE) {
        begin_tune_stage(p, TUNE_COMPUTES);
    }
}

static void begin_test(const struct tune_parts *p)
{
    begin_tune_stage(p, TUNE_TESTS);
    tune_candidate_begin(p->shadows, p->context, tune_sample(p->samples, SIGNAL_D));
    tune_test_begin(p->test, p->context);
}

static void take_candidate(const struct tune_parts *p)
{
    tune_shadows_take(p->shadows, tune_process_model(p->paths));
    p->stages->has_model = true;
    tune_disturbance_learnt(p->disturbance, tune_learner_move_square(p->learner));
    tune_shadows_begin(p->shadows, p->context);
    begin_test(p);
}

/* A look that fails is no end: the time of the stage decides. */
static void take_look(const struct tune_parts *p)
{
    if (tune_search_outcome(p->search) == TUNE_NONE &&
        tune_responses_settled(p->responses, p->context) &&
        p->stages->samples >= tune_samples_in(p->context, p->context->s.learn_s))
        end_tune_stage(p);
}

static void take_tuning_work(const struct tune_parts *p)
{
    enum tune_verdict outcome = tune_search_outcome(p->search);
    if (tune_search_was_look(p->search))
        take_look(p);
    else if (outcome != TUNE_NONE)
        end_tuning(p, outcome);
    else
        take_candidate(p);
}

static void ask_look(const struct tune_parts *p, bool look_only)
{
    tune_search_ask(p->search, look_only);
    tune_learner_looked(p->learner);
}

/* Neither is work under way nor does a result wait. */
static bool work_is_over(const struct tune_parts *p)
{
    return !tune_search_computes(p->search) && tune_search_is_idle(p->search);
}

/* ---- stages, a sample at a time ---- */

static void go_on_learning(const struct tune_parts *p)
{
    const struct tune_settings *set = &p->context->s;
    uint32_t wanted = tune_samples_in(p->context, set->learn_s);
    if (!work_is_over(p))
        return;
    if (p->stages->samples > 2u * wanted) {
        /* The test behind the stage finds whether it has learnt well enough. */
        if (tune_responses_change(p->responses) * 100 < UNSETTLED * set->settled ||
            stands_still_in_stage(p) != TUNE_NONE)
            end_tune_stage(p);
        else
            end_tuning(p, TUNE_SLOW);
    } else if (tune_learner_since_look(p->learner) >= wanted / LOOKS_A_STAGE) {
        ask_look(p, true);
    }
}

static void go_on_testing(const struct tune_parts *p)
{
    const struct tune_rule *rule = tune_paths_rule(p->paths);
    enum tune_verdict verdict =
        tune_test_step(p->test, p->context, p->shadows, tune_sample(p->samples, SIGNAL_D),
                       tune_learner_move_square(p->learner), p->stages->samples);
    if (verdict == TUNE_ADOPTED) {
        begin_tune_stage(p, TUNE_PROPOSES);
    } else if (verdict == TUNE_NO_BETTER && tune_search_falls_back(p->search, p->context, rule)) {
        tune_search_take_rule(p->search, rule);
        begin_test(p);
    } else if (verdict != TUNE_NONE) {
        end_tuning(p, verdict);
    }
}

static bool is_due(const struct tune_parts *p)
{
    const struct tune_context *c = p->context;
    return c->s.every_s > 0 && !tune_search_computes(p->search) &&
           p->stages->since_tuned >= tune_samples_in(c, c->s.every_s) &&
           (c->s.alone || high_order_samples(p->estimator) >= tune_samples_in(c, c->s.learn_s));
}

/* Switches the element off at once, and then identifies anew, or not. */
static void switch_off(const struct tune_parts *p, bool again)
{
    tune_silence(p->proposals);
    tune_signals_stop(p->signals);
    tune_watch_begin(p->watch);
    tune_search_cancel(p->search);
    begin_tune_stage(p, TUNE_IDLE);
    p->stages->again = again;
    p->stages->unasked = true;
}

/* The element does less than half of what was tested. Under a test signal on the setpoint nothing is watched, so that it may not act then. */
static void take_too_little(const struct tune_parts *p)
{
    const struct tune_settings *set = &p->context->s;
    float does = tune_does(p);
    bool useless = tune_is_as_alone(p->watch) || does < NO_USE;
    bool anew = tune_watch_change(p->watch);
    bool off = set->protect && (anew ? set->step > 0 : useless);
    if (!anew && !off)
        return;
    tune_events_changed(p->events, does);
    if (off && !anew) {
        p->stages->verdict = TUNE_NO_BETTER;
        tune_events_ended(p->events, TUNE_NO_BETTER);
    }
    if (off) {
        switch_off(p, anew);
    } else {
        p->stages->unasked = true;
        begin_tuning(p);
    }
}

static void go_on_running(const struct tune_parts *p)
{
    struct tune_stages *s = p->stages;
    s->since_tuned++;
    if (is_due(p)) {
        s->since_tuned = 0;
        /* In turns, as the source does it, or with the feedforward on all the time. */
        if (p->context->s.alone)
            begin_tuning(p);
        else
            begin_tune_stage(p, TUNE_COMPUTES);
    } else if (tune_does_too_little(p->watch, p->context) && tune_test_promised(p->test) > 0) {
        take_too_little(p);
    }
}

/* Protects the loop whatever stage the block is in. */
static void watch_element(const struct tune_parts *p)
{
    struct tune_stages *s = p->stages;
    if (tune_shadow_is_lost(p->shadows)) {
        tune_shadows_begin(p->shadows, p->context);
        tune_watch_begin(p->watch);
        return;
    }
    enum tune_verdict verdict = tune_watch_step(p->watch, p->context, p->shadows, p->test,
                                                tune_sample(p->samples, SIGNAL_D),
                                                tune_disturbance_still(p->disturbance) > 0);
    if (verdict != TUNE_WORSE || !p->context->s.protect || tune_off_waits(p->proposals) ||
        tune_is_silencing(p->proposals))
        return;
    tune_events_worse(p->events, -tune_does(p));
    s->tried = (uint8_t)(s->tried < 255u ? s->tried + 1u : 255u);
    s->verdict = TUNE_WORSE;
    switch_off(p, s->tried <= p->context->s.tries);
}

static void begin_model(const struct tune_parts *p)
{
    tune_learner_begin(p->learner, p->context, p->estimator, learns_loop(p->stages));
    tune_responses_begin(p->responses);
    p->stages->anew = false;
}

/* With `every` and the feedforward on all the time the block learns on behind the stages that learn. */
static bool learns_in_stage(const struct tune_parts *p)
{
    return stage_learns(p->stages) ||
           (p->context->s.every_s > 0 && !p->context->s.alone && p->stages->stage >= TUNE_COMPUTES);
}

static void go_on_with_tuning(const struct tune_parts *p)
{
    if (stage_learns(p->stages))
        go_on_learning(p);
    else if (p->stages->stage == TUNE_COMPUTES && work_is_over(p))
        ask_look(p, false);
    else if (p->stages->stage == TUNE_TESTS)
        go_on_testing(p);
    else if (p->stages->stage == TUNE_RUNS)
        go_on_running(p);
}

void tune_stages_sample(const struct tune_parts *p)
{
    struct tune_stages *s = p->stages;
    tune_disturbance_look(p->disturbance, p->context, tune_sample(p->samples, SIGNAL_D));
    s->moved = s->moved || !tune_disturbance_still(p->disturbance);
    /* A disturbance that has come to rest takes nothing of a stage's time; one that never moved is reported as still. */
    s->samples += !tune_waits_for_disturbance(p) || !s->moved;
    tune_signals_sample(p->signals);
    if (s->anew && tune_search_is_idle(p->search))
        begin_model(p);
    if (s->anew)
        return;
    if (!tune_waits_for_disturbance(p) && learns_in_stage(p))
        tune_learner_step(p->learner, p->context, p->samples, p->estimator, learns_loop(s),
                          tune_search_reads(p->search));
    bool tests = s->stage == TUNE_TESTS;
    if (s->has_model && (s->acts || tests)) {
        tune_shadows_step(p->shadows, p->context, p->samples,
                          tests ? tune_candidate(p->search) : NULL);
        if (s->acts)
            watch_element(p);
    }
    go_on_with_tuning(p);
}

/* ---- a step ---- */

void tune_stages_step(const struct tune_parts *p, struct block_io *io)
{
    tune_events_readings(p->events, io->inputs.quality[0] == QUALITY_GOOD &&
                                        io->inputs.quality[1] == QUALITY_GOOD);
    if (tune_signals_failed(p->signals, io))
        end_tuning(p, (enum tune_verdict)(TUNE_SIGNAL + io->requests.excite_reason));
    if (tune_search_step(p->search, p->context, io))
        take_tuning_work(p);
    if (tune_samples_take(p->samples, p->context, io, tune_learner_move_square(p->learner)))
        tune_stages_sample(p);
    ask_test_signals(p, io);
    if (!tune_propose(p->proposals, p->context, io, tune_stages_stage(p->stages),
                      tune_candidate(p->search), tune_since_disturbance(p->samples)))
        end_tuning(p, TUNE_REJECTED);
}

/* ---- verbs ---- */

static bool is_at_rest(const struct tune_stages *s)
{
    return s->stage == TUNE_IDLE || s->stage == TUNE_RUNS;
}

const char *tune_stages_tune(const struct tune_parts *p)
{
    if (!is_at_rest(p->stages))
        return "runs";
    forget_tries(p);
    begin_tuning(p);
    return NULL;
}

const char *tune_stages_stop(const struct tune_parts *p)
{
    if (is_at_rest(p->stages))
        return "runs_not";
    tune_search_cancel(p->search);
    end_tuning(p, TUNE_STOPPED);
    return NULL;
}
