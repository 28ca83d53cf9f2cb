#include "commission/adoption.h"

#include "base/assertion.h"
#include "commission/adoption_state.h"
#include "commission/margin_probe.h"
#include "commission/swing.h"
#include "commission/trial_line.h"
#include "commission/trial_step.h"

#include <string.h>

enum stage {
    STAGE_REST,   /* all in manual, outputs held: lines of rest */
    STAGE_SETTLE, /* all in automatic, nothing asked yet */
    STAGE_STEP,   /* setpoint of loop `at` away */
    STAGE_RETURN  /* and back; also the end, where the others are looked at */
};

#define NOISE_MULTIPLE REAL_C(4.0)
#define AUTO_TICKS     3u /* until a requested mode is in force */
#define LISTEN_TICK    2u /* in which inner loops follow; the first may be that of the beginning */
#define DRIFT_MOST     REAL_C(0.5) /* largest share of a limit by which setpoints follow a drift */
#define PATIENCE       3u          /* further windows where the line is bent */
#define MOVED_LEAST    REAL_C(1e-5)

static void ask(struct supervisor *s, uint8_t i, enum loop_mode mode)
{
    struct request r = {.kind = REQUEST_MODE,
                        .loop = i,
                        .output = PLAN_NONE,
                        .mode = (uint8_t)mode,
                        .plan = s->plan->serial};
    supervisor_request(s, &r);
}

static real_t measured(const struct adoption *a, const struct supervisor *s, uint8_t k)
{
    REFLUX_ASSERT(k < a->channels);
    return num_to_float(s->measurement[a->channel[k].measurement].value);
}

/* Returns the manipulated variable of a loop; PLAN_NONE: it drives another loop. */
static uint8_t output_of(const struct adoption *a, const struct supervisor *s, uint8_t k)
{
    REFLUX_ASSERT(k < a->n + a->n_inner && a->loop[k].loop < CONFIG_LOOPS);
    return s->plan->loop[a->loop[k].loop].mv;
}

static uint8_t all_loops(const struct adoption *a)
{
    return (uint8_t)(a->n + a->n_inner);
}

static uint32_t longest(const struct adoption *a, const struct supervisor *s)
{
    uint32_t most = 0;
    for (uint8_t k = 0; k < a->n; k++) {
        uint32_t d = adoption_step_samples(&a->loop[k], s->plan->tick_s);
        most = d > most ? d : most;
    }
    return most;
}

static void enter_stage(struct adoption *a, enum stage stage, uint32_t ticks)
{
    a->stage = (uint8_t)stage;
    margin_probe_enter(&a->probe, stage == STAGE_REST, stage == STAGE_RETURN);
    a->ticks = 0;
    a->stage_ticks = ticks;
    trial_step_begin(&a->trial_step);
}

void adoption_hold(struct adoption *a, const struct supervisor *s)
{
    for (uint8_t k = 0; k < all_loops(a); k++)
        if (output_of(a, s, k) != PLAN_NONE)
            a->loop[k].test_base = num_to_float(s->mv[output_of(a, s, k)].manual);
}

void adoption_put_back(const struct adoption *a, struct supervisor *s, bool but_hand)
{
    for (uint8_t k = 0; k < all_loops(a); k++) {
        uint8_t i = a->loop[k].loop, j = output_of(a, s, k);
        if (but_hand && s->loop[i].mode == LOOP_MANUAL)
            continue;
        ask(s, i, LOOP_MANUAL);
        if (j != PLAN_NONE)
            s->mv[j].manual = num_from_float(a->loop[k].test_base);
    }
}

/* Number of samples of a rest, in whole blocks. */
static uint32_t rest_ticks(const struct adoption *a)
{
    return a->window / STEADY_BLOCKS * STEADY_BLOCKS;
}

enum err adoption_begin(struct adoption *a, const struct supervisor *s, struct origin *origin,
                        struct steady *work)
{
    struct steady_config c = {.outputs = a->channels,
                              .block = a->window / STEADY_BLOCKS,
                              .h_s = s->plan->tick_s,
                              .noise_floor = REAL_C(1e-6),
                              .motion_limit = REAL_C(3.0),
                              .variance_limit = REAL_C(4.0)};
    a->origin = origin;
    a->steady = work;
    a->result = a->doubt = ADOPTION_RUNNING;
    a->turn = a->culprit = a->repeats = 0;
    a->drifting = a->placed = false;
    margin_probe_repeat(&a->probe, false);
    a->since = 0;
    a->patience = PATIENCE;
    for (uint8_t k = 0; k < a->n; k++)
        a->loop[k].iae = a->loop[k].peak = REAL_C(0.0);
    enter_stage(a, STAGE_REST, rest_ticks(a));
    return steady_init(work, &c);
}

