#include "num/ud.h"

#include "base/assertion.h"

void ud_set_diagonal(real_t *ud, size_t n, const real_t *p)
{
    for (size_t j = 0; j < n; j++) {
        for (size_t i = 0; i < j; i++)
            *ud++ = 0;
        *ud++ = p[j];
    }
}

/* The next two functions take most of the time. They take two columns at a time, so that the elements of the vector are read and
 * written once for both, and the inner loops have an even length. A fused multiplication and addition is one instruction instead
 * of two. tests/bench/results.md has counts. */

void ud_project(const real_t *ud, size_t n, const real_t *phi, real_t *f, real_t *g)
{
    size_t j = 0;
    for (; j + 1 < n; j += 2) {
        const real_t *second = ud + j + 1, *p = phi;
        real_t sum = phi[j], next = phi[j + 1];
        for (const real_t *end = phi + j; p < end; p += 2, ud += 2, second += 2) {
            sum = real_fma(ud[0], p[0], sum);
            next = real_fma(second[0], p[0], next);
            sum = real_fma(ud[1], p[1], sum);
            next = real_fma(second[1], p[1], next);
        }
        next = real_fma(second[0], p[0], next);
        real_t own = ud[0] * sum, next_own = second[1] * next;
        f[j] = sum;
        f[j + 1] = next;
        g[j] = own;
        g[j + 1] = next_own;
        ud = second + 2;
    }
    if (j < n) {
        real_t sum = phi[j];
        for (const real_t *p = phi, *end = phi + j; p < end; p += 2, ud += 2)
            sum = real_fma(ud[1], p[1], real_fma(ud[0], p[0], sum));
        f[j] = sum;
        g[j] = *ud * sum;
    }
}

/* Corrects an element of U and one of P phi. */
#define CORRECT(u, gain, lambda, own)                                                              \
    do {                                                                                           \
        real_t old = (u);                                                                          \
        (u) = real_fma((gain), (lambda), old);                                                     \
        (gain) = real_fma(old, (own), (gain));                                                     \
    } while (0)

real_t ud_correct_from(real_t *ud, size_t n, size_t from, const real_t *f, real_t *g, real_t r,
                       real_t growth)
{
    REFLUX_ASSERT(from <= n);
    real_t alpha = r, inverse = 1 / r;
    size_t j = from & ~(size_t)1;
    for (ud += ud_count(j); j + 1 < n; j += 2) {
        real_t *first = ud, *second = ud + j + 1, *b = g;
        real_t own = g[j], lambda = -f[j] * inverse, before = alpha * growth;
        alpha = real_fma(f[j], own, alpha);
        inverse = 1 / alpha;
        real_t factor = before * inverse;
        real_t next = g[j + 1], next_lambda = -f[j + 1] * inverse, between = alpha * growth;
        alpha = real_fma(f[j + 1], next, alpha);
        inverse = 1 / alpha;
        for (real_t *end = g + j; b < end; b += 2, first += 2, second += 2) {
            real_t gain = b[0];
            CORRECT(first[0], gain, lambda, own);
            CORRECT(second[0], gain, next_lambda, next);
            b[0] = gain;
            gain = b[1];
            CORRECT(first[1], gain, lambda, own);
            CORRECT(second[1], gain, next_lambda, next);
            b[1] = gain;
        }
        CORRECT(second[0], own, next_lambda, next);
        b[0] = own;
        *first *= factor;
        second[1] *= between * inverse;
        ud = second + 2;
    }
    if (j < n) {
        real_t *b = g, own = g[j], lambda = -f[j] * inverse, before = alpha * growth;
        alpha = real_fma(f[j], own, alpha);
        for (real_t *end = g + j; b < end; b += 2, ud += 2) {
            CORRECT(ud[0], b[0], lambda, own);
            CORRECT(ud[1], b[1], lambda, own);
        }
        *ud *= before / alpha;
    }
    return alpha;
}

/* Smallest D, which must still be a number with all its digits. */
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

/* State of an addition of rank one that goes from the last column to the first. */
struct addition {
    real_t c, less, share; /* v_i += less * U_ij, U_ij += share * v_i */
};

/* Takes the addition to column j, whose diagonal element is *d and whose element of v is p. */
static void add_to_diagonal(struct addition *a, real_t *d, real_t p)
{
    real_t sum = real_fma(a->c * p, p, *d), inverse = 1 / sum;
    a->less = -p;
    a->share = a->c * p * inverse;
    a->c *= *d * inverse;
    *d = sum;
}

#define ADD(u, own, less, share)                                                                   \
    do {                                                                                           \
        (own) = real_fma((less), (u), (own));                                                      \
        (u) = real_fma((share), (own), (u));                                                       \
    } while (0)

/* Begins the addition at the column of the unit vector itself. */
static void add_begin(real_t *column, size_t at, real_t c, real_t *v, struct addition *a)
{
    a->c = c;
    add_to_diagonal(a, &column[at], 1);
    for (size_t i = 0; i < at; i++) {
        v[i] = -column[i];
        column[i] = real_fma(a->share, v[i], column[i]);
    }
}

