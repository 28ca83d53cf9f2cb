#include "commission/experiment.h"

#include "base/assertion.h"
#include "commission/experiment_check.h"
#include "commission/experiment_state.h"
#include "commission/limits.h"
#include "commission/origin.h"
#include "commission/progress.h"
#include "commission/sensor_watch.h"

#include <string.h>

#define MOTION_LIMIT   REAL_C(3.0) /* noise standard deviations over the window */
#define VARIANCE_LIMIT REAL_C(4.0)
#define STEP_SD        REAL_C(0.2887) /* standard deviation of a value within a step of 1 */
/* Standard deviations of a slope before the step from which it is a drift. */
#define DRIFT_SDS     REAL_C(2.0)
#define TAIL_WAITS    2u /* factor for the wait for rest where nothing drifted before the step */
#define FIRST_WATCH   4u /* windows of rest before the first test where noise hides a drift */
#define FIRST_SAMPLES REAL_C(1000.0) /* samples of a test, for the next bound */
/* Share of a limit that the error of the slope may carry in them. */
#define FIRST_SHARE REAL_C(0.01)
#define BACK_SHARE  REAL_C(0.25) /* of a limit, distance from rest after a pause */
#define PATIENCE    20u          /* windows before the test gives up waiting for rest */
#define REST_HALF   1000u        /* samples beyond them, or the longest half where that is less */

static enum err watch_rest(struct experiment *e, uint32_t window)
{
    struct steady_config c = {.outputs = e->config.outputs,
                              .block = window / STEADY_BLOCKS ? window / STEADY_BLOCKS : 1u,
                              .h_s = e->config.h_s,
                              .noise_floor = e->config.noise_floor,
                              .motion_limit = MOTION_LIMIT,
                              .variance_limit = VARIANCE_LIMIT};
    return steady_init(&e->steady, &c);
}

enum err experiment_begin(struct experiment *e, const struct experiment_config *c)
{
    memset(e, 0, sizeof *e);
    enum err err = double_step_check(c);
    if (err)
        return err;
    e->config = *c;
    e->phase = EXPERIMENT_REST;
    struct moments_config m = {
        .outputs = c->outputs, .h_s = c->h_s, .fastest = MOMENTS_FASTEST, .ratio = MOMENTS_RATIO};
    m.alphas = moments_alphas_for(c->h_s, c->h_s * (real_t)c->half_most);
    err = moments_init(&e->moments, &m);
    if (!err)
        err = record_init(&e->record, c->outputs, c->h_s);
    return err ? err : watch_rest(e, c->window);
}

static void enter_phase(struct experiment *e, enum experiment_phase phase, real_t level)
{
    e->phase = phase;
    e->level = level;
    e->waited = 0;
}

static void fail_test(struct experiment *e, enum experiment_failure failure, uint8_t culprit)
{
    enter_phase(e, EXPERIMENT_FAILED, REAL_C(0.0));
    e->failure = failure;
    e->culprit = culprit;
}

static enum err move(struct experiment *e, real_t level)
{
    e->level = level;
    return record_move(&e->record, level);
}

void experiment_know_sensor(struct experiment *e, uint8_t j, real_t step, unsigned renewal)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    e->coarse_sd[j] = step * STEP_SD;
    e->renewal[j] = (uint8_t)renewal;
    if (e->before[j].noise_sd > REAL_C(0.0) && e->before[j].noise_sd < e->coarse_sd[j])
        e->before[j].noise_sd = e->coarse_sd[j];
}

/* Every output is at rest. One that climbs steadily for longer than the patience drifts: the drift is then known and taken
 * off, unless it would use a good part of the limit. */
static bool all_at_rest(struct experiment *e, struct steady_result *at, uint32_t patience,
                        uint8_t *culprit)
{
    bool rest = true;
    for (uint8_t j = 0; j < e->config.outputs; j++) {
        if (steady_look(&e->steady, j, &at[j]) != ERR_OK)
            return false;
        sensor_allow(&at[j], e->renewal[j], e->coarse_sd[j], VARIANCE_LIMIT);
        if (at[j].state == STEADY_SETTLED)
            continue;
        real_t carried = real_abs(at[j].slope_per_s) * e->config.h_s * (real_t)e->config.window;
        /* With little noise and no drift before the step, a slope after it is the end of the response. */
        bool tail = e->phase == EXPERIMENT_BACK && !progress_is_noisy(e) &&
                    !(real_abs(e->drift_per_s[j]) > REAL_C(0.0));
        if (at[j].state == STEADY_MOVING &&
            e->waited >= (tail ? TAIL_WAITS * patience : patience) &&
            carried < e->config.limit[j] * REAL_C(0.3))
            continue;
        if (rest)
            *culprit = j;
        rest = false;
    }
    return rest;
}