static enum adoption_result fail_trial(struct adoption *a, enum adoption_result reason, uint8_t k)
{
    a->culprit = k;
    a->result = reason;
    return reason;
}

/* ---- at rest ---- */

/* Returns the channel of a loop; those of inner loops come after those of the pairs. */
static uint8_t channel_of(const struct adoption *a, const struct supervisor *s, uint8_t k)
{
    uint8_t at = k < a->n ? k : a->n;
    while (k >= a->n && at + 1u < a->channels &&
           a->channel[at].measurement != s->plan->loop[a->loop[k].loop].pv)
        at++;
    return at;
}

/* Time since the lines were fitted, s. */
static real_t age_s(const struct adoption *a, const struct supervisor *s)
{
    return (real_t)a->since * s->plan->tick_s;
}

/* At the end of a rest after a doubtful step: measurement k did not stay on its line. */
static bool has_bent(const struct adoption *a, const struct supervisor *s, uint8_t k,
                     const struct steady_result *now)
{
    REFLUX_ASSERT(k < a->channels && a->turn < a->n);
    const struct adoption_loop *loop = &a->loop[a->turn];
    return trial_line_has_bent(&a->channel[k].line, now, age_s(a, s), loop->step, loop->duration_s);
}

/* Takes a new line for the measurement. */
static void take_line(struct adoption *a, const struct supervisor *s, uint8_t k,
                      const struct steady_result *now)
{
    REFLUX_ASSERT(k < a->channels);
    real_t most = (real_t)longest(a, s) * s->plan->tick_s, least = INFINITY;
    for (uint8_t i = 0; i < a->n; i++)
        if (real_abs(a->loop[i].step) < least)
            least = real_abs(a->loop[i].step);
    trial_line_take(&a->channel[k].line, now, most, least);
    if (trial_line_drifts(&a->channel[k].line))
        a->drifting = true;
}

/* A measurement follows no straight line. Then the rest is repeated a few times, because such a line predicts nothing. */
static bool is_restless(const struct adoption *a)
{
    for (uint8_t k = 0; k < a->channels; k++) {
        struct steady_result now;
        if (steady_look(a->steady, k, &now) == ERR_OK && now.state == STEADY_RESTLESS)
            return true;
    }
    return false;
}

/* Deviation that the tests and the steps before have left on channel k. */
static real_t left_of(const struct adoption *a, uint8_t k)
{
    return real_abs(origin_left(a->origin, a->channel[k].output));
}

static enum adoption_result end_rest(struct adoption *a, struct supervisor *s)
{
    if (a->patience > 0 && is_restless(a)) {
        a->patience--;
        a->stage_ticks += rest_ticks(a);
        return ADOPTION_RUNNING;
    }
    bool bent = false;
    for (uint8_t k = 0; k < a->channels; k++) {
        struct steady_result now;
        if (steady_look(a->steady, k, &now) != ERR_OK)
            return fail_trial(a, ADOPTION_RESTLESS, k);
        if (a->doubt != ADOPTION_RUNNING && has_bent(a, s, k, &now))
            bent = true;
        take_line(a, s, k, &now);
        origin_take(a->origin, a->channel[k].output, &now, trial_line_rest(&a->channel[k].line));
        if (origin_spent(a->origin, a->channel[k].output, a->channel[k].limit) > REAL_C(1.0))
            return fail_trial(a, ADOPTION_LEFT, k);
    }
    origin_taken(a->origin);
    a->since = 0;
    if (a->doubt != ADOPTION_RUNNING) {
        if (!bent || a->repeats >= ADOPTION_REPEATS)
            return fail_trial(a, a->doubt, a->turn);
        a->repeats++;
        a->drifting = true;
        /* Where the margin is in doubt the step has passed, and only its way back is in doubt. */
        margin_probe_repeat(&a->probe, a->doubt == ADOPTION_MARGIN);
        a->doubt = ADOPTION_RUNNING;
    }
    for (uint8_t k = 0; k < a->n; k++)
        ask(s, a->loop[k].loop, LOOP_AUTO);
    a->placed = false;
    bool brief = a->drifting && a->turn < a->n;
    enter_stage(a, STAGE_SETTLE, (brief ? 0u : longest(a, s) / 4u) + AUTO_TICKS);
    return ADOPTION_RUNNING;
}

