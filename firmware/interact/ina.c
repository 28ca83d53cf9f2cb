#include "interact/ina.h"

#include <math.h>
#include <stddef.h>

#include "lti/fopdt.h"

#define BY_MOST       REAL_C(1e6)
#define BY_LEAST      REAL_C(1e-6)
#define DIAGONAL_PART REAL_C(0.01)

enum err ina_identity(uint8_t n, struct matrix *g)
{
    if (n < 1 || n > INA_MOST)
        return ERR_RANGE;
    g->rows = g->cols = n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            g->value[i][j] = i == j ? REAL_C(1.0) : REAL_C(0.0);
    return ERR_OK;
}

enum err ina_operate(struct matrix *g, const struct ina_operation *operation)
{
    uint8_t row = operation->row, other = operation->other;
    real_t by = operation->by;
    bool two = operation->kind != INA_SCALE, number = operation->kind != INA_SWAP;
    if (g->rows != g->cols || row >= g->cols || (two && (other >= g->cols || other == row)))
        return ERR_RANGE;
    if (number && !real_within(by, -BY_MOST, BY_MOST))
        return ERR_RANGE;
    if (operation->kind == INA_SCALE && real_abs(by) < BY_LEAST)
        return ERR_RANGE;
    for (size_t i = 0; i < g->rows; i++) {
        real_t *at = g->value[i], was = at[row];
        switch (operation->kind) {
        case INA_ADD:
            at[other] -= by * was;
            break;
        case INA_SCALE:
            at[row] = was / by;
            break;
        case INA_SWAP:
            at[row] = at[other];
            at[other] = was;
            break;
        default:
            return ERR_RANGE;
        }
    }
    return ERR_OK;
}

static enum err square_response(const struct cmatrix *f)
{
    if (f->rows != f->cols || f->rows < 1 || f->rows > INA_MOST)
        return ERR_RANGE;
    return cmatrix_check(f);
}

enum err ina_direct(const struct cmatrix *f, const struct matrix *g, struct cmatrix *h)
{
    enum err err = square_response(f);
    if (err)
        return err;
    if (g->rows != f->rows || g->cols != f->rows)
        return ERR_RANGE;
    err = matrix_check(g);
    if (err)
        return err;
    h->rows = h->cols = f->rows;
    for (size_t i = 0; i < f->rows; i++)
        for (size_t j = 0; j < f->rows; j++) {
            struct cplx sum = cplx(REAL_C(0.0), REAL_C(0.0));
            for (size_t k = 0; k < f->rows; k++)
                sum = cplx_add(sum, cplx_scale(f->value[i][k], g->value[k][j]));
            h->value[i][j] = sum;
        }
    return ERR_OK;
}

enum err ina_inverse(const struct cmatrix *f, const struct matrix *g, struct ina_work *work,
                     struct cmatrix *inverse)
{
    enum err err = ina_direct(f, g, &work->h);
    if (err)
        return err;
    err = clu_factor(&work->h, &work->lu);
    if (err)
        return err;
    size_t n = f->rows;
    inverse->rows = inverse->cols = f->rows;
    for (size_t j = 0; j < n; j++) {
        struct cplx unit[INA_MOST], column[INA_MOST];
        for (size_t i = 0; i < n; i++)
            unit[i] = cplx(i == j ? REAL_C(1.0) : REAL_C(0.0), REAL_C(0.0));
        clu_solve(&work->lu, unit, column);
        for (size_t i = 0; i < n; i++)
            inverse->value[i][j] = column[i];
    }
    return ERR_OK;
}

real_t ina_dominance(const struct cmatrix *array, enum ina_by by, real_t *radius, real_t *ratio)
{
    real_t worst = REAL_C(0.0);
    for (size_t i = 0; i < array->rows; i++) {
        real_t sum = REAL_C(0.0), own = cplx_abs(array->value[i][i]);
        for (size_t j = 0; j < array->rows; j++)
            if (j != i)
                sum += cplx_abs(by == INA_BY_ROWS ? array->value[i][j] : array->value[j][i]);
        real_t part = own > REAL_C(0.0) ? sum / own : INFINITY;
        if (radius)
            radius[i] = sum;
        if (ratio)
            ratio[i] = part;
        if (part > worst)
            worst = part;
    }
    return worst;
}

/* Angle a, as its cosine (0 or more) and sine, that makes p cos^2 + 2 q cos sin + r sin^2 largest: tan 2a = 2q/(p - r). */
static void best_angle(real_t p, real_t q, real_t r, real_t *cosine, real_t *sine)
{
    real_t x = p - r, y = q + q, size = real_sqrt(x * x + y * y);
    *cosine = REAL_C(1.0);
    *sine = REAL_C(0.0);
    if (size <= REAL_C(0.0))
        return;
    /* The half angle from whichever of its two values is not a difference of near equals. */
    if (x >= REAL_C(0.0)) {
        *cosine = real_sqrt(REAL_C(0.5) * (REAL_C(1.0) + x / size));
        *sine = y / (REAL_C(2.0) * size * *cosine);
        return;
    }
    real_t large = real_sqrt(REAL_C(0.5) * (REAL_C(1.0) - x / size));
    *cosine = real_abs(y) / (REAL_C(2.0) * size * large);
    *sine = y < REAL_C(0.0) ? -large : large;
}

/* Element (i, j) of the projection on the columns of the stacked matrix: stacked times its pseudo-inverse. */
static real_t projection(const struct ina_align_work *work, size_t i, size_t j)
{
    real_t sum = REAL_C(0.0);
    for (size_t k = 0; k < work->stacked.cols; k++)
        sum += work->stacked.value[i][k] * work->inverse.value[k][j];
    return sum;
}

enum err ina_align(const struct cmatrix *f, struct ina_align_work *work, struct matrix *g)
{
    enum err err = square_response(f);
    if (err)
        return err;
    size_t n = f->rows;
    work->stacked.rows = (uint8_t)(2 * n);
    work->stacked.cols = f->rows;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            work->stacked.value[i][j] = f->value[i][j].re;
            work->stacked.value[n + i][j] = f->value[i][j].im;
        }
    err = matrix_pseudo_inverse(&work->stacked, &work->pseudo, &work->inverse);
    if (err)
        return err;
    g->rows = g->cols = f->rows;
    for (size_t j = 0; j < n; j++) {
        real_t cosine, sine;
        best_angle(projection(work, j, j), projection(work, j, n + j),
                   projection(work, n + j, n + j), &cosine, &sine);
        for (size_t i = 0; i < n; i++)
            g->value[i][j] =
                work->inverse.value[i][j] * cosine + work->inverse.value[i][n + j] * sine;
    }
    return ERR_OK;
}

bool ina_normalise(struct matrix *g)
{
    bool all = true;
    for (size_t j = 0; j < g->cols; j++) {
        real_t largest = REAL_C(0.0);
        for (size_t i = 0; i < g->rows; i++)
            if (real_abs(g->value[i][j]) > real_abs(largest))
                largest = g->value[i][j];
        real_t by = g->value[j][j];
        if (real_abs(by) < DIAGONAL_PART * real_abs(largest)) {
            by = largest;
            all = false;
        }
        if (real_abs(by) <= REAL_C(0.0)) {
            all = false;
            continue;
        }
        for (size_t i = 0; i < g->rows; i++)
            g->value[i][j] /= by;
    }
    return all;
}
