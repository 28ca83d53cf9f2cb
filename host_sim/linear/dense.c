#include "linear/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PIVOT_MIN  1e-13
#define NORM_MAX   5.371920351148152 /* up to here Pade (13, 13) errs by less than half an ulp */
#define PADE_TERMS 14

void dense_multiply(size_t n, size_t k, size_t m, const double *a, const double *b, double *c)
{
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < m; j++) {
            double sum = 0.0;
            for (size_t l = 0; l < k; l++) {
                sum += a[i * k + l] * b[l * m + j];
            }
            c[i * m + j] = sum;
        }
    }
}

static void swap_rows(double *x, size_t columns, size_t i, size_t j)
{
    for (size_t c = 0; c < columns && i != j; c++) {
        double keep = x[i * columns + c];
        x[i * columns + c] = x[j * columns + c];
        x[j * columns + c] = keep;
    }
}

/* Every row divided by its largest element, so that pivots of rows in different units compare. */
static bool scale_rows(size_t n, size_t m, double *a, double *b)
{
    for (size_t i = 0; i < n; i++) {
        double largest = 0.0;
        for (size_t j = 0; j < n; j++) {
            largest = fmax(largest, fabs(a[i * n + j]));
        }
        if (!(largest > 0.0)) {
            return false;
        }
        for (size_t j = 0; j < n; j++) {
            a[i * n + j] /= largest;
        }
        for (size_t j = 0; j < m; j++) {
            b[i * m + j] /= largest;
        }
    }
    return true;
}

bool dense_solve(size_t n, size_t m, double *a, double *b)
{
    if (!scale_rows(n, m, a, b)) {
        return false;
    }
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++) {
            if (fabs(a[i * n + k]) > fabs(a[pivot * n + k])) {
                pivot = i;
            }
        }
        swap_rows(a, n, k, pivot);
        swap_rows(b, m, k, pivot);
        if (!(fabs(a[k * n + k]) > PIVOT_MIN)) {
            return false;
        }
        for (size_t i = k + 1; i < n; i++) {
            double factor = a[i * n + k] / a[k * n + k];
            for (size_t j = k; j < n && factor != 0.0; j++) {
                a[i * n + j] -= factor * a[k * n + j];
            }
            for (size_t j = 0; j < m && factor != 0.0; j++) {
                b[i * m + j] -= factor * b[k * m + j];
            }
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = 0; j < m; j++) {
            double sum = b[k * m + j];
            for (size_t i = k + 1; i < n; i++) {
                sum -= a[k * n + i] * b[i * m + j];
            }
            b[k * m + j] = sum / a[k * n + k];
        }
    }
    return true;
}

/* Scales a to d^-1 a d with powers of two until row and column norms agree: states in units far apart
 * would otherwise cost digits in the squarings. Rounding-free. */
static void balance(size_t n, double *a, double *d)
{
    for (size_t i = 0; i < n; i++) {
        d[i] = 1.0;
    }
    bool changed = true;
    for (int pass = 0; pass < 50 && changed; pass++) {
        changed = false;
        for (size_t i = 0; i < n; i++) {
            double row = 0.0, column = 0.0;
            for (size_t j = 0; j < n; j++) {
                row += j != i ? fabs(a[i * n + j]) : 0.0;
                column += j != i ? fabs(a[j * n + i]) : 0.0;
            }
            if (!(row > 0.0) || !(column > 0.0)) {
                continue;
            }
            int power = (int)lround(0.5 * log2(row / column));
            double f = ldexp(1.0, power);
            if (power == 0 || column * f + row / f > 0.95 * (column + row)) {
                continue;
            }
            changed = true;
            d[i] *= f;
            for (size_t j = 0; j < n; j++) {
                a[j * n + i] *= f;
            }
            for (size_t j = 0; j < n; j++) {
                a[i * n + j] /= f;
            }
        }
    }
}

static double norm1(size_t n, const double *a)
{
    double largest = 0.0;
    for (size_t j = 0; j < n; j++) {
        double sum = 0.0;
        for (size_t i = 0; i < n; i++) {
            sum += fabs(a[i * n + j]);
        }
        largest = fmax(largest, sum);
    }
    return largest;
}