static void rest_again(struct adoption *a, struct supervisor *s)
{
    adoption_put_back(a, s, false);
    steady_reset(a->steady);
    a->patience = PATIENCE;
    enter_stage(a, STAGE_REST, a->back + rest_ticks(a));
}

static enum adoption_result rest(struct adoption *a, struct supervisor *s)
{
    for (uint8_t k = 0; a->ticks > AUTO_TICKS && k < all_loops(a); k++) {
        uint8_t j = output_of(a, s, k);
        real_t moved =
            j == PLAN_NONE ? REAL_C(0.0) : num_to_float(s->mv[j].manual) - a->loop[k].test_base;
        if (s->loop[a->loop[k].loop].mode != LOOP_MANUAL || real_abs(moved) > MOVED_LEAST)
            return fail_trial(a, ADOPTION_HAND, channel_of(a, s, k));
    }
    bool first = a->patience == PATIENCE && a->ticks + rest_ticks(a) <= a->stage_ticks;
    if (!first) { /* the response to what was before is over */
        real_t y[CHANNEL_MAX];
        for (uint8_t k = 0; k < a->channels; k++)
            y[k] = measured(a, s, k);
        if (steady_step(a->steady, y) != ERR_OK)
            return fail_trial(a, ADOPTION_RESTLESS, 0);
    }
    return a->ticks < a->stage_ticks ? ADOPTION_RUNNING : end_rest(a, s);
}

/* ---- in automatic ---- */

/* Distance that channel k has drifted since the line was fitted. */
static real_t carried(const struct adoption *a, const struct supervisor *s, uint8_t k)
{
    REFLUX_ASSERT(k < a->channels);
    const struct adoption_channel *c = &a->channel[k];
    return trial_line_carried(&c->line, age_s(a, s), DRIFT_MOST * c->limit);
}

/* Inner loops follow a tick later than the others, because outer loops, which may be new, must first have followed the inner
 * measurements. */
static void listen(const struct adoption *a, struct supervisor *s)
{
    for (uint8_t k = a->n; k < all_loops(a); k++)
        ask(s, a->loop[k].loop, LOOP_CASCADE);
}

/* Checks that every loop acts, that nobody has intervened, and that no measurement is past its limit. */
static enum adoption_result watch_trial(struct adoption *a, const struct supervisor *s)
{
    bool early = a->stage == STAGE_SETTLE && a->ticks < AUTO_TICKS;
    for (uint8_t k = 0; k < all_loops(a) && !early; k++) {
        const struct loop_state *l = &s->loop[a->loop[k].loop];
        bool outer = k < a->n;
        if (l->mode != (outer ? LOOP_AUTO : LOOP_CASCADE) ||
            (outer && a->placed && real_abs(num_to_float(l->target) - a->asked[k]) > MOVED_LEAST))
            return fail_trial(a, ADOPTION_HAND, channel_of(a, s, k));
    }
    for (uint8_t k = 0; k < a->channels; k++) {
        const struct adoption_channel *c = &a->channel[k];
        real_t away =
            steady_away(measured(a, s, k) - trial_line_rest(&c->line), carried(a, s, k), c->limit);
        if (real_abs(away) > c->limit - left_of(a, k) + NOISE_MULTIPLE * c->noise_sd)
            return fail_trial(a, ADOPTION_PAST_LIMIT, k);
    }
    return ADOPTION_RUNNING;
}

static real_t within_setpoint_limits(const struct supervisor *s, uint8_t i, real_t at)
{
    const struct measurement_config *m = &s->plan->config.measurement[s->plan->loop[i].pv];
    float lo, hi;
    plan_setpoint_limits(s->plan, i, &lo, &hi);
    real_t least = (lo - m->lo) / (m->hi - m->lo), most = (hi - m->lo) / (m->hi - m->lo);
    return real_clamp(at, least, most);
}

