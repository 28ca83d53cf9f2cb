/* The loop of Siddha (2003), chapter 2, in double: Gp = 2 exp(-0.6 s)/(0.4 s + 1) and one of nine disturbance paths, exact at samples of
 * 0.05 s under inputs that are held, a PI (backward Euler, KP 0.325, KI 0.4924) and the feedforward of equation 2.6. What
 * the source does not say (amplitudes of 1, noise in the feedback as well) is that of the digest's section 8.6. */
#ifndef REFLUX_TESTS_SIDDHA_LOOP_H
#define REFLUX_TESTS_SIDDHA_LOOP_H

#include <complex.h>
#include <math.h>
#include <string.h>

#include "random_source.h"

#define SIDDHA_TS     0.05
#define SIDDHA_GAIN   0.325
#define SIDDHA_TI     0.66
#define SIDDHA_CASES  9
#define SIDDHA_BUFFER 32

/* In the order of table 2.1: dead time in samples, time constant. */
static const struct {
    int dead;
    double lag;
    const char *name;
} siddha_case[SIDDHA_CASES] = {{8, 0.25, "III c"}, {12, 0.25, "I c"}, {16, 0.25, "II c"},
                               {8, 0.4, "III b"},  {12, 0.4, "I b"},  {16, 0.4, "II b"},
                               {8, 0.5, "III a"},  {12, 0.5, "I a"},  {16, 0.5, "II a"}};

struct siddha_loop {
    int regime;
    double process_gain; /* 2 */
    int process_dead;    /* 12 samples */
    double xp, xd, u[SIDDHA_BUFFER], d[SIDDHA_BUFFER];
    double integral, y, noise_sd;
    double k, lead, lag, ff, last_d; /* feedforward; k 0: none */
    double u_fb, u_now;
    struct random_source source;
};

static inline void siddha_begin(struct siddha_loop *s, int regime, double noise_sd, uint64_t seed)
{
    memset(s, 0, sizeof *s);
    s->regime = regime;
    s->process_gain = 2;
    s->process_dead = 12;
    s->noise_sd = noise_sd;
    s->source.state = seed;
}

static inline double siddha_uniform(struct siddha_loop *s)
{
    return ((double)(random_next(&s->source) >> 11) + 0.5) / 9007199254740992.0;
}

static inline double siddha_normal(struct siddha_loop *s)
{
    return sqrt(-2 * log(siddha_uniform(s))) * cos(6.283185307179586 * siddha_uniform(s));
}

/* A sample: y is measured, u computed from it, and both paths go on. */
static inline void siddha_step(struct siddha_loop *s, double r, double d)
{
    double a = exp(-SIDDHA_TS / 0.4), b = exp(-SIDDHA_TS / siddha_case[s->regime].lag);
    s->y = s->xp + s->xd + s->noise_sd * siddha_normal(s);
    s->integral += SIDDHA_GAIN * SIDDHA_TS / SIDDHA_TI * (r - s->y);
    s->u_fb = SIDDHA_GAIN * (r - s->y) + s->integral;
    s->ff = (s->lag / SIDDHA_TS * s->ff + s->k * (s->lead / SIDDHA_TS + 1) * d -
             s->k * s->lead / SIDDHA_TS * s->last_d) /
            (s->lag / SIDDHA_TS + 1);
    s->last_d = d;
    s->u_now = s->u_fb + s->ff;
    memmove(s->u + 1, s->u, (SIDDHA_BUFFER - 1) * sizeof s->u[0]);
    memmove(s->d + 1, s->d, (SIDDHA_BUFFER - 1) * sizeof s->d[0]);
    s->u[0] = s->u_now;
    s->d[0] = d;
    s->xp = a * s->xp + s->process_gain * (1 - a) * s->u[s->process_dead];
    s->xd = b * s->xd + 2 * (1 - b) * s->d[siddha_case[s->regime].dead];
}

/* +1 in the first half of each period, then -1. */
static inline double siddha_square(double t, double period)
{
    return fmod(t + 1e-9, period) < period / 2 ? 1 : -1;
}

/* Responses of the two paths as sampled, w in rad/s. */
static inline double complex siddha_path(double lag, int dead, double w)
{
    double complex back = cexp(-I * w * SIDDHA_TS);
    double a = exp(-SIDDHA_TS / lag);
    return 2 * (1 - a) * back / (1 - a * back) * cexp(-I * w * SIDDHA_TS * dead);
}

static inline double complex siddha_process(double w)
{
    return siddha_path(0.4, 12, w);
}

static inline double complex siddha_disturbance(int regime, double w)
{
    return siddha_path(siddha_case[regime].lag, siddha_case[regime].dead, w);
}

static inline double complex siddha_ratio(int regime, double w)
{
    return siddha_disturbance(regime, w) / siddha_process(w);
}

static inline double complex siddha_controller(double w)
{
    return SIDDHA_GAIN * (1 + SIDDHA_TS / SIDDHA_TI / (1 - cexp(-I * w * SIDDHA_TS)));
}

static inline double complex siddha_feedforward(double k, double lead, double lag, double w)
{
    double complex s = (1 - cexp(-I * w * SIDDHA_TS)) / SIDDHA_TS;
    return k * (lead * s + 1) / (lag * s + 1);
}

#endif
