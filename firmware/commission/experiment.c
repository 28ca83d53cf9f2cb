#include "supervise/config.h"
#if COMMISSION_CHANNELS

#include "commission/experiment.h"

#include <string.h>

#define MOTION_LIMIT   REAL_C(3.0) /* noise standard deviations over the window */
#define VARIANCE_LIMIT REAL_C(4.0)
#define SETTLED_SHARE  REAL_C(0.04) /* of the response: what a quarter of a step may still bring */
#define SETTLED_NOISE                                                                              \
    REAL_C(2.0) /* noise standard deviations that it may be, whatever the response */
#define DRIFT_SHARE  REAL_C(0.2)  /* of the response that a quarter of the time may drift */
#define FIRST_MOST   REAL_C(0.05) /* of span: largest amplitude to begin with */
#define FIRST_POINTS 16u          /* of the record since the last edge, before rest is looked for */
#define GUARD_NOISE  REAL_C(0.05)
#define GROWTH_MOST  REAL_C(4.0) /* of the amplitude in one go */
#define LIMIT_SHARE  REAL_C(0.7) /* of a limit that a larger amplitude may aim at */
#define TURN_SHARE   REAL_C(0.8) /* of a limit at which the negative half ends early */
#define PATIENCE     20u         /* windows until rest is given up */

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

static bool positive(real_t x)
{
    return x > REAL_C(0.0) && real_is_finite(x);
}

enum err experiment_begin(struct experiment *e, const struct experiment_config *c)
{
    memset(e, 0, sizeof *e);
    if (c->outputs == 0 || c->outputs > CHANNEL_MAX || c->window < STEADY_BLOCKS ||
        c->half_most <= c->window || c->half > c->half_most || c->half_least > c->half_most)
        return ERR_RANGE;
    if (!positive(c->amplitude_max) || !(c->amplitude >= REAL_C(0.0)) ||
        c->amplitude > c->amplitude_max || !positive(c->noise_multiple) ||
        (c->amplitude <= REAL_C(0.0) && !positive(c->amplitude_first)))
        return ERR_RANGE;
    for (unsigned j = 0; j < c->outputs; j++)
        if (!positive(c->limit[j]))
            return ERR_RANGE;
    e->config = *c;
    e->phase = EXPERIMENT_REST;
    struct moments_config m = {
        .outputs = c->outputs, .h_s = c->h_s, .fastest = MOMENTS_FASTEST, .ratio = MOMENTS_RATIO};
    m.alphas = moments_alphas_for(c->h_s, c->h_s * (real_t)c->half_most);
    enum err err = moments_init(&e->moments, &m);
    if (!err)
        err = record_init(&e->record, c->outputs, c->h_s);
    return err ? err : watch_rest(e, c->window);
}

static void enter(struct experiment *e, enum experiment_phase phase, real_t level)
{
    e->phase = phase;
    e->level = level;
    e->waited = 0;
}

static void fail(struct experiment *e, enum experiment_failure failure, uint8_t culprit)
{
    enter(e, EXPERIMENT_FAILED, REAL_C(0.0));
    e->failure = failure;
    e->culprit = culprit;
}

/* The guard begins at the level where each output is now: after an earlier edge that is not where it rested. */
static enum err arm_guard(struct experiment *e, const real_t *y)
{
    const struct experiment_config *c = &e->config;
    struct guard_config g = {
        .outputs = c->outputs, .h_s = c->h_s, .blanking_s = c->blank_s, .noise_share = GUARD_NOISE};
    for (unsigned j = 0; j < c->outputs; j++) {
        real_t spent = real_abs(y[j] - e->rest[j]);
        real_t least = c->limit[j] * REAL_C(0.1);
        bool first = e->samples == 0;
        g.output[j].initial = first ? e->rest[j] : y[j];
        g.output[j].limit = first ? c->limit[j] : c->limit[j] - spent;
        if (g.output[j].limit < least)
            g.output[j].limit = least;
        g.output[j].noise_sd = e->before[j].noise_sd;
        g.output[j].dead_time_s = c->dead_time_s[j];
    }
    return guard_init(&e->guard, &g);
}

static enum err move(struct experiment *e, real_t level)
{
    e->level = level;
    return record_move(&e->record, level);
}

/* Every output at rest? Where one climbs steadily for longer than the patience it counts as a drift, which is known
 * then and taken off; but not one that would carry it over a good part of its limit. */
