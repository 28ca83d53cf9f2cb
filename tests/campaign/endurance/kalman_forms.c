/* The covariance as a matrix in single precision, as textbooks print it, and the reference: the same in double with one half kept. */
#include <math.h>
#include <string.h>

#include "kalman.h"

static void symmetrise(struct dense_float *d, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            d->p[i][j] = d->p[j][i] = 0.5f * (d->p[i][j] + d->p[j][i]);
}

static bool is_symmetric(enum kalman_form form)
{
    return form == DENSE_SYMMETRIC || form == JOSEPH_SYMMETRIC;
}

/* A P A' + Q as two products. a is A transposed. */
void dense_carry(struct dense_float *d, enum kalman_form form, const struct kalman_course *c)
{
    static float ap[KALMAN_STATES][KALMAN_STATES];
    size_t all = c->all;
    for (size_t k = 0; k < c->step.noise_count; k++) {
        size_t i = (c->step.noise_first + k) % c->n;
        d->p[i][i] += c->step.noise[i];
    }
    memset(ap, 0, sizeof ap);
    for (size_t l = 0; l < all; l++)
        for (size_t i = 0; i < all; i++) {
            float part = c->actual->a[l][i];
            for (size_t j = 0; j < all && part != 0; j++)
                ap[i][j] += part * d->p[l][j];
        }
    memset(d->p, 0, sizeof d->p);
    for (size_t i = 0; i < all; i++)
        for (size_t l = 0; l < all; l++) {
            float part = ap[i][l];
            for (size_t j = 0; j < all; j++)
                d->p[i][j] += part * c->actual->a[l][j];
        }
    for (size_t e = 0; e < KALMAN_EXTRAS; e++)
        d->p[c->n + e][c->n + e] += c->step.grown[e];
    if (is_symmetric(form))
        symmetrise(d, all);
}

static void slopes_of(const struct kalman_course *c, const struct covariance_measurement *z,
                      float *h)
{
    memset(h, 0, c->all * sizeof *h);
    for (size_t i = 0; i < z->count; i++)
        h[z->first + i] = z->slope[i];
    if (z->extra < KALMAN_EXTRAS)
        h[c->n + z->extra] = z->extra_slope;
}

/* P <- (I - K h) P, and for Joseph's form that times (I - K h)' + K r K'. */
float dense_take(struct dense_float *d, enum kalman_form form, const struct kalman_course *c,
                 const struct covariance_measurement *z, float *gain)
{
    float h[KALMAN_STATES], hp[KALMAN_STATES], alpha = z->variance;
    size_t all = c->all;
    slopes_of(c, z, h);
    for (size_t i = 0; i < all; i++) {
        float sum = 0;
        for (size_t j = 0; j < all; j++)
            sum += d->p[i][j] * h[j];
        gain[i] = sum;
        alpha += h[i] * sum;
    }
    for (size_t j = 0; j < all; j++) {
        hp[j] = 0;
        gain[j] /= alpha;
    }
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j < all && h[i] != 0; j++)
            hp[j] += h[i] * d->p[i][j];
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j < all; j++)
            d->p[i][j] -= gain[i] * hp[j];
    if (form == JOSEPH_PRINTED || form == JOSEPH_SYMMETRIC)
        for (size_t i = 0; i < all; i++) {
            float sum = 0;
            for (size_t j = 0; j < all; j++)
                sum += d->p[i][j] * h[j];
            for (size_t j = 0; j < all; j++)
                d->p[i][j] = d->p[i][j] - sum * gain[j] + gain[i] * z->variance * gain[j];
        }
    if (is_symmetric(form))
        symmetrise(d, all);
    return alpha;
}

/* ---- in double ---- */