/* r = c[6] a6 + c[4] a4 + c[2] a2 + c[0] I */
static void combine(size_t n, const double *c, const double *a2, const double *a4, const double *a6,
                    double *r)
{
    for (size_t i = 0; i < n * n; i++) {
        r[i] = c[6] * a6[i] + c[4] * a4[i] + c[2] * a2[i];
    }
    for (size_t i = 0; i < n; i++) {
        r[i * n + i] += c[0];
    }
}

/* Numerator u + v and denominator v - u of Pade (13, 13); work holds six matrices. Result in e. */
static bool pade(size_t n, const double *a, double *work, double *e)
{
    static const double c[PADE_TERMS] = {64764752532480000.0,
                                         32382376266240000.0,
                                         7771770303897600.0,
                                         1187353796428800.0,
                                         129060195264000.0,
                                         10559470521600.0,
                                         670442572800.0,
                                         33522128640.0,
                                         1323241920.0,
                                         40840800.0,
                                         960960.0,
                                         16380.0,
                                         182.0,
                                         1.0};
    static const double high_u[7] = {0.0, 0, 40840800.0, 0, 16380.0, 0, 1.0};
    static const double high_v[7] = {0.0, 0, 1323241920.0, 0, 960960.0, 0, 182.0};
    size_t size = n * n;
    double *a2 = work, *a4 = work + size, *a6 = work + 2 * size, *u = work + 3 * size;
    double *v = work + 4 * size, *t = work + 5 * size;
    dense_multiply(n, n, n, a, a, a2);
    dense_multiply(n, n, n, a2, a2, a4);
    dense_multiply(n, n, n, a2, a4, a6);
    combine(n, high_u, a2, a4, a6, t); /* u = a (a6 (..) + ..) */
    dense_multiply(n, n, n, a6, t, v);
    combine(n, c + 1, a2, a4, a6, t);
    for (size_t i = 0; i < size; i++) {
        t[i] += v[i];
    }
    dense_multiply(n, n, n, a, t, u);
    combine(n, high_v, a2, a4, a6, t);
    dense_multiply(n, n, n, a6, t, v);
    combine(n, c, a2, a4, a6, t);
    for (size_t i = 0; i < size; i++) {
        v[i] += t[i];
        e[i] = v[i] + u[i];
        v[i] -= u[i];
    }
    return dense_solve(n, n, v, e);
}

bool dense_exp(size_t n, const double *a, double *e)
{
    if (n == 0) {
        return true;
    }
    size_t size = n * n;
    double *work = malloc((7 * size + n) * sizeof(*work));
    if (work == NULL) {
        return false;
    }
    double *scaled = work + 6 * size, *d = work + 7 * size;
    memcpy(scaled, a, size * sizeof(*a));
    balance(n, scaled, d);
    int squarings = 0;
    double norm = norm1(n, scaled);
    if (norm > NORM_MAX) {
        (void)frexp(norm / NORM_MAX, &squarings);
    }
    for (size_t i = 0; i < size; i++) {
        scaled[i] = ldexp(scaled[i], -squarings);
    }
    bool good = isfinite(norm) && pade(n, scaled, work, e);
    for (int k = 0; k < squarings && good; k++) {
        dense_multiply(n, n, n, e, e, work);
        memcpy(e, work, size * sizeof(*e));
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            e[i * n + j] *= d[i] / d[j];
        }
    }
    free(work);
    return good;
}

bool dense_hold(size_t n, size_t m, const double *a, const double *b, double h, double *ad,
                double *bd)
{
    size_t k = n + m;
    double *both = calloc(2 * k * k + 1, sizeof(*both));
    if (both == NULL) {
        return false;
    }
    double *e = both + k * k;
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            both[i * k + j] = a[i * n + j] * h;
        }
        for (size_t j = 0; j < m; j++) {
            both[i * k + n + j] = b[i * m + j] * h;
        }
    }
    bool good = dense_exp(k, both, e);
    for (size_t i = 0; i < n && good; i++) {
        memcpy(ad + i * n, e + i * k, n * sizeof(*ad));
        memcpy(bd + i * m, e + i * k + n, m * sizeof(*bd));
    }
    free(both);
    return good;
}