static bool all_at_rest(struct experiment *e, struct steady_result *at, uint32_t patience,
                        uint8_t *culprit)
{
    bool rest = true;
    for (uint8_t j = 0; j < e->config.outputs; j++) {
        if (steady_look(&e->steady, j, &at[j]) != ERR_OK)
            return false;
        if (at[j].state == STEADY_SETTLED)
            continue;
        real_t carried =
            real_abs(at[j].slope_per_s) * e->config.h_s * (real_t)e->config.window * REAL_C(4.0);
        if (at[j].state == STEADY_MOVING && e->waited >= patience &&
            carried < e->config.limit[j] * REAL_C(0.3))
            continue;
        if (rest)
            *culprit = j;
        rest = false;
    }
    return rest;
}

/* Half of what an output would need that goes over its span with the input: noise tells where it makes sense to begin. */
static real_t first_amplitude(const struct experiment *e)
{
    real_t a = e->config.amplitude_first;
    for (unsigned j = 0; j < e->config.outputs; j++) {
        real_t wanted = REAL_C(0.5) * e->config.noise_multiple * e->before[j].noise_sd;
        if (wanted > FIRST_MOST)
            wanted = FIRST_MOST;
        if (wanted > a)
            a = wanted;
    }
    return a;
}

static enum err begin_step(struct experiment *e, const real_t *y)
{
    const struct experiment_config *c = &e->config;
    for (unsigned j = 0; j < c->outputs; j++)
        e->rest[j] = e->before[j].mean;
    enum err err = moments_begin(&e->moments, e->rest);
    if (!err)
        err = record_begin(&e->record, e->rest);
    if (!err)
        err = moments_step(&e->moments, y);
    if (!err)
        err = record_step(&e->record, y);
    if (!err)
        err = arm_guard(e, y);
    int trip;
    if (!err)
        err = guard_step(&e->guard, y, &trip);
    if (err)
        return err;
    e->amplitude = c->amplitude > REAL_C(0.0) ? c->amplitude : first_amplitude(e);
    if (e->amplitude > c->amplitude_max)
        e->amplitude = c->amplitude_max;
    enter(e, EXPERIMENT_UP, REAL_C(0.0));
    e->half = 0;
    e->samples = 1;
    return move(e, e->amplitude);
}

static enum err at_rest(struct experiment *e, const real_t *y)
{
    uint8_t culprit = 0;
    enum err err = steady_step(&e->steady, y);
    if (err)
        return err;
    e->waited++;
    if (all_at_rest(e, e->before, 4u * e->config.window, &culprit))
        return begin_step(e, y);
    if (e->waited > PATIENCE * e->config.window + e->config.half_most)
        fail(e, EXPERIMENT_RESTLESS, culprit);
    return ERR_OK;
}

static real_t mean_of(const struct record *r, unsigned j, uint32_t from, uint32_t to)
{
    real_t sum = REAL_C(0.0);
    for (uint32_t i = from; i < to; i++) /* RECORD_POINTS at most */
        sum += r->y[j][i];
    return sum / (real_t)(to - from);
}

/* How each output stands since the last edge, from the record, so that neither a clock nor a time constant is needed:
 * what the last quarter of the time brought, against the quarter before. */
struct progress {
    bool settled;     /* every output */
    real_t stand_out; /* largest response to the amplitude, in noise standard deviations */
    real_t
        growth; /* factor by which the amplitude may grow before an output comes near its limit */
    real_t last[CHANNEL_MAX]; /* mean deviation of the last quarter */
};

