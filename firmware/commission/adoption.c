#include "supervise/config.h"
#if COMMISSION_CHANNELS

#include "commission/adoption.h"

#include <string.h>

enum stage {
    STAGE_SETTLE, /* all in automatic, nothing asked yet */
    STAGE_STEP,   /* setpoint of loop `at` away */
    STAGE_RETURN  /* and back; also the end, where the others are looked at */
};

#define NOISE_MULTIPLE REAL_C(4.0)
#define REST_SHARE     REAL_C(0.15) /* of the step: error left at the end of it */
#define AUTO_TICKS     3u           /* a mode asked for is there by then */
#define LISTEN_TICK    2u           /* the first may be that of the beginning itself */

static void ask(struct supervisor *s, uint8_t i, enum request_kind kind, enum loop_mode mode,
                real_t value)
{
    struct request r = {
        .kind = kind, .loop = i, .output = PLAN_NONE, .mode = (uint8_t)mode, .value = value};
    supervisor_request(s, &r);
}

static real_t measured(const struct supervisor *s, uint8_t i)
{
    return num_to_float(s->measurement[s->plan->loop[i].pv].value);
}

static void setpoint(const struct adoption *a, struct supervisor *s, uint8_t k, real_t fraction)
{
    uint8_t i = a->loop[k].loop;
    const struct measurement_config *m = &s->plan->config.measurement[s->plan->loop[i].pv];
    ask(s, i, REQUEST_SETPOINT, LOOP_AUTO, m->lo + fraction * (m->hi - m->lo));
}

static uint32_t duration(const struct adoption_loop *l, const struct supervisor *s)
{
    real_t ticks = ADOPTION_DURATION * l->predicted.settled_s / s->plan->tick_s;
    return ticks < REAL_C(20.0) ? 20u : ticks > REAL_C(1e6) ? 1000000u : (uint32_t)ticks;
}

static uint32_t longest(const struct adoption *a, const struct supervisor *s)
{
    uint32_t most = 0;
    for (uint8_t k = 0; k < a->n; k++) {
        uint32_t d = duration(&a->loop[k], s);
        most = d > most ? d : most;
    }
    return most;
}

static void enter(struct adoption *a, enum stage stage, uint32_t ticks)
{
    a->stage = (uint8_t)stage;
    a->ticks = 0;
    a->stage_ticks = ticks;
    a->error_sum = REAL_C(0.0);
    a->error_n = 0;
}

void adoption_hold(struct adoption *a, const struct supervisor *s)
{
    for (uint8_t k = 0; k < a->n + a->n_inner; k++) {
        uint8_t j = s->plan->loop[a->loop[k].loop].output;
        if (j != PLAN_NONE)
            a->loop[k].held = num_to_float(s->output[j].manual);
    }
}

void adoption_begin(struct adoption *a, struct supervisor *s)
{
    a->result = ADOPTION_RUNNING;
    a->at = a->culprit = 0;
    for (uint8_t k = 0; k < a->n; k++) {
        a->loop[k].iae = a->loop[k].peak = REAL_C(0.0);
        ask(s, a->loop[k].loop, REQUEST_MODE, LOOP_AUTO, REAL_C(0.0));
    }
    enter(a, STAGE_SETTLE, longest(a, s) / 4u + AUTO_TICKS);
}

/* A tick later than the others: by then the outer loops, which may be new, have followed the inner measurements. */
static void listen(const struct adoption *a, struct supervisor *s)
{
    for (uint8_t k = a->n; k < a->n + a->n_inner; k++)
        ask(s, a->loop[k].loop, REQUEST_MODE, LOOP_CASCADE, REAL_C(0.0));
}

static enum adoption_result fail(struct adoption *a, enum adoption_result why, uint8_t k)
{
    a->culprit = k;
    a->result = why;
    return why;
}

