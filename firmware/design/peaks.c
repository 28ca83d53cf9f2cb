#include "design/peaks.h"

#include <string.h>

#include "base/assertion.h"

#define NOTED       REAL_C(1.1)  /* sensitivities below it are no peaks */
#define ACTS_S      REAL_C(0.15) /* |S| and |T| from which on a loop acts, and up to which */
#define ACTS_T      REAL_C(0.1)
#define VERTEX_MOST REAL_C(0.1) /* a parabola adds no more than this part */

void peaks_begin(struct peaks *p, uint8_t loops)
{
    REFLUX_ASSERT(loops <= INTERACT_MAX);
    memset(p, 0, sizeof *p);
    p->loops = loops;
    for (size_t k = 0; k < loops; k++)
        p->t[k] = REAL_C(1.0); /* at frequency 0: every loop integrates */
}

void peaks_values(const struct clu *lu, struct peaks_point *point)
{
    REFLUX_ASSERT(lu->n <= INTERACT_MAX);
    struct cplx s[INTERACT_MAX];
    clu_inverse_diagonal(lu, s);
    for (size_t k = 0; k < lu->n; k++) {
        point->s[k] = cplx_abs(s[k]);
        point->t[k] = cplx_abs(cplx(REAL_C(1.0) - s[k].re, -s[k].im));
    }
}

static real_t larger_change(real_t largest, real_t last, real_t value)
{
    real_t of = last > value ? last : value;
    real_t change = of > NOTED ? real_abs(value - last) / of : REAL_C(0.0);
    return change > largest ? change : largest;
}

real_t peaks_change(const struct peaks *p, const struct peaks_point *point)
{
    real_t change = REAL_C(0.0);
    if (p->points == 0)
        return change;
    for (size_t k = 0; k < p->loops; k++) {
        change = larger_change(change, p->last.s[k], point->s[k]);
        change = larger_change(change, p->last.t[k], point->t[k]);
    }
    return change;
}

/* Largest value of the parabola through three points where the middle one is the highest; else the last value. */
static real_t vertex(const real_t x[3], real_t before, real_t last, real_t value)
{
    if (!(last >= before && last >= value))
        return value;
    real_t rise = (last - before) / (x[1] - x[0]), fall = (value - last) / (x[2] - x[1]);
    real_t bend = (fall - rise) / (x[2] - x[0]);
    if (!(bend < REAL_C(0.0)))
        return last;
    real_t slope = rise + bend * (x[1] - x[0]);
    real_t more = REAL_C(-0.25) * slope * slope / bend;
    return last + (more < VERTEX_MOST * last ? more : VERTEX_MOST * last);
}

void peaks_keep(struct peaks *p, const struct peaks_point *point, real_t omega)
{
    real_t x[3] = {p->before_log, p->last_log, real_log(omega)};
    for (size_t k = 0; k < p->loops; k++) {
        real_t s = point->s[k], t = point->t[k];
        if (s > ACTS_S && p->omega_lo <= REAL_C(0.0))
            p->omega_lo = omega;
        if (t > ACTS_T)
            p->omega_hi = omega;
        if (p->points > 1) {
            s = vertex(x, p->before.s[k], p->last.s[k], s);
            t = vertex(x, p->before.t[k], p->last.t[k], t);
        }
        p->s[k] = s > p->s[k] ? s : p->s[k];
        p->t[k] = t > p->t[k] ? t : p->t[k];
    }
    p->before = p->last;
    p->before_log = p->last_log;
    p->last = *point;
    p->last_log = x[2];
    p->points = p->points < 2 ? (uint8_t)(p->points + 1u) : p->points;
}

real_t peaks_excess(const struct peaks *p, real_t s_most, real_t t_most, uint8_t *loop)
{
    real_t worst = REAL_C(0.0);
    for (uint8_t k = 0; k < p->loops; k++) {
        real_t s = p->s[k] / s_most, t = p->t[k] / t_most, larger = s > t ? s : t;
        if (larger <= worst)
            continue;
        worst = larger;
        if (loop)
            *loop = k;
    }
    return worst;
}
