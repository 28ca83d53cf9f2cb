#include "num/ud.h"

void ud_set_diagonal(real_t *ud, size_t n, const real_t *p)
{
    for (size_t j = 0; j < n; j++) {
        for (size_t i = 0; i < j; i++)
            *ud++ = 0;
        *ud++ = p[j];
    }
}

real_t ud_project(const real_t *ud, size_t n, const real_t *phi, real_t *f, real_t *g)
{
    real_t variance = 0;
    for (size_t j = 0; j < n; j++) {
        const real_t *p = phi;
        real_t sum = phi[j];
        for (const real_t *end = ud + j; ud < end;)
            sum += *ud++ * *p++;
        f[j] = sum;
        g[j] = *ud++ * sum;
        variance += sum * g[j];
    }
    return variance;
}

real_t ud_correct(real_t *ud, size_t n, const real_t *f, real_t *g, real_t r, real_t growth)
{
    real_t alpha = r, inverse = 1 / r;
    for (size_t j = 0; j < n; j++) {
        real_t own = g[j], lambda = -f[j] * inverse, before = alpha;
        alpha += f[j] * own;
        inverse = 1 / alpha;
        real_t *b = g; /* P phi of the columns before this one */
        for (real_t *end = ud + j; ud < end; b++) {
            real_t u = *ud;
            *ud++ = u + *b * lambda;
            *b += u * own;
        }
        *ud++ *= before * inverse * growth;
    }
    return alpha;
}

/* The smallest D still has to be a number with all its digits. */
#define D_LEAST REAL_C(1e-30)

void ud_add(real_t *ud, size_t n, real_t c, real_t *v)
{
    for (size_t j = n; j-- > 0;) {
        real_t *column = ud + ud_count(j), p = v[j], d = column[j], sum = d + c * p * p;
        if (!(sum > D_LEAST))
            continue;
        real_t share = c * p / sum;
        for (size_t i = 0; i < j; i++) {
            v[i] -= p * column[i];
            column[i] += share * v[i];
        }
        column[j] = sum;
        c *= d / sum;
    }
}

void ud_scale(real_t *ud, size_t n, real_t factor)
{
    for (size_t j = 0; j < n; j++)
        ud[ud_count(j) + j] *= factor;
}

/* x = U x, then x = U'x: in place. */
static void multiply_upper(const real_t *ud, size_t n, real_t *x)
{
    for (size_t j = 0; j < n; j++, ud += j)
        for (size_t i = 0; i < j; i++)
            x[i] += ud[i] * x[j];
}

void ud_multiply(const real_t *ud, size_t n, const real_t *x, real_t *y)
{
    for (size_t j = n; j-- > 0;) {
        const real_t *column = ud + ud_count(j);
        real_t sum = x[j];
        for (size_t i = 0; i < j; i++)
            sum += column[i] * x[i];
        y[j] = column[j] * sum;
    }
    multiply_upper(ud, n, y);
}

void ud_solve(const real_t *ud, size_t n, const real_t *x, real_t *y)
{
    for (size_t j = 0; j < n; j++)
        y[j] = x[j];
    for (size_t j = n; j-- > 0;)
        for (size_t i = 0; i < j; i++)
            y[i] -= ud[ud_count(j) + i] * y[j];
    for (size_t j = 0; j < n; j++)
        y[j] /= ud[ud_count(j) + j];
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < j; i++)
            y[j] -= ud[ud_count(j) + i] * y[i];
}

real_t ud_element(const real_t *ud, size_t n, size_t i, size_t j)
{
    size_t first = i > j ? i : j;
    real_t sum = 0;
    for (size_t k = first; k < n; k++) {
        const real_t *column = ud + ud_count(k);
        sum += (i == k ? 1 : column[i]) * (j == k ? 1 : column[j]) * column[k];
    }
    return sum;
}

real_t ud_trace(const real_t *ud, size_t n)
{
    real_t trace = 0;
    for (size_t j = 0; j < n; j++) {
        real_t squares = 1;
        for (size_t i = 0; i < j; i++, ud++)
            squares += *ud * *ud;
        trace += *ud++ * squares;
    }
    return trace;
}

void ud_extremes(const real_t *ud, size_t n, real_t *least, real_t *most)
{
    *least = *most = ud[0];
    for (size_t j = 1; j < n; j++) {
        real_t d = ud[ud_count(j) + j];
        *least = d < *least ? d : *least;
        *most = d > *most ? d : *most;
    }
}

bool ud_clamp(real_t *ud, size_t n, real_t lo, real_t hi)
{
    bool had_to = false;
    for (size_t j = 0; j < n; j++) {
        real_t *d = &ud[ud_count(j) + j];
        if (real_within(*d, lo, hi))
            continue;
        *d = *d > hi ? hi : lo;
        had_to = true;
    }
    return had_to;
}
