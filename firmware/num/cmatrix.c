#include "num/cmatrix.h"

#include <stddef.h>

#include "base/assertion.h"

#define ELEMENT_MAX REAL_C(1e15)

static bool element_in_range(struct cplx a)
{
    return real_abs(a.re) <= ELEMENT_MAX && real_abs(a.im) <= ELEMENT_MAX;
}

enum err cmatrix_check(const struct cmatrix *a)
{
    if (a->rows < 1 || a->rows > MATRIX_MAX || a->cols < 1 || a->cols > MATRIX_MAX)
        return ERR_RANGE;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t j = 0; j < a->cols; j++)
            if (!element_in_range(a->value[i][j]))
                return ERR_NOT_FINITE;
    return ERR_OK;
}

static void swap_rows(struct clu *lu, size_t k, size_t l)
{
    for (size_t j = 0; j < lu->n; j++) {
        struct cplx swap = lu->value[k][j];
        lu->value[k][j] = lu->value[l][j];
        lu->value[l][j] = swap;
    }
    uint8_t row = lu->row[k];
    lu->row[k] = lu->row[l];
    lu->row[l] = row;
    lu->sign = (int16_t)-lu->sign;
}

/* Returns a measure of magnitude without a square root, which is enough to choose a pivot. */
static real_t size_of(struct cplx a)
{
    return real_abs(a.re) + real_abs(a.im);
}

enum err clu_factor(const struct cmatrix *a, struct clu *lu)
{
    enum err err = cmatrix_check(a);
    if (err)
        return err;
    if (a->rows != a->cols)
        return ERR_RANGE;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t j = 0; j < a->cols; j++)
            lu->value[i][j] = a->value[i][j];
    return clu_factor_own(lu, a->rows);
}

enum err clu_factor_own(struct clu *lu, uint8_t rows)
{
    if (rows < 1 || rows > MATRIX_MAX)
        return ERR_RANGE;
    size_t n = rows;
    real_t largest[MATRIX_MAX];
    lu->n = rows;
    lu->sign = 1;
    for (size_t i = 0; i < n; i++) {
        lu->row[i] = (uint8_t)i;
        largest[i] = REAL_C(0.0);
        for (size_t j = 0; j < n; j++) {
            if (!element_in_range(lu->value[i][j]))
                return ERR_NOT_FINITE;
            if (size_of(lu->value[i][j]) > largest[i])
                largest[i] = size_of(lu->value[i][j]);
        }
    }
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        real_t best = REAL_C(-1.0);
        for (size_t i = k; i < n; i++) {
            if (largest[i] <= REAL_C(0.0))
                return ERR_SINGULAR;
            if (size_of(lu->value[i][k]) / largest[i] > best) {
                best = size_of(lu->value[i][k]) / largest[i];
                pivot = i;
            }
        }
        if (best <= (real_t)n * REAL_EPSILON)
            return ERR_SINGULAR;
        if (pivot != k) {
            swap_rows(lu, k, pivot);
            largest[pivot] = largest[k];
        }
        struct cplx inverse = cplx_div(cplx(REAL_C(1.0), REAL_C(0.0)), lu->value[k][k]);
        for (size_t i = k + 1; i < n; i++) {
            struct cplx factor = cplx_mul(lu->value[i][k], inverse);
            lu->value[i][k] = factor;
            for (size_t j = k + 1; j < n; j++)
                lu->value[i][j] = cplx_sub(lu->value[i][j], cplx_mul(factor, lu->value[k][j]));
        }
    }
    return ERR_OK;
}

void clu_solve(const struct clu *lu, const struct cplx *b, struct cplx *x)
{
    REFLUX_ASSERT(lu->n <= MATRIX_MAX);
    size_t n = lu->n;
    struct cplx y[MATRIX_MAX];
    for (size_t i = 0; i < n; i++) {
        y[i] = b[lu->row[i]];
        for (size_t j = 0; j < i; j++)
            y[i] = cplx_sub(y[i], cplx_mul(lu->value[i][j], y[j]));
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t j = i + 1; j < n; j++)
            y[i] = cplx_sub(y[i], cplx_mul(lu->value[i][j], y[j]));
        y[i] = cplx_div(y[i], lu->value[i][i]);
    }
    for (size_t i = 0; i < n; i++)
        x[i] = y[i];
}