/* Setpoints follow the drift; that of the loop under trial is a step away from it. */
static void place_setpoints(struct adoption *a, struct supervisor *s)
{
    for (uint8_t k = 0; k < a->n; k++)
        if (s->loop[a->loop[k].loop].mode != LOOP_AUTO)
            return; /* not there yet */
    for (uint8_t k = 0; k < a->n; k++) {
        struct loop_state *l = &s->loop[a->loop[k].loop];
        real_t at = trial_line_rest(&a->channel[k].line) + carried(a, s, k);
        if (k == a->turn && a->stage == STAGE_STEP)
            at += a->loop[k].step;
        l->target = num_from_float(within_setpoint_limits(s, a->loop[k].loop, at));
        l->sp_given = true;
        a->asked[k] = num_to_float(l->target);
    }
    a->placed = true;
}

static void say_setpoint(const struct adoption *a, const struct supervisor *s)
{
    const struct config *config = &s->plan->config;
    const struct measurement_config *m = &config->measurement[a->channel[a->turn].measurement];
    event_put(s->events, s->time_ms, EVENT_SETPOINT, config->loop[a->loop[a->turn].loop].name,
              m->lo + a->asked[a->turn] * (m->hi - m->lo), 0);
}

static void begin_stage(struct adoption *a, struct supervisor *s, enum stage stage)
{
    REFLUX_ASSERT(a->turn < a->n);
    enter_stage(a, stage, adoption_step_samples(&a->loop[a->turn], s->plan->tick_s));
    if (stage == STAGE_STEP && !margin_probe_repeats(&a->probe))
        a->loop[a->turn].iae = a->loop[a->turn].peak = REAL_C(0.0);
    place_setpoints(a, s);
    say_setpoint(a, s);
}

static real_t setpoint_error(const struct adoption *a, const struct supervisor *s)
{
    REFLUX_ASSERT(a->turn < a->n);
    return a->asked[a->turn] - measured(a, s, a->turn);
}

static void look_at_step(struct adoption *a, const struct supervisor *s)
{
    for (uint8_t k = 0; k < all_loops(a); k++)
        if (output_of(a, s, k) != PLAN_NONE)
            trial_step_watch_output(&a->trial_step, s, k, output_of(a, s, k));
    bool ends = a->ticks > a->stage_ticks - a->stage_ticks / 4u;
    if (margin_probe_repeats(&a->probe))
        trial_step_rest(&a->trial_step, setpoint_error(a, s), ends);
    else
        trial_step_sample(&a->trial_step, &a->loop[a->turn], setpoint_error(a, s), s->plan->tick_s,
                          ends);
}

/* The verdict on a step there or back with the raised gain. */
static enum adoption_result verdict_of_probe(const struct adoption *a)
{
    REFLUX_ASSERT(a->turn < a->n);
    real_t step = a->loop[a->turn].step, direction = a->stage == STAGE_RETURN ? -step : step;
    bool fails = trial_step_swings(&a->trial_step) ||
                 margin_probe_is_restless(&a->probe, &a->trial_step, &a->loop[a->turn],
                                          &a->channel[a->turn], a->turn, direction);
    return fails ? ADOPTION_MARGIN : ADOPTION_RUNNING;
}

/* Steps the next loop, or ends the trial. */
static enum adoption_result next_turn(struct adoption *a, struct supervisor *s)
{
    if (a->turn < a->n) {
        begin_stage(a, s, STAGE_STEP);
        return ADOPTION_RUNNING;
    }
    a->result = ADOPTION_PASSED;
    return ADOPTION_PASSED;
}

static enum adoption_result end_step(struct adoption *a, struct supervisor *s)
{
    REFLUX_ASSERT(a->turn < a->n);
    if (margin_probe_repeats(&a->probe))
        a->doubt = verdict_of_probe(a);
    else
        a->doubt = trial_step_verdict(&a->trial_step, &a->loop[a->turn], &a->channel[a->turn],
                                      all_loops(a), a->stage_ticks, s->plan->tick_s);
    margin_probe_repeat(&a->probe, false);
    if (a->doubt == ADOPTION_RUNNING && !a->drifting) {
        begin_stage(a, s, STAGE_RETURN);
        return ADOPTION_RUNNING;
    }
    if (a->doubt == ADOPTION_RUNNING)
        a->turn++;
    rest_again(a, s);
    return ADOPTION_RUNNING;
}

/* Raises the gain just before the way back, because the controller has to make the setpoint's step with it. A plant that drifts has
 * no way back. */