static real_t sure_drift(const struct steady_result *at)
{
    bool drifts = real_abs(at->slope_per_s) > DRIFT_SDS * at->slope_sd_per_s;
    return drifts ? at->slope_per_s : REAL_C(0.0);
}

static void take_origin(struct experiment *e, const struct steady_result *rest, const real_t *level)
{
    if (!e->config.origin)
        return;
    for (uint8_t j = 0; j < e->config.outputs; j++)
        origin_take(e->config.origin, j, &rest[j], level[j]);
    origin_taken(e->config.origin);
}

static enum err begin_step(struct experiment *e, const real_t *y)
{
    const struct experiment_config *c = &e->config;
    for (unsigned j = 0; j < c->outputs; j++) {
        const struct steady_result *b = &e->before[j];
        e->drift_per_s[j] = sure_drift(b);
        e->rest[j] = b->mean + e->drift_per_s[j] * b->age_s;
    }
    take_origin(e, e->before, e->rest);
    int spent = limits_spent(e);
    if (spent >= 0) {
        fail_test(e, EXPERIMENT_LEFT, (uint8_t)spent);
        return ERR_OK;
    }
    enum err err = moments_begin(&e->moments, e->rest);
    if (!err)
        err = record_begin(&e->record, e->rest);
    if (!err)
        err = moments_step(&e->moments, y);
    if (!err)
        err = record_step(&e->record, y);
    if (!err)
        err = limits_arm(e, y);
    if (!err)
        err = limits_see(e, y);
    if (err)
        return err;
    e->amplitude = c->amplitude > REAL_C(0.0) ? c->amplitude : limits_first_step(e);
    if (e->amplitude > c->amplitude_max)
        e->amplitude = c->amplitude_max;
    enter_phase(e, EXPERIMENT_UP, REAL_C(0.0));
    e->half = 0;
    e->samples = 1;
    return move(e, e->amplitude);
}

/* The slope before the first test must be known well, because it distinguishes drift from deviations of the tests until the
 * end. */
static bool slope_matters(const struct experiment *e)
{
    const struct origin *o = e->config.origin;
    for (uint8_t j = 0; o && !origin_is_fixed(o) && j < e->config.outputs; j++) {
        real_t carries = e->before[j].slope_sd_per_s * e->config.h_s * FIRST_SAMPLES;
        if (carries > FIRST_SHARE * e->config.limit[j])
            return true;
    }
    return false;
}

static enum err outputs_at_rest(struct experiment *e, const real_t *y)
{
    uint8_t culprit = 0;
    enum err err = steady_step(&e->steady, y);
    if (err)
        return err;
    e->waited++;
    int strayed = limits_strayed(e, y);
    if (strayed >= 0) {
        fail_test(e, EXPERIMENT_LEFT, (uint8_t)strayed);
        return ERR_OK;
    }
    if (all_at_rest(e, e->before, e->config.window + e->config.window / 2u, &culprit)) {
        if (e->watched || !slope_matters(e))
            return begin_step(e, y);
        e->watched = true;
        for (uint8_t j = 0; j < e->config.outputs; j++)
            origin_look(e->config.origin, j, &e->before[j]);
        return watch_rest(e, FIRST_WATCH * e->config.window);
    }
    uint32_t half = e->config.half_most < REST_HALF ? e->config.half_most : REST_HALF;
    if (e->waited > PATIENCE * e->config.window + half)
        fail_test(e, EXPERIMENT_RESTLESS, culprit);
    return ERR_OK;
}

static enum err turn_down(struct experiment *e, const real_t *y)
{
    for (uint8_t j = 0; j < e->config.outputs; j++)
        e->at_turn[j] = limits_away(e, j, y);
    enter_phase(e, EXPERIMENT_DOWN, e->level);
    return move(e, -e->amplitude);
}

static enum err go_back(struct experiment *e)
{
    enter_phase(e, EXPERIMENT_BACK, e->level);
    uint32_t third = e->half / 3u; /* a window that sees the slowest response */
    enum err err = watch_rest(e, third > e->config.window ? third : e->config.window);
    return err ? err : move(e, REAL_C(0.0));
}

/* Goes back to 0 before the negative half, because nobody knows yet how far a reversal takes the outputs. */
static enum err pause_step(struct experiment *e)
{
    e->pausing = true;
    return go_back(e);
}

/* After the pause: the negative half is the mirror image of the positive one. It is left out where a smaller step follows and
 * the outputs have come back. */