void clu_inverse_diagonal(const struct clu *lu, struct cplx *diagonal)
{
    REFLUX_ASSERT(lu->n <= MATRIX_MAX);
    size_t n = lu->n;
    struct cplx y[MATRIX_MAX];
    for (size_t first = 0; first < n; first++) {
        /* Column k of the inverse: L y = P e_k begins with the 1 at `first`, U x = y ends with x_k. */
        size_t k = lu->row[first];
        for (size_t i = 0; i < n; i++) {
            y[i] = cplx(i == first ? REAL_C(1.0) : REAL_C(0.0), REAL_C(0.0));
            for (size_t j = first; j < i; j++)
                y[i] = cplx_sub(y[i], cplx_mul(lu->value[i][j], y[j]));
        }
        for (size_t i = n; i-- > k;) {
            for (size_t j = i + 1; j < n; j++)
                y[i] = cplx_sub(y[i], cplx_mul(lu->value[i][j], y[j]));
            y[i] = cplx_div(y[i], lu->value[i][i]);
        }
        diagonal[k] = y[k];
    }
}

/* Row with the largest element of column k, from row k on, or n where all are too small. */
static size_t pivot_row(struct cplx a[MATRIX_MAX][MATRIX_MAX], size_t n, size_t k, real_t least)
{
    size_t pivot = n;
    for (size_t i = k; i < n; i++)
        if (size_of(a[i][k]) > least) {
            least = size_of(a[i][k]);
            pivot = i;
        }
    return pivot;
}

enum err cmatrix_invert_own(struct cplx a[MATRIX_MAX][MATRIX_MAX], uint8_t rows)
{
    if (rows < 1 || rows > MATRIX_MAX)
        return ERR_RANGE;
    size_t n = rows, row[MATRIX_MAX];
    real_t largest = REAL_C(0.0);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            if (!element_in_range(a[i][j]))
                return ERR_NOT_FINITE;
            largest = size_of(a[i][j]) > largest ? size_of(a[i][j]) : largest;
        }
    for (size_t k = 0; k < n; k++) {
        size_t pivot = pivot_row(a, n, k, (real_t)n * REAL_EPSILON * largest);
        if (pivot == n)
            return ERR_SINGULAR;
        row[k] = pivot;
        for (size_t j = 0; j < n && pivot != k; j++) {
            struct cplx swap = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = swap;
        }
        struct cplx inverse = cplx_div(cplx(REAL_C(1.0), REAL_C(0.0)), a[k][k]);
        a[k][k] = cplx(REAL_C(1.0), REAL_C(0.0));
        for (size_t j = 0; j < n; j++)
            a[k][j] = cplx_mul(a[k][j], inverse);
        for (size_t i = 0; i < n; i++) {
            if (i == k)
                continue;
            struct cplx factor = a[i][k];
            a[i][k] = cplx(REAL_C(0.0), REAL_C(0.0));
            for (size_t j = 0; j < n; j++)
                a[i][j] = cplx_sub(a[i][j], cplx_mul(factor, a[k][j]));
        }
    }
    /* Rows that were exchanged are columns of the inverse that are. */
    for (size_t k = n; k-- > 0;)
        for (size_t i = 0; i < n && row[k] != k; i++) {
            struct cplx swap = a[i][k];
            a[i][k] = a[i][row[k]];
            a[i][row[k]] = swap;
        }
    return ERR_OK;
}

