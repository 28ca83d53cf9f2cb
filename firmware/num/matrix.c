#include "num/matrix.h"

#include <stddef.h>

#include "base/assertion.h"

#define ELEMENT_MAX  REAL_C(1e15)
#define ROUNDS_EXACT 20
#define ROUNDS_ROUGH 6 /* rounds to powers of two; further rounds change nothing */

enum err matrix_check(const struct matrix *a)
{
    if (a->rows < 1 || a->rows > MATRIX_MAX || a->cols < 1 || a->cols > MATRIX_MAX)
        return ERR_RANGE;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t j = 0; j < a->cols; j++)
            if (!(real_abs(a->value[i][j]) <= ELEMENT_MAX))
                return ERR_NOT_FINITE;
    return ERR_OK;
}

enum err matrix_multiply(const struct matrix *a, const struct matrix *b, struct matrix *c)
{
    REFLUX_ASSERT(a->rows <= MATRIX_MAX && a->cols <= MATRIX_MAX && b->cols <= MATRIX_MAX);
    if (a->cols != b->rows)
        return ERR_RANGE;
    c->rows = a->rows;
    c->cols = b->cols;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t j = 0; j < b->cols; j++) {
            real_t sum = REAL_C(0.0);
            for (size_t k = 0; k < a->cols; k++)
                sum += a->value[i][k] * b->value[k][j];
            c->value[i][j] = sum;
        }
    return ERR_OK;
}

void matrix_transpose(const struct matrix *a, struct matrix *t)
{
    REFLUX_ASSERT(a->rows <= MATRIX_MAX && a->cols <= MATRIX_MAX);
    t->rows = a->cols;
    t->cols = a->rows;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t j = 0; j < a->cols; j++)
            t->value[j][i] = a->value[i][j];
}

/* Returns the largest power of two not above x; 1 for 0. x is at most 1e19. Below 1e-19 the result stays about 1e-19. */
static real_t power_of_two_below(real_t x)
{
    real_t p = REAL_C(1.0);
    if (x <= REAL_C(0.0))
        return p;
    for (int k = 0; k < 64 && p * REAL_C(2.0) <= x; k++)
        p = p * REAL_C(2.0);
    for (int k = 0; k < 64 && p > x; k++)
        p = p * REAL_C(0.5);
    return p;
}

void matrix_equilibrate(const struct matrix *a, bool exact, real_t *r, real_t *c)
{
    REFLUX_ASSERT(a->rows <= MATRIX_MAX && a->cols <= MATRIX_MAX);
    for (size_t i = 0; i < a->rows; i++)
        r[i] = REAL_C(1.0);
    for (size_t j = 0; j < a->cols; j++)
        c[j] = REAL_C(1.0);
    /* Each round sets r and c anew, to 1 over the norm of the row or column with the factors of the other side. */
    int rounds = exact ? ROUNDS_EXACT : ROUNDS_ROUGH;
    for (int round = 0; round < rounds; round++) {
        for (size_t i = 0; i < a->rows; i++) {
            real_t sum = REAL_C(0.0);
            for (size_t j = 0; j < a->cols; j++)
                sum += (a->value[i][j] * c[j]) * (a->value[i][j] * c[j]);
            if (sum > REAL_C(0.0))
                r[i] = REAL_C(1.0) / real_sqrt(sum);
        }
        for (size_t j = 0; j < a->cols; j++) {
            real_t sum = REAL_C(0.0);
            for (size_t i = 0; i < a->rows; i++)
                sum += (a->value[i][j] * r[i]) * (a->value[i][j] * r[i]);
            if (sum > REAL_C(0.0))
                c[j] = REAL_C(1.0) / real_sqrt(sum);
        }
    }
    for (size_t i = 0; i < a->rows && !exact; i++)
        r[i] = power_of_two_below(r[i]);
    for (size_t j = 0; j < a->cols && !exact; j++)
        c[j] = power_of_two_below(c[j]);
}

enum err lu_factor(const struct matrix *a, struct lu *lu)
{
    enum err err = matrix_check(a);
    if (err)
        return err;
    if (a->rows != a->cols)
        return ERR_RANGE;
    size_t n = a->rows;
    real_t largest[MATRIX_MAX];
    lu->n = a->rows;
    lu->sign = 1;
    for (size_t i = 0; i < n; i++) {
        lu->row[i] = (uint8_t)i;
        largest[i] = REAL_C(0.0);
        for (size_t j = 0; j < n; j++) {
            lu->value[i][j] = a->value[i][j];
            if (real_abs(a->value[i][j]) > largest[i])
                largest[i] = real_abs(a->value[i][j]);
        }
    }
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        real_t best = REAL_C(-1.0);
        for (size_t i = k; i < n; i++) {
            if (largest[i] <= REAL_C(0.0))
                return ERR_SINGULAR;
            if (real_abs(lu->value[i][k]) / largest[i] > best) {
                best = real_abs(lu->value[i][k]) / largest[i];
                pivot = i;
            }
        }
        if (best <= (real_t)n * REAL_EPSILON)
            return ERR_SINGULAR;
        if (pivot != k) {
            for (size_t j = 0; j < n; j++) {
                real_t swap = lu->value[k][j];
                lu->value[k][j] = lu->value[pivot][j];
                lu->value[pivot][j] = swap;
            }
            uint8_t row = lu->row[k];
            lu->row[k] = lu->row[pivot];
            lu->row[pivot] = row;
            largest[pivot] = largest[k];
            lu->sign = (int16_t)-lu->sign;
        }
        for (size_t i = k + 1; i < n; i++) {
            real_t factor = lu->value[i][k] / lu->value[k][k];
            lu->value[i][k] = factor;
            for (size_t j = k + 1; j < n; j++)
                lu->value[i][j] -= factor * lu->value[k][j];
        }
    }
    return ERR_OK;
}