static void look_at_record(const struct experiment *e, struct progress *p)
{
    const struct record *r = &e->record;
    const struct experiment_config *c = &e->config;
    memset(p, 0, sizeof *p);
    p->growth = GROWTH_MOST;
    uint32_t edge = r->input.edge[r->input.edges - 1u].sample;
    uint32_t first = edge / r->block + 1u;
    if (r->points < first + FIRST_POINTS)
        return;
    uint32_t n = r->points - first, end = r->points;
    uint32_t q2 = end - n * 3u / 4u, q3 = end - n / 2u, q4 = end - n / 4u;
    p->settled = true;
    for (unsigned j = 0; j < c->outputs; j++) {
        const struct steady_result *b = &e->before[j];
        real_t last = mean_of(r, j, q4, end), before = mean_of(r, j, q3, q4);
        real_t spread = b->noise_sd / real_sqrt((real_t)(n / 4u) * (real_t)r->block);
        /* By what the latest edge brought: a drift has had less time to add to that. */
        real_t per_unit = (last - e->stair[j]) / (e->amplitude - e->stair_amplitude);
        real_t size = real_abs(per_unit) * e->amplitude;
        p->last[j] = last;
        real_t bound = SETTLED_NOISE * b->noise_sd;
        if (bound < REAL_C(4.0) * spread)
            bound = REAL_C(4.0) * spread;
        if (bound < SETTLED_SHARE * size)
            bound = SETTLED_SHARE * size;
        /* Three quarters on a line that hardly climbs are a drift, not the rest of a response. */
        real_t change = last - before, earlier = before - mean_of(r, j, q2, q3);
        real_t straight = REAL_C(4.0) * spread;
        if (straight < REAL_C(0.01) * size)
            straight = REAL_C(0.01) * size;
        bool drifts = n >= 2u * FIRST_POINTS && real_abs(change - earlier) < straight &&
                      real_abs(change) < DRIFT_SHARE * size;
        if (real_abs(change) > bound && !drifts)
            p->settled = false;
        if (size / b->noise_sd > p->stand_out)
            p->stand_out = size / b->noise_sd;
        real_t left = LIMIT_SHARE * c->limit[j] - real_abs(last);
        real_t rises = size + b->noise_sd; /* for doubling the amplitude */
        if (rises * (p->growth - REAL_C(1.0)) > left)
            p->growth = left > REAL_C(0.0) ? REAL_C(1.0) + left / rises : REAL_C(1.0);
    }
}

/* A larger amplitude that would make the response stand out; the present one where there is no room. */
static real_t larger(const struct experiment *e, const struct progress *p)
{
    const struct experiment_config *c = &e->config;
    real_t want = GROWTH_MOST;
    if (p->stand_out * GROWTH_MOST > REAL_C(1.2) * c->noise_multiple)
        want = REAL_C(1.2) * c->noise_multiple / p->stand_out;
    if (want > p->growth)
        want = p->growth;
    real_t a = e->amplitude * want;
    if (a > c->amplitude_max)
        a = c->amplitude_max;
    return a > REAL_C(1.1) * e->amplitude ? a : e->amplitude;
}

static enum err turn_down(struct experiment *e)
{
    enter(e, EXPERIMENT_DOWN, e->level);
    return move(e, -e->amplitude);
}

static enum err going_up(struct experiment *e, const real_t *y)
{
    const struct experiment_config *c = &e->config;
    int trip = -1;
    e->half++;
    enum err err = guard_step(&e->guard, y, &trip);
    if (err)
        return err;
    if (trip >= 0) {
        struct guard_prediction peak;
        bool believed =
            c->line_guard || real_abs(y[trip] - e->rest[trip]) > REAL_C(0.5) * c->limit[trip];
        if (believed && guard_predict(&e->guard, (uint32_t)trip, &peak) == ERR_OK) {
            e->cut = true;
            e->culprit = (uint8_t)trip;
            e->predicted = peak.predicted + e->guard.config.output[trip].initial - e->rest[trip];
            return turn_down(e);
        }
    }
    if (c->half > 0 && e->half >= c->half)
        return turn_down(e);
    if (e->half >= c->half_most) {
        e->at_longest = true;
        return turn_down(e);
    }
    if (c->half > 0 || e->half < c->half_least || e->record.waiting != 0)
        return ERR_OK;
    struct progress p;
    look_at_record(e, &p);
    if (!p.settled || (p.stand_out < REAL_C(4.0) && e->half < c->half_least + 4u * c->window))
        return ERR_OK;
    if (c->amplitude > REAL_C(0.0) || p.stand_out >= c->noise_multiple)
        return turn_down(e);
    real_t a = larger(e, &p);
    e->small = a <= e->amplitude;
    if (e->small || e->record.input.edges + 3u > EXCITATION_EDGES_MAX)
        return turn_down(e);
    memcpy(e->stair, p.last, sizeof e->stair);
    e->stair_amplitude = e->amplitude;
    e->amplitude = a;
    e->half = 0;
    err = arm_guard(e, y);
    if (!err)
        err = guard_step(&e->guard, y, &trip);
    return err ? err : move(e, a);
}

/* After steps up the way down can be the longer one: it ends before an output gets to its limit, what is still under way
 * in dead time included. */
