#include "identify/guard.h"

#include "base/assertion.h"
#include "identify/common.h"
#include "lti/fopdt.h" /* real_is_finite */

/* A prediction must be over the limit by so many standard deviations of noise, beyond its share. */
#define EXCESS_SDS REAL_C(3.0)

enum err guard_init(struct guard *g, const struct guard_config *config)
{
    enum err err = check_real(config->h_s, REAL_C(1e-3), REAL_C(1e5));
    if (!err)
        err = check_real(config->blanking_s, ZERO, REAL_C(1e6));
    if (!err)
        err = check_real(config->noise_share, REAL_C(1e-6), REAL_C(0.5));
    if (err)
        return err;
    if (config->outputs == 0 || config->outputs > CHANNEL_MAX)
        return ERR_RANGE;
    for (uint32_t o = 0; o < config->outputs; o++) {
        const struct guard_output *c = &config->output[o];
        err = check_real(c->initial, REAL_C(-1e9), REAL_C(1e9));
        if (!err)
            err = check_real(c->limit, REAL_C(1e-9), REAL_C(1e9));
        if (!err)
            err = check_real(c->noise_sd, ZERO, REAL_C(1e9));
        if (!err)
            err = check_real(c->dead_time_s, ZERO, REAL_C(1e6));
        if (err)
            return err;
    }
    *g = (struct guard){.config = *config};
    return ERR_OK;
}

/* Weight of the sample before relative to the newest, window w from 1: about 2^(w + 1) samples count. */
static real_t forgetting(uint32_t window)
{
    return ONE - ONE / (real_t)(1u << window);
}

/* Variance of the slope per sample over that of the noise. Of a regression that forgets: 2 (1 - l)^3/(1 + l)^3 when it
 * has run for long; before, of a plain one over all n samples, 12/(n^3 - n). */
static real_t slope_variance(uint32_t window, real_t n)
{
    if (window == 0)
        return TWO;
    real_t l = forgetting(window), r = (ONE - l) / (ONE + l);
    real_t lasting = TWO * r * r * r, early = REAL_C(12.0) / (n * n * n - n);
    return early > lasting ? early : lasting;
}

static void predict(const struct guard *g, uint32_t o, struct guard_prediction *p)
{
    const struct guard_output *c = &g->config.output[o];
    real_t t = (real_t)(g->samples - 1), dead = c->dead_time_s / g->config.h_s;
    real_t reach = t > dead ? t : dead, share = g->config.noise_share * c->limit;
    uint32_t window = 0;
    while (window + 1 < GUARD_WINDOWS && (real_t)(4u << window) <= t &&
           c->noise_sd * real_sqrt(slope_variance(window, t + ONE)) * reach > share)
        window++;
    real_t slope, level;
    if (window == 0) {
        slope = g->last[o] - g->previous[o];
        level = g->last[o];
    } else {
        real_t a0 = g->ages[window][0], a1 = g->ages[window][1], a2 = g->ages[window][2];
        real_t b0 = g->sums[window][o][0], b1 = g->sums[window][o][1];
        real_t d = a0 * a2 - a1 * a1; /* above 0 from the second sample on */
        slope = (a1 * b0 - a0 * b1) / d;
        level = (a2 * b0 - a1 * b1) / d;
    }
    real_t line = slope * t, reached = level + slope * dead;
    p->source = line;
    /* The larger of the two in the direction in which the response goes. */
    p->predicted = real_abs(line) > real_abs(reached) ? line : reached;
    p->slope_per_s = slope / g->config.h_s;
    p->sd = c->noise_sd * real_sqrt(slope_variance(window, t + ONE)) * reach;
    p->window = 2u << window;
}

enum err guard_step(struct guard *g, const real_t *y, int *trip)
{
    REFLUX_ASSERT(g->config.outputs <= CHANNEL_MAX);
    real_t d[CHANNEL_MAX] = {ZERO};
    for (uint32_t o = 0; o < g->config.outputs; o++) {
        d[o] = y[o] - g->config.output[o].initial;
        enum err err = check_real(d[o], -VALUE_MAX, VALUE_MAX);
        if (err)
            return err;
    }
    if (g->samples == UINT32_MAX)
        return ERR_FULL;
    /* Everything grows one sample older: age^2 -> age^2 + 2 age + 1. */
    for (uint32_t w = 1; w < GUARD_WINDOWS; w++) {
        real_t l = forgetting(w), *a = g->ages[w];
        a[2] = l * (a[2] + TWO * a[1] + a[0]);
        a[1] = l * (a[1] + a[0]);
        a[0] = l * a[0] + ONE;
        for (uint32_t o = 0; o < g->config.outputs; o++) {
            real_t *b = g->sums[w][o];
            b[1] = l * (b[1] + b[0]);
            b[0] = l * b[0] + d[o];
        }
    }
    for (uint32_t o = 0; o < g->config.outputs; o++) {
        g->previous[o] = g->last[o];
        g->last[o] = d[o];
    }
    g->samples++;
    *trip = -1;
    real_t t_s = (real_t)(g->samples - 1) * g->config.h_s, worst = ONE;
    if (g->samples < 3 || t_s < g->config.blanking_s)
        return ERR_OK;
    for (uint32_t o = 0; o < g->config.outputs; o++) {
        const struct guard_output *c = &g->config.output[o];
        struct guard_prediction p;
        predict(g, o, &p);
        real_t excess = p.sd - g->config.noise_share * c->limit;
        real_t allowed = c->limit + (excess > ZERO ? EXCESS_SDS * excess : ZERO);
        real_t part = real_abs(p.predicted) / allowed;
        if (part > worst) {
            worst = part;
            *trip = (int)o;
        }
    }
    return ERR_OK;
}

enum err guard_predict(const struct guard *g, uint32_t output, struct guard_prediction *result)
{
    if (output >= g->config.outputs)
        return ERR_RANGE;
    if (g->samples < 3)
        return ERR_EMPTY;
    predict(g, output, result);
    return ERR_OK;
}

enum err guard_model_peak(const struct fopdt_fit_result *fit, real_t amplitude, real_t elapsed_s,
                          real_t *peak, real_t *sd)
{
    if (!real_is_finite(amplitude))
        return ERR_NOT_FINITE;
    enum err err = check_real(elapsed_s, ZERO, REAL_C(1e9));
    if (err)
        return err;
    const struct identified *m = &fit->element;
    if (!real_is_finite(m->gain) || !real_is_finite(m->time_constant_s) ||
        !real_is_finite(m->dead_time_s))
        return ERR_NOT_FINITE;
    real_t drift = fit->slope_per_s * (elapsed_s + m->dead_time_s);
    if (m->flags & IDENTIFIED_NO_GAIN) {
        *peak = drift;
        *sd = real_abs(amplitude) * m->gain_sd;
        return ERR_OK;
    }
    real_t lag = m->time_constant_s;
    real_t x = lag > ZERO ? elapsed_s / lag : REAL_C(80.0);
    real_t rest = x < REAL_C(80.0) ? real_exp(-x) : ZERO;
    real_t by_gain = amplitude * (ONE - rest);
    real_t by_lag = lag > ZERO ? -m->gain * amplitude * rest * x / lag : ZERO;
    real_t variance = by_gain * by_gain * fit->covariance[0] +
                      TWO * by_gain * by_lag * fit->covariance[1] +
                      by_lag * by_lag * fit->covariance[2];
    *peak = m->gain * by_gain + drift;
    *sd = variance > ZERO ? real_sqrt(variance) : ZERO;
    return real_is_finite(*peak) && real_is_finite(*sd) ? ERR_OK : ERR_NOT_FINITE;
}