static enum err end_pause(struct experiment *e, const real_t *y)
{
    bool back = e->config.repeats;
    for (uint8_t j = 0; j < e->config.outputs; j++) {
        e->at_turn[j] = REAL_C(0.0);
        if (real_abs(limits_away(e, j, y)) > BACK_SHARE * e->config.limit[j])
            back = false;
    }
    e->pausing = false;
    e->one_sided = back;
    if (back)
        return ERR_OK;
    enter_phase(e, EXPERIMENT_DOWN, e->level);
    return move(e, -e->amplitude);
}

void experiment_baseline_before(const struct experiment *e, uint8_t j, struct baseline *b)
{
    REFLUX_ASSERT(j < e->config.outputs);
    const struct steady_result *at = &e->before[j];
    real_t turned = at->slope_sd_per_s * at->age_s;
    *b = (struct baseline){.offset = at->mean + at->slope_per_s * at->age_s - e->rest[j],
                           .slope_per_s = at->slope_per_s,
                           .offset_sd = real_sqrt(at->mean_sd * at->mean_sd + turned * turned),
                           .slope_sd_per_s = at->slope_sd_per_s,
                           .noise_sd = at->noise_sd};
}

static void ask_for_look(struct experiment *e)
{
    struct baseline b[CHANNEL_MAX];
    if (e->interim_fitting || e->samples < e->next_interim_fit ||
        e->record.points < FOPDT_FIT_POINTS_MIN)
        return;
    for (uint8_t j = 0; j < e->config.outputs; j++)
        experiment_baseline_before(e, j, &b[j]);
    interim_fit_begin(&e->interim_fit, &e->record, b);
    e->interim_fitting = true;
    e->next_interim_fit = e->samples + e->half / 8u + 1u;
}

void experiment_take_interim_fit(struct experiment *e)
{
    e->interim_fitting = false;
    e->interim_fitted = true;
    e->fresh = e->phase == EXPERIMENT_UP;
}

static enum err grow(struct experiment *e, const real_t *y, real_t amplitude)
{
    limits_step_grows(e, y, amplitude);
    e->amplitude = amplitude;
    e->half = 0;
    enum err err = limits_arm(e, y);
    if (!err)
        err = limits_see(e, y);
    return err ? err : move(e, amplitude);
}

static enum err going_up(struct experiment *e, const real_t *y)
{
    const struct experiment_config *c = &e->config;
    enum err err;
    e->half++;
    enum limits_verdict verdict;
    struct limits_peak peak;
    limits_watch(e, y);
    err = limits_judge(e, y, &verdict, &peak);
    if (err)
        return err;
    if (verdict != LIMITS_FINE) {
        e->culprit = peak.output;
        e->predicted = peak.predicted;
        e->cut = true;
        bool turns = verdict == LIMITS_TURN && limits_response_is_seen(e);
        return turns ? turn_down(e, y) : pause_step(e);
    }
    if (c->half > 0 && e->half >= c->half)
        return turn_down(e, y);
    if (e->half >= c->half_most) {
        e->at_longest = true;
        return turn_down(e, y);
    }
    if (e->fresh && c->half == 0) {
        e->fresh = false;
        struct progress_advice advice = progress_judge(e, y);
        e->small = advice.small;
        if (advice.verdict == PROGRESS_TURN)
            return turn_down(e, y);
        if (advice.verdict == PROGRESS_GROW)
            err = grow(e, y, advice.amplitude);
    }
    if (!err && e->phase == EXPERIMENT_UP)
        ask_for_look(e);
    return err;
}

static enum err going_down(struct experiment *e, const real_t *y)
{
    e->waited++;
    if (e->waited < e->half && !limits_far_enough(e, y))
        return ERR_OK;
    return go_back(e);
}

static enum err coming_back(struct experiment *e, const real_t *y)
{
    uint8_t culprit = 0;
    e->waited++;
    enum err err = steady_step(&e->steady, y);
    if (err)
        return err;
    bool rest = all_at_rest(e, e->after,
                            e->half + (progress_is_noisy(e) ? 0 : e->half / 2u) + e->config.window,
                            &culprit);
    /* Not before the negative half has lasted as long: during dead time everything seems at rest. */
    rest = rest && e->waited >= e->half;
    bool late = e->waited > 4u * e->half + 8u * e->config.window;
    if (e->pausing && (rest || late)) {
        err = end_pause(e, y);
        if (e->phase != EXPERIMENT_BACK)
            return err;
    }
    if (rest) {
        real_t level[CHANNEL_MAX] = {REAL_C(0.0)};
        for (unsigned j = 0; j < e->config.outputs; j++) {
            real_t drift = sure_drift(&e->after[j]);
            level[j] = e->after[j].mean + drift * e->after[j].age_s;
        }
        take_origin(e, e->after, level);
        e->returned = true;
        enter_phase(e, EXPERIMENT_DONE, REAL_C(0.0));
    } else if (late) {
        /* The output is far from its rest and does not return. */
        for (uint8_t j = 0; j < e->config.outputs; j++)
            if (real_abs(limits_away(e, j, y)) > REAL_C(0.8) * e->config.limit[j])
                culprit = j;
        if (real_abs(limits_away(e, culprit, y)) > REAL_C(0.8) * e->config.limit[culprit])
            fail_test(e, EXPERIMENT_AWAY, culprit);
        else
            enter_phase(e, EXPERIMENT_DONE, REAL_C(0.0));
    }
    return ERR_OK;
}

