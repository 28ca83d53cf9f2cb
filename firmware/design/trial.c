#include "design/trial.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"

#define SAMPLES_A_CALL 4
#define LONGEST_DELAY  (TRIAL_DELAY - 3)
#define BAND           REAL_C(0.05)
#define RUNAWAY        REAL_C(100.0)

static const struct fopdt *plant_element(const struct trial *t, size_t k, size_t l)
{
    REFLUX_ASSERT(k < t->loops->pairs.n && l < t->loops->pairs.n);
    return &t->plant->element[t->loops->pairs.output[k]][t->loops->pairs.input[l]];
}

static enum err check_trial(const struct loops *loops, const struct trial_config *c)
{
    if (c->loop >= loops->pairs.n || !real_within(c->mark_s, REAL_C(0.0), REAL_C(1e7)) ||
        !real_within(real_abs(c->size), REAL_C(1e-6), REAL_C(1e6)) ||
        !real_within(c->setpoint_weight, REAL_C(0.0), REAL_C(1.0)) ||
        !real_within(c->raise, REAL_C(0.0), REAL_C(10.0)))
        return ERR_RANGE;
    if (!real_within(c->duration_s, REAL_C(0.0), REAL_C(0.0)) &&
        !real_within(c->duration_s, REAL_C(1e-2), REAL_C(1e7)))
        return ERR_RANGE;
    for (size_t k = 0; k < loops->pairs.n; k++)
        if (loops->tuning[k].td_s > REAL_C(0.0))
            return ERR_RANGE;
    return ERR_OK;
}

/* Duration and sample: as given where that fits. */
static void set_times(struct trial *t)
{
    real_t slowest = REAL_C(0.0), fastest = REAL_C(1e9);
    for (size_t k = 0; k < t->loops->pairs.n; k++) {
        real_t ti = t->loops->tuning[k].ti_s, whole = ti + plant_element(t, k, k)->dead_time_s;
        slowest = whole > slowest ? whole : slowest;
        fastest = ti < fastest ? ti : fastest;
    }
    t->duration_s =
        t->config.duration_s > REAL_C(0.0) ? t->config.duration_s : REAL_C(15.0) * slowest;
    loops_sample(t->plant, t->loops, LONGEST_DELAY, t->duration_s / (real_t)TRIAL_SAMPLES,
                 &t->sampled);
    t->step_s = t->sampled.step_s;
    t->coarse = t->step_s > t->loops->interval_s && t->step_s > REAL_C(0.2) * fastest;
    t->steps = (uint32_t)(t->duration_s / t->step_s) + 1u;
    if (t->steps > TRIAL_SAMPLES)
        t->steps = TRIAL_SAMPLES;
}

enum err trial_begin(struct trial *t, const struct interact_plant *plant, const struct loops *loops,
                     const struct trial_config *config)
{
    enum err err = interact_check(plant, NULL);
    if (!err)
        err = loops_check(plant, loops, NULL);
    if (!err)
        err = check_trial(loops, config);
    if (err)
        return err;
    memset(t, 0, sizeof *t);
    t->plant = plant;
    t->loops = loops;
    t->config = *config;
    t->bounded = true;
    set_times(t);
    return ERR_OK;
}

static real_t setpoint(const struct trial *t, size_t k)
{
    return k == t->config.loop && !t->config.load ? t->config.size : REAL_C(0.0);
}

/* Steps the controllers: the inputs they ask for, from the outputs at this sample. */
static void control(struct trial *t)
{
    const struct loops *loops = t->loops;
    size_t n = loops->pairs.n;
    real_t v[INTERACT_MAX];
    for (size_t k = 0; k < n; k++) {
        const struct tuning *s = &loops->tuning[k];
        real_t gain = s->action == TUNING_DIRECT ? -s->gain : s->gain, sp = setpoint(t, k);
        if (k == t->config.loop && t->config.raise > REAL_C(0.0))
            gain *= t->config.raise;
        v[k] = gain * (t->config.setpoint_weight * sp - t->y[k]) + t->integral[k];
        t->integral[k] += gain * t->step_s / s->ti_s * (sp - t->y[k]);
    }
    for (size_t l = 0; l < n; l++) {
        real_t u = v[l];
        if (loops->decoupler) {
            u = REAL_C(0.0);
            for (size_t k = 0; k < n; k++)
                u += loops->decoupler->value[l][k] * v[k];
        }
        if (real_abs(u) > t->loop[l].moved)
            t->loop[l].moved = real_abs(u);
        if (l == t->config.loop && t->config.load)
            u += t->config.size;
        t->past[l][t->sample % TRIAL_DELAY] = u;
    }
}