void clu_determinant(const struct clu *lu, struct cplx *direction, real_t *log_magnitude)
{
    REFLUX_ASSERT(lu->n <= MATRIX_MAX);
    *direction = cplx((real_t)lu->sign, REAL_C(0.0));
    *log_magnitude = REAL_C(0.0);
    for (size_t i = 0; i < lu->n; i++) {
        real_t magnitude = cplx_abs(lu->value[i][i]);
        *log_magnitude += real_log(magnitude);
        *direction = cplx_mul(*direction, cplx_scale(lu->value[i][i], REAL_C(1.0) / magnitude));
    }
    *direction = cplx_scale(*direction, REAL_C(1.0) / cplx_abs(*direction));
}

/* Returns element (i, j) of a, or of its conjugate transpose. */
static struct cplx conj_element(const struct cmatrix *a, bool transposed, size_t i, size_t j)
{
    return transposed ? cplx_conj(a->value[j][i]) : a->value[i][j];
}

/* Removes the parts along columns 0 .. k-1 of q from column k, and adds them to r. */
static void orthogonalise_complex(struct cmatrix *q, struct cmatrix *r, size_t k)
{
    for (size_t l = 0; l < k; l++) {
        struct cplx along = cplx(REAL_C(0.0), REAL_C(0.0));
        for (size_t i = 0; i < q->rows; i++)
            along = cplx_add(along, cplx_mul(cplx_conj(q->value[i][l]), q->value[i][k]));
        r->value[l][k] = cplx_add(r->value[l][k], along);
        for (size_t i = 0; i < q->rows; i++)
            q->value[i][k] = cplx_sub(q->value[i][k], cplx_mul(along, q->value[i][l]));
    }
}

static real_t complex_column_norm(const struct cmatrix *q, size_t k)
{
    real_t sum = REAL_C(0.0);
    for (size_t i = 0; i < q->rows; i++)
        sum += cplx_square(q->value[i][k]);
    return real_sqrt(sum);
}

enum err cmatrix_pseudo_inverse(const struct cmatrix *a, struct cpseudo_inverse_work *work,
                                struct cmatrix *inverse)
{
    enum err err = cmatrix_check(a);
    if (err)
        return err;
    bool wide = a->rows < a->cols;
    struct cmatrix *q = &work->q, *r = &work->r;
    q->rows = wide ? a->cols : a->rows;
    q->cols = wide ? a->rows : a->cols;
    for (size_t k = 0; k < q->cols; k++) {
        for (size_t i = 0; i < q->rows; i++)
            q->value[i][k] = conj_element(a, wide, i, k);
        for (size_t l = 0; l < k; l++)
            r->value[l][k] = cplx(REAL_C(0.0), REAL_C(0.0));
        real_t before = complex_column_norm(q, k);
        orthogonalise_complex(q, r, k);
        orthogonalise_complex(q, r, k);
        real_t norm = complex_column_norm(q, k);
        if (norm <= (real_t)q->rows * REAL_EPSILON * before)
            return ERR_SINGULAR;
        r->value[k][k] = cplx(norm, REAL_C(0.0));
        for (size_t i = 0; i < q->rows; i++)
            q->value[i][k] = cplx_scale(q->value[i][k], REAL_C(1.0) / norm);
    }
    /* R x = row i of Q, conjugated; x is column i of the inverse, or its conjugate row i of the wide one. */
    inverse->rows = a->cols;
    inverse->cols = a->rows;
    for (size_t i = 0; i < q->rows; i++) {
        struct cplx x[MATRIX_MAX];
        for (size_t k = q->cols; k-- > 0;) {
            x[k] = cplx_conj(q->value[i][k]);
            for (size_t l = k + 1; l < q->cols; l++)
                x[k] = cplx_sub(x[k], cplx_mul(r->value[k][l], x[l]));
            x[k] = cplx_scale(x[k], REAL_C(1.0) / r->value[k][k].re);
            if (wide)
                inverse->value[i][k] = cplx_conj(x[k]);
            else
                inverse->value[k][i] = x[k];
        }
    }
    return ERR_OK;
}