void lu_solve(const struct lu *lu, const real_t *b, real_t *x)
{
    REFLUX_ASSERT(lu->n <= MATRIX_MAX);
    size_t n = lu->n;
    real_t y[MATRIX_MAX];
    for (size_t i = 0; i < n; i++) {
        y[i] = b[lu->row[i]];
        for (size_t j = 0; j < i; j++)
            y[i] -= lu->value[i][j] * y[j];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t j = i + 1; j < n; j++)
            y[i] -= lu->value[i][j] * y[j];
        y[i] = y[i] / lu->value[i][i];
    }
    for (size_t i = 0; i < n; i++)
        x[i] = y[i];
}

void lu_inverse(const struct lu *lu, struct matrix *inverse)
{
    REFLUX_ASSERT(lu->n <= MATRIX_MAX);
    real_t column[MATRIX_MAX];
    inverse->rows = inverse->cols = lu->n;
    for (size_t j = 0; j < lu->n; j++) {
        for (size_t i = 0; i < lu->n; i++)
            column[i] = i == j ? REAL_C(1.0) : REAL_C(0.0);
        lu_solve(lu, column, column);
        for (size_t i = 0; i < lu->n; i++)
            inverse->value[i][j] = column[i];
    }
}

void lu_determinant(const struct lu *lu, int *sign, real_t *log_magnitude)
{
    REFLUX_ASSERT(lu->n <= MATRIX_MAX);
    *sign = lu->sign;
    *log_magnitude = REAL_C(0.0);
    for (size_t i = 0; i < lu->n; i++) {
        if (lu->value[i][i] < REAL_C(0.0))
            *sign = -*sign;
        *log_magnitude += real_log(real_abs(lu->value[i][i]));
    }
}

/* Returns element (i, j) of a, or of its transpose. */
static real_t element(const struct matrix *a, bool transposed, size_t i, size_t j)
{
    return transposed ? a->value[j][i] : a->value[i][j];
}

/* Removes the parts along columns 0 .. k-1 of q from column k, and adds them to r. */
static void orthogonalise(struct matrix *q, real_t (*r)[MATRIX_MAX], size_t k)
{
    for (size_t l = 0; l < k; l++) {
        real_t along = REAL_C(0.0);
        for (size_t i = 0; i < q->rows; i++)
            along += q->value[i][l] * q->value[i][k];
        r[l][k] += along;
        for (size_t i = 0; i < q->rows; i++)
            q->value[i][k] -= along * q->value[i][l];
    }
}

static real_t column_norm(const struct matrix *q, size_t k)
{
    real_t sum = REAL_C(0.0);
    for (size_t i = 0; i < q->rows; i++)
        sum += q->value[i][k] * q->value[i][k];
    return real_sqrt(sum);
}

static enum err pseudo_inverse_by_qr(const struct matrix *a, struct pseudo_inverse_work *work,
                                     struct matrix *inverse)
{
    bool wide = a->rows < a->cols;
    struct matrix *q = &work->q;
    real_t(*r)[MATRIX_MAX] = work->lu.value;
    q->rows = wide ? a->cols : a->rows;
    q->cols = wide ? a->rows : a->cols;
    for (size_t k = 0; k < q->cols; k++) {
        for (size_t i = 0; i < q->rows; i++)
            q->value[i][k] = element(a, wide, i, k);
        for (size_t l = 0; l < k; l++)
            r[l][k] = REAL_C(0.0);
        real_t before = column_norm(q, k);
        orthogonalise(q, r, k);
        orthogonalise(q, r, k);
        r[k][k] = column_norm(q, k);
        if (r[k][k] <= (real_t)q->rows * REAL_EPSILON * before)
            return ERR_SINGULAR;
        for (size_t i = 0; i < q->rows; i++)
            q->value[i][k] = q->value[i][k] / r[k][k];
    }
    inverse->rows = a->cols;
    inverse->cols = a->rows;
    for (size_t i = 0; i < q->rows; i++) {
        real_t x[MATRIX_MAX];
        for (size_t k = q->cols; k-- > 0;) {
            x[k] = q->value[i][k];
            for (size_t l = k + 1; l < q->cols; l++)
                x[k] -= r[k][l] * x[l];
            x[k] = x[k] / r[k][k];
            if (wide)
                inverse->value[i][k] = x[k];
            else
                inverse->value[k][i] = x[k];
        }
    }
    return ERR_OK;
}

enum err matrix_pseudo_inverse(const struct matrix *a, struct pseudo_inverse_work *work,
                               struct matrix *inverse)
{
    enum err err = matrix_check(a);
    if (err)
        return err;
    if (a->rows != a->cols)
        return pseudo_inverse_by_qr(a, work, inverse);
    err = lu_factor(a, &work->lu);
    if (err)
        return err;
    lu_inverse(&work->lu, inverse);
    return ERR_OK;
}