static void advance_plant(struct trial *t)
{
    size_t n = t->loops->pairs.n;
    for (size_t k = 0; k < n; k++) {
        t->y[k] = REAL_C(0.0);
        for (size_t l = 0; l < n; l++) {
            REFLUX_ASSERT(t->sampled.delay[k][l] < TRIAL_DELAY);
            uint32_t now = t->sample + TRIAL_DELAY - t->sampled.delay[k][l];
            real_t after = t->past[l][now % TRIAL_DELAY];
            real_t before = t->past[l][(now - 1u) % TRIAL_DELAY];
            t->y[k] += loops_advance(t->loops, &t->sampled, k, l, before, after, &t->state[k][l],
                                     &t->second[k][l]);
        }
    }
}

static void judge_point(struct trial *t)
{
    real_t size = real_abs(t->config.size);
    for (size_t k = 0; k < t->loops->pairs.n; k++) {
        struct trial_loop *r = &t->loop[k];
        real_t sp = setpoint(t, k), e = t->y[k] - sp;
        bool stepped = real_abs(sp) > REAL_C(0.0);
        /* past the setpoint, in the step's direction */
        real_t past = stepped ? (t->config.size > REAL_C(0.0) ? e : -e) : real_abs(e);
        r->iae += real_abs(e) * t->step_s;
        if (past / size > r->peak)
            r->peak = past / size;
        if (real_abs(e) > BAND * size)
            r->settled_s = t->time_s + t->step_s;
        if (!(real_abs(t->y[k]) <= RUNAWAY * size))
            t->bounded = false;
    }
}

/* Before the sample is counted. */
static void remember_mark(struct trial *t)
{
    REFLUX_ASSERT(t->config.loop < t->loops->pairs.n);
    struct trial_mark *m = &t->mark;
    uint8_t k = t->config.loop;
    if (t->config.load || !(t->time_s < t->config.mark_s))
        return;
    real_t short_of = setpoint(t, k) - t->y[k];
    m->iae = t->loop[k].iae;
    m->others = REAL_C(0.0);
    for (size_t l = 0; l < t->loops->pairs.n; l++)
        if (l != k && t->loop[l].peak > m->others)
            m->others = t->loop[l].peak;
    if (t->time_s >= REAL_C(0.75) * t->config.mark_s) {
        t->left_sum += t->config.size > REAL_C(0.0) ? short_of : -short_of;
        t->left_n++;
        m->left = t->left_sum / (real_t)t->left_n;
    }
    for (size_t l = 0; l < t->loops->pairs.n; l++) {
        m->moved[l] = t->loop[l].moved;
        m->input[l] = t->past[l][t->sample % TRIAL_DELAY];
    }
}

enum err trial_step(struct trial *t)
{
    if (t->done)
        return ERR_STATE;
    for (int sample = 0; sample < SAMPLES_A_CALL && t->sample < t->steps && t->bounded; sample++) {
        control(t);
        advance_plant(t);
        judge_point(t);
        remember_mark(t);
        t->sample++;
        t->time_s = (real_t)t->sample * t->step_s;
    }
    if (t->sample < t->steps && t->bounded)
        return ERR_BUSY;
    for (size_t k = 0; k < t->loops->pairs.n; k++)
        if (t->loop[k].settled_s > t->duration_s || !t->bounded)
            t->loop[k].settled_s = t->duration_s;
    t->done = true;
    return ERR_OK;
}
