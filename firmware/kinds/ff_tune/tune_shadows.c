#include "kinds/ff_tune/tune_shadows.h"

#include <string.h>

#include "kinds/ff_tune/tune_shadows_state.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

static void begin_shadow(const struct tune_model *m, const struct tune_context *c,
                         struct loop_shadow *s)
{
    shadow_begin(s, &m->element, c->s.gain, c->s.ti_s, c->h_s);
}

void tune_shadows_take(struct tune_shadows *s, const struct tune_model *model)
{
    s->model = *model;
}

void tune_shadows_begin(struct tune_shadows *s, const struct tune_context *c)
{
    begin_shadow(&s->model, c, &s->no_feedforward);
    s->integral = ZERO;
    s->warm = 0;
}

void tune_candidate_begin(struct tune_shadows *s, const struct tune_context *c, real_t d)
{
    begin_shadow(&s->model, c, &s->with_candidate);
    for (unsigned k = 0; k < SHADOW_REACH; k++)
        s->delayed[k] = d;
    s->lead_lag = s->last_d = d;
    s->candidate_warm = 0;
}

/* Returns what the candidate would add. Its own steps are those of the samples here. */
static real_t candidate_adds(struct tune_shadows *s, const struct tune_context *c,
                             const struct feedforward_shape *f, real_t newest)
{
    real_t dead = f->dead / c->h_s;
    unsigned most = SHADOW_REACH - 2u;
    unsigned whole = dead < (real_t)most ? (unsigned)dead : most;
    real_t part = dead < (real_t)most ? dead - (real_t)whole : ZERO;
    memmove(s->delayed + 1, s->delayed, (SHADOW_REACH - 1u) * sizeof s->delayed[0]);
    s->delayed[0] = newest;
    real_t d = s->delayed[whole] + part * (s->delayed[whole + 1u] - s->delayed[whole]);
    s->lead_lag += (c->h_s * (d - s->lead_lag) + f->lead * (d - s->last_d)) / (f->lag + c->h_s);
    s->last_d = d;
    return f->k * s->lead_lag;
}

/* The closed loop is faster than the process by 1 + K gain, so one that integrates forgets, too. */
uint32_t tune_forgets_in(const struct tune_shadows *s, const struct tune_context *c)
{
    real_t of_loop = s->model.element.gain * c->s.gain;
    real_t lag = s->model.element.time_constant_s / (ONE + (of_loop > ZERO ? of_loop : ZERO));
    real_t seconds =
        REAL_C(5.0) * lag + REAL_C(4.0) * s->model.element.dead_time_s + REAL_C(2.0) * c->s.ti_s;
    real_t n = seconds / c->h_s;
    return n < REAL_C(60000.0) ? (uint32_t)n : 60000u;
}

/* Returns what took effect beside what the controller would have given from the same measurements, were it linear. That is the feedforward,
 * but also what limits have made of it and of the integral. */
static real_t beside_controller(struct tune_shadows *s, const struct tune_context *c,
                                const struct tune_samples *samples)
{
    real_t r = tune_sample(samples, SIGNAL_R), y = tune_sample(samples, SIGNAL_Y);
    real_t given = c->s.gain * (c->s.b * r - y) + s->integral;
    if (c->s.ti_s > 0)
        s->integral += c->s.gain * c->h_s / c->s.ti_s * s->errors.actual;
    return tune_sample(samples, SIGNAL_U) - given;
}

static uint16_t one_more(uint16_t n)
{
    return (uint16_t)(n < 65535u ? n + 1u : n);
}

void tune_shadows_step(struct tune_shadows *s, const struct tune_context *c,
                       const struct tune_samples *samples,
                       const struct feedforward_shape *candidate)
{
    struct tune_errors *e = &s->errors;
    uint32_t rest = tune_forgets_in(s, c);
    e->actual = tune_sample_error(samples);
    e->no_feedforward =
        e->actual + shadow_step(&s->no_feedforward, beside_controller(s, c, samples));
    s->warm = one_more(s->warm);
    e->count =
        s->warm > rest && tune_since_setpoint(samples) > rest && tune_sample_is_good(samples);
    e->with_candidate = e->no_feedforward;
    if (!candidate)
        return;
    real_t added = candidate_adds(s, c, candidate, tune_sample(samples, SIGNAL_D));
    e->with_candidate -= shadow_step(&s->with_candidate, added);
    s->candidate_warm = one_more(s->candidate_warm);
}

const struct tune_errors *tune_shadows_errors(const struct tune_shadows *s)
{
    return &s->errors;
}

const struct tune_model *tune_shadows_model(const struct tune_shadows *s)
{
    return &s->model;
}

bool tune_candidate_is_warm(const struct tune_shadows *s, const struct tune_context *c)
{
    return s->candidate_warm > tune_forgets_in(s, c);
}

bool tune_shadow_is_lost(const struct tune_shadows *s)
{
    return shadow_is_lost(&s->no_feedforward);
}

bool tune_candidate_is_lost(const struct tune_shadows *s)
{
    return shadow_is_lost(&s->with_candidate);
}