static void raise_in_time(struct adoption *a, const struct supervisor *s)
{
    REFLUX_ASSERT(a->turn < a->n);
    uint32_t turn = s->plan->config.loop[a->loop[a->turn].loop].divisor;
    if (!a->drifting && a->ticks + turn >= a->stage_ticks)
        margin_probe_raise(&a->probe, a->turn);
}

static enum adoption_result end_return(struct adoption *a, struct supervisor *s)
{
    REFLUX_ASSERT(a->turn < a->n);
    if (margin_probe_is_raised(&a->probe))
        a->doubt = verdict_of_probe(a);
    else if (trial_step_swings(&a->trial_step))
        a->doubt = ADOPTION_SWINGS;
    if (a->doubt != ADOPTION_RUNNING) {
        rest_again(a, s);
        return ADOPTION_RUNNING;
    }
    a->turn++;
    return next_turn(a, s);
}

/* A stage ends after its time; with a raised gain at the first sign, because the gain must go back to normal. */
static bool is_over(const struct adoption *a)
{
    bool probes = margin_probe_repeats(&a->probe) || a->stage == STAGE_RETURN;
    return a->ticks >= a->stage_ticks ||
           (probes && margin_probe_is_raised(&a->probe) && trial_step_swings(&a->trial_step));
}

static enum adoption_result end_stage(struct adoption *a, struct supervisor *s)
{
    if (a->stage == STAGE_STEP)
        return end_step(a, s);
    return a->stage == STAGE_RETURN ? end_return(a, s) : next_turn(a, s);
}

enum adoption_result adoption_tick(struct adoption *a, struct supervisor *s)
{
    a->ticks++;
    a->since++;
    origin_grow_older(a->origin, s->plan->tick_s);
    if (a->stage == STAGE_REST)
        return rest(a, s);
    if (a->stage == STAGE_SETTLE && a->ticks == LISTEN_TICK)
        listen(a, s);
    enum adoption_result r = watch_trial(a, s);
    if (r == ADOPTION_PAST_LIMIT && margin_probe_is_raised(&a->probe) && a->culprit == a->turn)
        return fail_trial(a, ADOPTION_MARGIN, a->turn);
    if (r != ADOPTION_RUNNING)
        return r;
    if (a->stage == STAGE_STEP)
        look_at_step(a, s);
    if (a->stage == STAGE_STEP || a->stage == STAGE_RETURN)
        trial_step_swing(&a->trial_step, &a->loop[a->turn], &a->channel[a->turn],
                         setpoint_error(a, s),
                         margin_probe_is_raised(&a->probe) ? &swing_raised : &swing_accepted,
                         a->ticks >= a->stage_ticks);
    if (a->stage == STAGE_RETURN)
        trial_step_rest(&a->trial_step, setpoint_error(a, s),
                        a->ticks > a->stage_ticks - a->stage_ticks / 4u);
    if (is_over(a))
        return end_stage(a, s);
    if (a->stage == STAGE_STEP)
        raise_in_time(a, s);
    place_setpoints(a, s);
    return ADOPTION_RUNNING;
}

/* ---- for preparing and showing it ---- */

void adoption_prepare(struct adoption *a, uint32_t window, uint32_t back)
{
    memset(a, 0, sizeof *a);
    a->window = window;
    a->back = back;
}

void adoption_add_channel(struct adoption *a, const struct adoption_channel *channel)
{
    REFLUX_ASSERT(a->channels < CHANNEL_MAX);
    a->channel[a->channels++] = *channel;
}

enum err adoption_add_loop(struct adoption *a, const struct adoption_loop *loop, bool inner)
{
    if (all_loops(a) >= CONFIG_LOOPS)
        return ERR_FULL;
    a->loop[all_loops(a)] = *loop;
    if (inner)
        a->n_inner++;
    else
        a->n++;
    return ERR_OK;
}

const char *adoption_culprit(const struct adoption *a, const struct config *config, real_t *peak)
{
    REFLUX_ASSERT(a->culprit < a->n || a->culprit < a->channels);
    bool has_loop = a->culprit < a->n;
    *peak = has_loop ? a->loop[a->culprit].peak : REAL_C(0.0);
    return has_loop ? config->loop[a->loop[a->culprit].loop].name
                    : config->measurement[a->channel[a->culprit].measurement].name;
}
