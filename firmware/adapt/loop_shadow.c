#include "adapt/loop_shadow.h"

#include <string.h>

#include "num/real_trig.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define DEAD_TRIALS 64u
#define REFINES     12u
#define LOST        REAL_C(8.0) /* spans */

/* Sum of squares of the relative distances. */
static real_t distance_squares(const real_t *omega, const struct cplx *g, unsigned points,
                               const struct shadow_model *m)
{
    real_t sum = ZERO;
    for (unsigned i = 0; i < points; i++) {
        real_t sine, cosine;
        real_sincos(omega[i] * m->dead_s, &sine, &cosine);
        struct cplx is =
            cplx_div(cplx(m->gain * cosine, -m->gain * sine), cplx(ONE, omega[i] * m->lag_s));
        sum += cplx_square(cplx_sub(is, g[i])) / cplx_square(g[i]);
    }
    return sum;
}

/* |G|^2 (c0 + c1 w^2) = 1 in the least squares, c1 not below 0. */
static enum err fit_size(const real_t *omega, const struct cplx *g, unsigned points, real_t *gain,
                         real_t *lag)
{
    real_t aa = ZERO, ab = ZERO, bb = ZERO, a1 = ZERO, b1 = ZERO;
    for (unsigned i = 0; i < points; i++) {
        real_t relative = omega[i] / omega[points - 1u];
        real_t a = cplx_square(g[i]) / cplx_square(g[0]), b = a * relative * relative;
        aa += a * a;
        ab += a * b;
        bb += b * b;
        a1 += a;
        b1 += b;
    }
    real_t det = aa * bb - ab * ab;
    if (!(aa > ZERO) || !(det > ZERO))
        return ERR_SINGULAR;
    real_t c0 = (a1 * bb - b1 * ab) / det, c1 = (b1 * aa - a1 * ab) / det;
    if (c1 < ZERO) {
        c1 = ZERO;
        c0 = a1 / aa;
    }
    if (!(c0 > REAL_C(1e-4)))
        return ERR_SINGULAR; /* it integrates, as far as the grid tells */
    *gain = cplx_abs(g[0]) / real_sqrt(c0);
    *lag = real_sqrt(c1 / c0) / omega[points - 1u];
    return ERR_OK;
}

enum err shadow_fit(const real_t *omega, const struct cplx *g, unsigned points, real_t sign,
                    real_t dead_most, struct shadow_model *m)
{
    struct shadow_model best = {0};
    if (points < 2)
        return ERR_SINGULAR;
    for (unsigned i = 0; i < points; i++)
        if (!(cplx_square(g[i]) > REAL_C(1e-20)))
            return ERR_SINGULAR;
    enum err err = fit_size(omega, g, points, &best.gain, &best.lag_s);
    if (err)
        return err;
    best.gain *= sign;
    real_t least = distance_squares(omega, g, points, &best),
           width = dead_most / (real_t)DEAD_TRIALS;
    for (unsigned k = 1; k <= DEAD_TRIALS; k++) {
        struct shadow_model trial = best;
        trial.dead_s = width * (real_t)k;
        real_t j = distance_squares(omega, g, points, &trial);
        if (j < least) {
            least = j;
            best.dead_s = trial.dead_s;
        }
    }
    for (unsigned k = 0; k < REFINES; k++) {
        width *= REAL_C(0.5);
        for (int side = -1; side <= 1; side += 2) {
            struct shadow_model trial = best;
            trial.dead_s += (real_t)side * width;
            real_t j = trial.dead_s < ZERO ? least : distance_squares(omega, g, points, &trial);
            if (j < least) {
                least = j;
                best = trial;
            }
        }
    }
    best.off = real_sqrt(least / (real_t)points);
    *m = best;
    return ERR_OK;
}

void shadow_begin(struct loop_shadow *s, const struct shadow_model *m, real_t gain, real_t ti_s,
                  real_t h_s)
{
    memset(s, 0, sizeof *s);
    s->decay = m->lag_s > ZERO ? real_exp(-h_s / m->lag_s) : ZERO;
    s->into = m->gain * (ONE - s->decay);
    s->gain = gain;
    s->integral_share = ti_s > ZERO ? gain * h_s / ti_s : ZERO;
    /* A held input is late by half a sample, which the fit has counted as dead time. */
    real_t samples = m->dead_s / h_s - REAL_C(0.5);
    samples = samples < ZERO ? ZERO : samples;
    samples = samples > (real_t)(SHADOW_REACH - 2u) ? (real_t)(SHADOW_REACH - 2u) : samples;
    s->dead = (uint8_t)samples;
    s->fraction = samples - (real_t)s->dead;
}

real_t shadow_step(struct loop_shadow *s, real_t v)
{
    real_t y = s->x;
    if (s->lost)
        return ZERO;
    memmove(s->u + 1, s->u, (SHADOW_REACH - 1u) * sizeof s->u[0]);
    s->u[0] = v - s->gain * y + s->integral;
    s->integral -= s->integral_share * y;
    s->x = s->decay * s->x +
           s->into * (s->u[s->dead] + s->fraction * (s->u[s->dead + 1u] - s->u[s->dead]));
    s->lost = !real_within(s->x, -LOST, LOST);
    return y;
}