/* Every loop acts, and none is past its limit. */
static enum adoption_result watch(struct adoption *a, const struct supervisor *s)
{
    for (uint8_t k = 0; k < a->n + a->n_inner; k++) {
        uint8_t i = a->loop[k].loop;
        if (s->loop[i].mode != (k < a->n ? LOOP_AUTO : LOOP_CASCADE)) {
            if (a->stage == STAGE_SETTLE && a->ticks < AUTO_TICKS)
                continue;
            return fail(a, ADOPTION_NOT_AUTO, k);
        }
        real_t away = real_abs(measured(s, i) - num_to_float(s->loop[i].target));
        real_t step = a->stage == STAGE_SETTLE ? REAL_C(0.0) : real_abs(a->loop[k].step);
        if (away > a->loop[k].limit + step + NOISE_MULTIPLE * a->loop[k].noise_sd)
            return fail(a, ADOPTION_PAST_LIMIT, k);
    }
    return ADOPTION_RUNNING;
}

static void begin_step(struct adoption *a, struct supervisor *s)
{
    if (a->at == 0)
        for (uint8_t k = 0; k < a->n; k++)
            a->start[k] = num_to_float(s->loop[a->loop[k].loop].target);
    setpoint(a, s, a->at, a->start[a->at] + a->loop[a->at].step);
    enter(a, STAGE_STEP, duration(&a->loop[a->at], s));
}

static void look(struct adoption *a, const struct supervisor *s)
{
    struct adoption_loop *l = &a->loop[a->at];
    real_t error = num_to_float(s->loop[l->loop].target) - measured(s, l->loop);
    l->iae += real_abs(error) * s->plan->tick_s;
    real_t past = -error / l->step; /* in units of the step, above 0 beyond the setpoint */
    if (past > l->peak)
        l->peak = past;
    if (a->ticks > a->stage_ticks - a->stage_ticks / 4u) {
        a->error_sum += error;
        a->error_n++;
    }
}

/* What the drift keeps a loop away from its setpoint. Its controller has to climb as fast as the drift, for which the
 * error is the drift times the integral of the error after a step of one: both are Ti / (K Kc). The other loops drift,
 * too. */
static real_t lag_behind_drift(const struct adoption_loop *l)
{
    return REAL_C(2.0) * l->drift_per_s * l->predicted.iae / real_abs(l->size);
}

static enum adoption_result judge(struct adoption *a, const struct supervisor *s)
{
    struct adoption_loop *l = &a->loop[a->at];
    real_t scale = real_abs(l->step / l->size), step = real_abs(l->step);
    real_t ran_s = (real_t)a->stage_ticks * s->plan->tick_s;
    /* What noise alone integrates to: its mean magnitude is 0.8 of its standard deviation. */
    real_t lag = lag_behind_drift(l);
    real_t iae_most =
        ADOPTION_IAE * l->predicted.iae * scale + (REAL_C(1.5) * l->noise_sd + lag) * ran_s;
    real_t peak_most =
        l->predicted.peak + ADOPTION_PEAK + (NOISE_MULTIPLE * l->noise_sd + lag) / step;
    real_t left = a->error_n ? real_abs(a->error_sum) / (real_t)a->error_n : REAL_C(0.0);
    if (l->peak > peak_most)
        return fail(a, ADOPTION_OVERSHOOT, a->at);
    if (left > REST_SHARE * step + l->noise_sd + lag)
        return fail(a, ADOPTION_RESTLESS, a->at);
    if (l->iae > iae_most)
        return fail(a, ADOPTION_SLOW, a->at);
    return ADOPTION_RUNNING;
}

enum adoption_result adoption_tick(struct adoption *a, struct supervisor *s)
{
    a->ticks++;
    if (a->stage == STAGE_SETTLE && a->ticks == LISTEN_TICK)
        listen(a, s);
    enum adoption_result r = watch(a, s);
    if (r != ADOPTION_RUNNING)
        return r;
    if (a->stage == STAGE_STEP)
        look(a, s);
    if (a->ticks < a->stage_ticks)
        return ADOPTION_RUNNING;
    if (a->stage == STAGE_STEP) {
        r = judge(a, s);
        setpoint(a, s, a->at, a->start[a->at]);
        enter(a, STAGE_RETURN, duration(&a->loop[a->at], s));
        return r;
    }
    if (a->stage == STAGE_RETURN)
        a->at++;
    if (a->at < a->n) {
        begin_step(a, s);
        return ADOPTION_RUNNING;
    }
    a->result = ADOPTION_PASSED;
    return ADOPTION_PASSED;
}

#endif
