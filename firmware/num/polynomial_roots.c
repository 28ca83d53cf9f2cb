/* Finds the zeros of a polynomial (num/polynomial.h). */
#include <stddef.h>

#include "num/polynomial.h"
#include "num/real_trig.h"

#define HUGE_RADIUS REAL_C(1e18)
#define ROOT_LEAST  REAL_C(1e-9)
#define ROOT_MOST   REAL_C(1e9)

/* The polynomial at z. For |z| > 1 value, rounding and slope have a common factor. */
struct local {
    struct cplx newton;            /* p/p' */
    real_t value, rounding, slope; /* |p|, the bound of its rounding, |p'| */
};

/* Evaluates q(x) = sum c[k] x^k over n + 1 coefficients, forwards or backwards. |x| <= 1, so nothing overflows. */
static void evaluate_within(const real_t *c, unsigned n, bool backwards, struct cplx x,
                            struct cplx *value, struct cplx *slope, real_t *size)
{
    real_t r = cplx_abs(x);
    *value = *slope = cplx(REAL_C(0.0), REAL_C(0.0));
    *size = REAL_C(0.0);
    for (unsigned k = n + 1; k-- > 0;) {
        real_t next = c[backwards ? n - k : k];
        *slope = cplx_add(cplx_mul(*slope, x), *value);
        *value = cplx_mul(*value, x);
        value->re += next;
        *size = *size * r + real_abs(next);
    }
}

/* Evaluates the polynomial at z. Outside the unit circle p(z) = z^n q(y) with y = 1/z, and p'(z) = z^(n-1) (n q(y) - y q'(y)). */
static void look_near(const real_t *c, unsigned n, struct cplx z, struct local *at)
{
    bool outside = cplx_square(z) > REAL_C(1.0);
    struct cplx x = outside ? cplx_div(cplx(REAL_C(1.0), REAL_C(0.0)), z) : z, value, slope;
    real_t size;
    evaluate_within(c, n, outside, x, &value, &slope, &size);
    if (outside) {
        slope = cplx_mul(x, cplx_sub(cplx_scale(value, (real_t)n), cplx_mul(x, slope)));
    }
    at->value = cplx_abs(value);
    at->slope = cplx_abs(slope);
    /* Bound for Horner's scheme with complex numbers: Higham, Accuracy and Stability of Numerical Algorithms, 5.1 and 3.6. One
     * REAL_EPSILON of it is for the coefficients themselves. */
    at->rounding = (real_t)(4u * n + 1u) * REAL_EPSILON * size;
    at->newton =
        at->slope > REAL_C(1e-18) ? cplx_div(value, slope) : cplx(HUGE_RADIUS, REAL_C(0.0));
}

/* Puts the first points on circles from the upper hull of the points (k, log |c[k]|), on each as many as its edge is long (Bini
 * 1996). The points are turned, so that they have no symmetry to an axis. */
static void begin_roots(const real_t *c, unsigned n, struct polynomial_roots *roots)
{
    real_t size[POLYNOMIAL_MOST];
    for (unsigned k = 0; k <= n; k++)
        size[k] = c[k] != REAL_C(0.0) ? real_log(real_abs(c[k])) : -HUGE_RADIUS;
    for (unsigned from = 0; from < n;) {
        unsigned to = from + 1;
        for (unsigned k = from + 2; k <= n; k++)
            if ((size[k] - size[from]) * (real_t)(to - from) >=
                (size[to] - size[from]) * (real_t)(k - from))
                to = k;
        real_t radius = real_exp((size[from] - size[to]) / (real_t)(to - from));
        radius = radius < ROOT_LEAST ? ROOT_LEAST : radius > ROOT_MOST ? ROOT_MOST : radius;
        for (unsigned k = from; k < to; k++) {
            real_t sine, cosine;
            real_sincos(REAL_C(6.283185307179586) * ((real_t)(k - from) / (real_t)(to - from) +
                                                     (real_t)from / (real_t)n) +
                            REAL_C(0.7),
                        &sine, &cosine);
            roots->value[k] = cplx(radius * cosine, radius * sine);
        }
        from = to;
    }
}