static bool far_enough(const struct experiment *e, const real_t *y)
{
    const struct record *r = &e->record;
    for (unsigned j = 0; j < e->config.outputs; j++) {
        real_t apart_s = (real_t)r->block * e->config.h_s;
        real_t slope = r->points < 2
                           ? REAL_C(0.0)
                           : (r->y[j][r->points - 1u] - r->y[j][r->points - 2u]) / apart_s;
        real_t to_come = slope * e->config.dead_time_s[j];
        if (real_abs(y[j] - e->rest[j] + to_come) > TURN_SHARE * e->config.limit[j])
            return true;
    }
    return false;
}

static enum err going_down(struct experiment *e, const real_t *y)
{
    e->waited++;
    /* Not before it has come through rest: the positive half ends near the limit, too. */
    bool past = e->waited > e->half / 2u && far_enough(e, y);
    if (e->waited < e->half && !past)
        return ERR_OK;
    enter(e, EXPERIMENT_BACK, e->level);
    uint32_t third = e->half / 3u; /* a window that sees the slowest response */
    enum err err = watch_rest(e, third > e->config.window ? third : e->config.window);
    return err ? err : move(e, REAL_C(0.0));
}

static enum err coming_back(struct experiment *e, const real_t *y)
{
    uint8_t culprit = 0;
    e->waited++;
    enum err err = steady_step(&e->steady, y);
    if (err)
        return err;
    bool rest = all_at_rest(e, e->after, e->half + 4u * e->config.window, &culprit);
    if (rest) {
        e->returned = true;
        enter(e, EXPERIMENT_DONE, REAL_C(0.0));
    } else if (e->waited > 4u * e->half + 8u * e->config.window) {
        /* Away from where it began, and not on its way back. */
        for (uint8_t j = 0; j < e->config.outputs; j++)
            if (real_abs(y[j] - e->rest[j]) > REAL_C(0.8) * e->config.limit[j])
                culprit = j;
        if (real_abs(y[culprit] - e->rest[culprit]) > REAL_C(0.8) * e->config.limit[culprit])
            fail(e, EXPERIMENT_AWAY, culprit);
        else
            enter(e, EXPERIMENT_DONE, REAL_C(0.0));
    }
    return ERR_OK;
}

/* Hard: two samples in a row past the limit, noise apart. */
static bool past_limit(struct experiment *e, const real_t *y)
{
    for (uint8_t j = 0; j < e->config.outputs; j++) {
        real_t away = real_abs(y[j] - e->rest[j]), limit = e->config.limit[j];
        if (away / limit > e->worst) {
            e->worst = away / limit;
            e->worst_output = j;
        }
        bool over = away > limit + REAL_C(4.0) * e->before[j].noise_sd;
        e->over[j] = over ? (uint8_t)(e->over[j] + 1u) : 0;
        if (e->over[j] < 2)
            continue;
        fail(e, EXPERIMENT_LIMIT, j);
        return true;
    }
    return false;
}

enum err experiment_step(struct experiment *e, const real_t *y)
{
    for (unsigned j = 0; j < e->config.outputs; j++)
        if (!real_is_finite(y[j]))
            return ERR_NOT_FINITE;
    if (e->phase == EXPERIMENT_REST)
        return at_rest(e, y);
    if (past_limit(e, y))
        return ERR_OK;
    enum err err = moments_step(&e->moments, y);
    if (!err)
        err = record_step(&e->record, y);
    if (err)
        return err;
    e->samples++;
    switch (e->phase) {
    case EXPERIMENT_UP:
        return going_up(e, y);
    case EXPERIMENT_DOWN:
        return going_down(e, y);
    case EXPERIMENT_BACK:
        return coming_back(e, y);
    default:
        return ERR_STATE;
    }
}

enum err experiment_baseline(const struct experiment *e, uint8_t j, struct baseline *b)
{
    const struct steady_result *before = &e->before[j], *after = &e->after[j];
    real_t before_s = -before->age_s;
    real_t after_s = (real_t)(e->samples - 1u) * e->config.h_s - after->age_s;
    if (e->returned)
        return baseline_from_means(before_s, before->mean - e->rest[j], before->mean_sd, after_s,
                                   after->mean - e->rest[j], after->mean_sd, before->noise_sd, b);
    *b = (struct baseline){.offset = before->mean - e->rest[j],
                           .slope_per_s = before->slope_per_s,
                           .offset_sd = before->mean_sd,
                           .slope_sd_per_s = before->slope_sd_per_s,
                           .noise_sd = before->noise_sd};
    return ERR_OK;
}

#endif