/* Phi by its factors, and what extras push, for a vector of all states. */
static void reference_apply(const struct kalman_course *c, double *v)
{
    const struct column_transition *t = &c->actual->transition;
    double w[2] = {0}, a, b;
    for (size_t e = 0; e < KALMAN_EXTRAS; e++) {
        for (size_t i = 0; i < c->n; i++)
            v[i] += (double)c->step.push[e * c->n + i] * v[c->n + e];
        v[c->n + e] *= (double)c->step.keep[e];
    }
    for (size_t s = c->stages; s-- > 0;) {
        const real_t *p = t->factors + 14 * s;
        double *here = v + 2 * s, l = s + 1 < c->stages ? (double)p[12] : 0;
        a = here[0] + (l != 0 ? l * here[2] : 0);
        b = here[1] + (l != 0 ? l * here[3] : 0);
        here[0] = (double)p[0] * a + (double)p[1] * b;
        here[1] = (double)p[2] * a + (double)p[3] * b;
    }
    for (size_t s = 0; s < c->stages; s++) {
        const real_t *p = t->factors + 14 * s;
        double *here = v + 2 * s;
        here[0] += (double)p[4] * w[0] + (double)p[5] * w[1];
        here[1] += (double)p[6] * w[0] + (double)p[7] * w[1];
        a = (double)p[13] * w[0] + (double)p[8] * here[0] + (double)p[9] * here[1];
        b = (double)p[13] * w[1] + (double)p[10] * here[0] + (double)p[11] * here[1];
        w[0] = a;
        w[1] = b;
    }
}

static void transpose(struct dense_double *d, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++) {
            double kept = d->p[i][j];
            d->p[i][j] = d->p[j][i];
            d->p[j][i] = kept;
        }
}

void reference_carry(struct dense_double *d, const struct kalman_course *c)
{
    for (size_t k = 0; k < c->step.noise_count; k++) {
        size_t i = (c->step.noise_first + k) % c->n;
        d->p[i][i] += (double)c->step.noise[i];
    }
    for (unsigned side = 0; side < 2; side++) {
        for (size_t i = 0; i < c->all; i++)
            reference_apply(c, d->p[i]);
        transpose(d, c->all);
    }
    for (size_t i = 0; i < c->all; i++)
        for (size_t j = 0; j < i; j++)
            d->p[i][j] = d->p[j][i] = 0.5 * (d->p[i][j] + d->p[j][i]);
    for (size_t e = 0; e < KALMAN_EXTRAS; e++)
        d->p[c->n + e][c->n + e] += (double)c->step.grown[e];
}

/* Joseph's form on one half. */
double reference_take(struct dense_double *d, const struct kalman_course *c,
                      const struct covariance_measurement *z, double *gain)
{
    float h[KALMAN_STATES];
    double alpha = (double)z->variance, ph[KALMAN_STATES], left[KALMAN_STATES];
    slopes_of(c, z, h);
    for (size_t i = 0; i < c->all; i++) {
        ph[i] = 0;
        for (size_t j = 0; j < c->all; j++)
            if (h[j] != 0)
                ph[i] += d->p[i][j] * (double)h[j];
        alpha += (double)h[i] * ph[i];
    }
    double rest = (double)z->variance / alpha; /* what is left of h P h', over h P h' */
    for (size_t i = 0; i < c->all; i++) {
        gain[i] = ph[i] / alpha;
        left[i] = ph[i] * rest; /* (I - K h) P h' */
    }
    for (size_t i = 0; i < c->all; i++)
        for (size_t j = 0; j <= i; j++)
            d->p[i][j] = d->p[j][i] = d->p[i][j] - gain[i] * ph[j] - left[i] * gain[j] +
                                      gain[i] * (double)z->variance * gain[j];
    return alpha;
}

static bool is_positive(const struct dense_double *d, size_t n, double shift)
{
    static struct dense_double w;
    w = *d;
    for (size_t j = n; j-- > 0;) {
        double own = w.p[j][j] + shift;
        if (!(own > 0))
            return false;
        for (size_t i = 0; i < j; i++) {
            double u = w.p[j][i] / own;
            for (size_t k = 0; k <= i; k++)
                w.p[i][k] -= u * w.p[j][k];
        }
    }
    return true;
}

double negative_of(const struct dense_double *d, size_t n)
{
    double most = 0, low = 1e-30, high;
    if (is_positive(d, n, 0))
        return 0;
    for (size_t i = 0; i < n; i++) { /* Gershgorin */
        double sum = 0;
        for (size_t j = 0; j < n; j++)
            sum += fabs(d->p[i][j]);
        most = fmax(most, sum);
    }
    for (high = most; high > 1.1 * low;) {
        double middle = sqrt(low * high);
        if (is_positive(d, n, middle))
            high = middle;
        else
            low = middle;
    }
    return -high;
}