static struct cplx keep_root_in_range(struct cplx z)
{
    real_t most = real_abs(z.re) > real_abs(z.im) ? real_abs(z.re) : real_abs(z.im);
    if (most > ROOT_MOST)
        return cplx_scale(z, ROOT_MOST / most);
    return most < ROOT_LEAST ? cplx(ROOT_LEAST, REAL_C(0.0)) : z;
}

/* Moves zero k by Newton's step, which the other zeros repel. Returns true when the zero is found. */
static bool move_root(const real_t *c, unsigned n, struct polynomial_roots *roots, unsigned k)
{
    struct local at;
    struct cplx repulsion = cplx(REAL_C(0.0), REAL_C(0.0)), z = roots->value[k];
    look_near(c, n, z, &at);
    if (at.value <= at.rounding)
        return true;
    for (unsigned j = 0; j < n; j++) {
        struct cplx apart = cplx_sub(z, roots->value[j]);
        if (j != k && cplx_square(apart) > REAL_C(1e-30))
            repulsion = cplx_add(repulsion, cplx_div(cplx(REAL_C(1.0), REAL_C(0.0)), apart));
    }
    struct cplx down = cplx_sub(cplx(REAL_C(1.0), REAL_C(0.0)), cplx_mul(at.newton, repulsion));
    struct cplx step = cplx_square(down) > REAL_C(1e-12) ? cplx_div(at.newton, down) : at.newton;
    real_t long_step = REAL_C(1.0) + REAL_C(2.0) * cplx_abs(z), size = cplx_abs(step);
    if (!(size <= long_step))
        step =
            size < HUGE_RADIUS ? cplx_scale(step, long_step / size) : cplx(long_step, REAL_C(0.0));
    roots->value[k] = keep_root_in_range(cplx_sub(z, step));
    return cplx_square(step) <= REAL_EPSILON * REAL_EPSILON * cplx_square(z);
}

static void find_radii(const real_t *c, unsigned n, struct polynomial_roots *roots)
{
    for (unsigned k = 0; k < n; k++) {
        struct local at;
        look_near(c, n, roots->value[k], &at);
        real_t top = (real_t)n * (at.value + at.rounding);
        roots->radius[k] =
            at.slope > REAL_C(1e-18) && top < HUGE_RADIUS * at.slope ? top / at.slope : HUGE_RADIUS;
    }
}

enum err polynomial_find_roots(const struct polynomial *p, struct polynomial_roots *roots)
{
    struct polynomial q = *p;
    roots->n = roots->sweeps = 0;
    enum err err = polynomial_check(p);
    if (err)
        return err;
    polynomial_trim(&q);
    if (!q.n)
        return ERR_RANGE;
    unsigned at_zero = polynomial_delay(&q), n = q.n - 1u - at_zero;
    polynomial_advance(&q, at_zero);
    roots->n = (uint8_t)(n + at_zero);
    for (unsigned k = n; k < roots->n; k++) {
        roots->value[k] = cplx(REAL_C(0.0), REAL_C(0.0));
        roots->radius[k] = REAL_C(0.0);
    }
    if (!n)
        return ERR_OK;
    /* Scales the coefficients to magnitudes of about 1, on which no zero depends. */
    real_t scale = REAL_C(1.0) / polynomial_size(&q);
    for (unsigned k = 0; k <= n; k++)
        q.value[k] *= scale;
    if (q.value[0] == REAL_C(0.0) || q.value[n] == REAL_C(0.0))
        return ERR_NOT_FINITE;
    begin_roots(q.value, n, roots);
    bool moving = true;
    while (moving && roots->sweeps < POLYNOMIAL_SWEEPS) {
        moving = false;
        roots->sweeps++;
        for (unsigned k = 0; k < n; k++)
            if (!move_root(q.value, n, roots, k))
                moving = true;
    }
    find_radii(q.value, n, roots);
    return moving ? ERR_TIMEOUT : ERR_OK;
}