static void add_column(real_t *column, size_t j, real_t *v, struct addition *a)
{
    add_to_diagonal(a, &column[j], v[j]);
    for (size_t i = 0; i < j; i++)
        ADD(column[i], v[i], a->less, a->share);
}

void ud_add_at(real_t *ud, size_t at, real_t c, real_t *v)
{
    struct addition a, next;
    size_t j = at;
    add_begin(ud + ud_count(at), at, c, v, &a);
    if (j & 1) {
        j--;
        add_column(ud + ud_count(j), j, v, &a);
    }
    for (; j > 0; j -= 2) {
        real_t *second = ud + ud_count(j - 2), *first = second + j - 1, *p = v;
        add_to_diagonal(&a, &first[j - 1], v[j - 1]);
        ADD(first[j - 2], v[j - 2], a.less, a.share);
        next = a;
        add_to_diagonal(&next, &second[j - 2], v[j - 2]);
        real_t less = a.less, share = a.share, next_less = next.less, next_share = next.share;
        for (const real_t *end = v + j - 2; p < end; p += 2, first += 2, second += 2) {
            real_t own = p[0], other = p[1];
            ADD(first[0], own, less, share);
            ADD(first[1], other, less, share);
            ADD(second[0], own, next_less, next_share);
            ADD(second[1], other, next_less, next_share);
            p[0] = own;
            p[1] = other;
        }
        a = next;
    }
}

/* Handles one row of two columns and two vectors. */
#define ADD_FOUR(v, w, u, next)                                                                    \
    do {                                                                                           \
        real_t own = (v), other = (w), element = (u);                                              \
        ADD(element, own, less_a, share_a);                                                        \
        ADD(element, other, less_b, share_b);                                                      \
        (u) = element;                                                                             \
        element = (next);                                                                          \
        ADD(element, own, next_less_a, next_share_a);                                              \
        ADD(element, other, next_less_b, next_share_b);                                            \
        (next) = element;                                                                          \
        (v) = own;                                                                                 \
        (w) = other;                                                                               \
    } while (0)

/* Takes two columns at a time, as above, and two vectors. */
void ud_add_pair(real_t *ud, size_t at, real_t c, real_t below, real_t *v)
{
    REFLUX_ASSERT(at >= 1);
    struct addition a, b, next_a, next_b;
    real_t *w = v + at;
    size_t j = at - 1;
    add_begin(ud + ud_count(at), at, c, v, &a);
    add_column(ud + ud_count(j), j, v, &a);
    add_begin(ud + ud_count(j), j, below, w, &b);
    if (j & 1) {
        j--;
        add_column(ud + ud_count(j), j, v, &a);
        add_column(ud + ud_count(j), j, w, &b);
    }
    for (; j > 0; j -= 2) {
        real_t *second = ud + ud_count(j - 2), *first = second + j - 1, *p = v, *q = w;
        real_t *corner = &first[j - 2];
        add_to_diagonal(&a, &first[j - 1], v[j - 1]);
        ADD(*corner, v[j - 2], a.less, a.share);
        add_to_diagonal(&b, &first[j - 1], w[j - 1]);
        ADD(*corner, w[j - 2], b.less, b.share);
        next_a = a;
        next_b = b;
        add_to_diagonal(&next_a, &second[j - 2], v[j - 2]);
        add_to_diagonal(&next_b, &second[j - 2], w[j - 2]);
        real_t less_a = a.less, share_a = a.share, less_b = b.less, share_b = b.share;
        real_t next_less_a = next_a.less, next_share_a = next_a.share;
        real_t next_less_b = next_b.less, next_share_b = next_b.share;
        for (const real_t *end = v + j - 2; p < end; p += 2, q += 2, first += 2, second += 2) {
            ADD_FOUR(p[0], q[0], first[0], second[0]);
            ADD_FOUR(p[1], q[1], first[1], second[1]);
        }
        a = next_a;
        b = next_b;
    }
}

void ud_scale(real_t *ud, size_t n, real_t factor)
{
    for (size_t j = 0; j < n; j++)
        ud[ud_count(j) + j] *= factor;
}

/* Computes x = U x in place. */
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
    REFLUX_ASSERT(i < n && j < n);
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
    REFLUX_ASSERT(n >= 1);
    *least = *most = ud[0];
    for (size_t j = 1; j < n; j++) {
        real_t d = ud[ud_count(j) + j];
        *least = d < *least ? d : *least;
        *most = d > *most ? d : *most;
    }
}

bool ud_clamp(real_t *ud, size_t n, size_t j, real_t lo, real_t hi)
{
    REFLUX_ASSERT(j < n);
    real_t *d = &ud[ud_count(j) + j];
    (void)n;
    if (real_within(*d, lo, hi))
        return false;
    *d = *d > hi ? hi : lo;
    return true;
}