/* Feeds moments and record, after the first edge. */
static enum err keep_sample(struct experiment *e, const real_t *y)
{
    enum err err = moments_step(&e->moments, y);
    if (!err)
        err = record_step(&e->record, y);
    e->samples += err == ERR_OK;
    return err;
}

static void grow_older(struct experiment *e)
{
    if (e->config.origin)
        origin_grow_older(e->config.origin, e->config.h_s);
}

enum err experiment_missed(struct experiment *e)
{
    if (!e->begun || e->phase >= EXPERIMENT_DONE)
        return ERR_STATE;
    grow_older(e);
    e->waited++;
    if (e->phase == EXPERIMENT_REST)
        return steady_step(&e->steady, e->last);
    enum err err = keep_sample(e, e->last);
    if (err)
        return err;
    if (e->phase == EXPERIMENT_UP) {
        e->half++;
        return limits_see(e, e->last);
    }
    return e->phase == EXPERIMENT_BACK ? steady_step(&e->steady, e->last) : ERR_OK;
}

/* Takes a sample while e->last is still the one before. */
static enum err take_sample_in(struct experiment *e, const real_t *y)
{
    e->begun = true;
    grow_older(e);
    if (e->phase == EXPERIMENT_REST)
        return outputs_at_rest(e, y);
    if (e->phase >= EXPERIMENT_DONE)
        return ERR_STATE;
    int past = limits_past(e, y);
    if (past >= 0) {
        fail_test(e, EXPERIMENT_LIMIT, (uint8_t)past);
        return ERR_OK;
    }
    enum err err = keep_sample(e, y);
    if (err)
        return err;
    switch (e->phase) {
    case EXPERIMENT_UP:
        return going_up(e, y);
    case EXPERIMENT_DOWN:
        return going_down(e, y);
    case EXPERIMENT_BACK:
        return coming_back(e, y);
    default:
        REFLUX_ASSERT(false); /* rest and the end are dealt with above */
        return ERR_STATE;
    }
}

enum err experiment_step(struct experiment *e, const real_t *y)
{
    REFLUX_ASSERT(e->config.outputs <= CHANNEL_MAX);
    for (unsigned j = 0; j < e->config.outputs; j++)
        if (!real_is_finite(y[j]))
            return ERR_NOT_FINITE;
    enum err err = take_sample_in(e, y);
    memcpy(e->last, y, e->config.outputs * sizeof *y);
    return err;
}

enum err experiment_baseline(const struct experiment *e, uint8_t j, struct baseline *b)
{
    REFLUX_ASSERT(j < e->config.outputs);
    const struct steady_result *before = &e->before[j], *after = &e->after[j];
    real_t before_s = -before->age_s;
    real_t after_s = (real_t)(e->samples - 1u) * e->config.h_s - after->age_s;
    if (e->returned) {
        /* A change of the slope is the end of the response, which rest at noise level cannot tell from a drift. The mean may
         * be off by that much, whatever its noise. */
        real_t climb = after->slope_per_s - before->slope_per_s;
        real_t tail = climb * (real_t)e->half * e->config.h_s;
        real_t sd = real_sqrt(after->mean_sd * after->mean_sd + tail * tail);
        return baseline_from_means(before_s, before->mean - e->rest[j], before->mean_sd, after_s,
                                   after->mean - e->rest[j], sd, before->noise_sd, b);
    }
    experiment_baseline_before(e, j, b);
    return ERR_OK;
}

real_t experiment_bend(const struct experiment *e, uint8_t j, real_t *sd)
{
    REFLUX_ASSERT(j < e->config.outputs);
    real_t a = e->before[j].slope_sd_per_s, b = e->after[j].slope_sd_per_s;
    if (!e->returned) {
        *sd = REAL_C(0.0);
        return REAL_C(0.0);
    }
    *sd = real_sqrt(a * a + b * b);
    return e->after[j].slope_per_s - e->before[j].slope_per_s;
}
