#include "num/svd.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"

/* Length, as a part of the matrix, below which a column counts as 0, because the squares of lengths must not vanish. */
#ifdef REFLUX_REAL_DOUBLE
#define SHORTEST 1e-140
#else
#define SHORTEST 1e-15f
#endif
/* Size from which the square, which could overflow, equals the square plus 1. */
#define STEEP REAL_C(1e9)

static real_t dot(const struct matrix *a, size_t k, size_t l)
{
    real_t sum = REAL_C(0.0);
    for (size_t i = 0; i < a->rows; i++)
        sum += a->value[i][k] * a->value[i][l];
    return sum;
}

static void swap_columns(struct matrix *a, size_t k, size_t l)
{
    for (size_t i = 0; i < a->rows; i++) {
        real_t swap = a->value[i][k];
        a->value[i][k] = a->value[i][l];
        a->value[i][l] = swap;
    }
}

static void rotate(struct matrix *a, size_t k, size_t l, real_t c, real_t s)
{
    for (size_t i = 0; i < a->rows; i++) {
        real_t x = a->value[i][k], y = a->value[i][l];
        a->value[i][k] = c * x - s * y;
        a->value[i][l] = s * x + c * y;
    }
}

enum err svd_begin(struct svd *svd, const struct matrix *a)
{
    enum err err = matrix_check(a);
    if (err)
        return err;
    memset(svd, 0, sizeof *svd);
    svd->rows = a->rows;
    svd->cols = a->cols;
    svd->wide = a->rows < a->cols;
    real_t largest = REAL_C(0.0);
    for (size_t i = 0; i < a->rows; i++)
        for (size_t j = 0; j < a->cols; j++)
            if (real_abs(a->value[i][j]) > largest)
                largest = real_abs(a->value[i][j]);
    svd->scale = REAL_C(1.0);
    for (int k = 0; k < 100 && largest > svd->scale; k++)
        svd->scale = svd->scale * REAL_C(2.0);
    for (int k = 0; k < 100 && largest > REAL_C(0.0) && largest < svd->scale * REAL_C(0.5); k++)
        svd->scale = svd->scale * REAL_C(0.5);

    size_t rows = svd->wide ? a->cols : a->rows, cols = svd->wide ? a->rows : a->cols;
    svd->u.rows = svd->u.cols = (uint8_t)rows;
    svd->v.rows = svd->v.cols = (uint8_t)cols;
    for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < cols; j++)
            svd->u.value[i][j] = (svd->wide ? a->value[j][i] : a->value[i][j]) / svd->scale;
    for (size_t j = 0; j < cols; j++)
        svd->v.value[j][j] = REAL_C(1.0);
    return ERR_OK;
}

/* Rotates every pair of columns that is not yet orthogonal. Returns false when no pair needed it and every pair was checked. The
 * longer column of a pair comes first (de Rijk 1989), which sorts the columns and saves sweeps. Columns that change places within a
 * sweep may pass one another unchecked. */
static bool sweep(struct svd *svd)
{
    bool turned = false;
    size_t cols = svd->v.cols;
    real_t tolerance = (real_t)svd->u.rows * REAL_EPSILON;
    for (size_t k = 0; k + 1 < cols; k++)
        for (size_t l = k + 1; l < cols; l++) {
            real_t a = dot(&svd->u, k, k), b = dot(&svd->u, l, l);
            if (a < b) {
                swap_columns(&svd->u, k, l);
                swap_columns(&svd->v, k, l);
                real_t swap = a;
                a = b;
                b = swap;
                turned = true;
            }
            if (b <= SHORTEST * SHORTEST)
                continue;
            real_t g = dot(&svd->u, k, l);
            if (real_abs(g) <= tolerance * real_sqrt(a) * real_sqrt(b))
                continue;
            turned = true;
            real_t zeta = (b - a) / (REAL_C(2.0) * g);
            real_t steep = real_abs(zeta);
            real_t t = REAL_C(1.0) /
                       (steep + (steep > STEEP ? steep : real_sqrt(REAL_C(1.0) + zeta * zeta)));
            if (zeta < REAL_C(0.0))
                t = -t;
            real_t c = REAL_C(1.0) / real_sqrt(REAL_C(1.0) + t * t);
            rotate(&svd->u, k, l, c, c * t);
            rotate(&svd->v, k, l, c, c * t);
        }
    return turned;
}

/* Completes column k of u: takes the unit vector that the columns before it explain least, and makes it orthogonal to them. */
static void complete_column(struct matrix *u, size_t k)
{
    size_t best = 0;
    real_t least = REAL_C(2.0);
    for (size_t i = 0; i < u->rows; i++) {
        real_t sum = REAL_C(0.0);
        for (size_t l = 0; l < k; l++)
            sum += u->value[i][l] * u->value[i][l];
        if (sum < least) {
            least = sum;
            best = i;
        }
    }
    for (size_t i = 0; i < u->rows; i++)
        u->value[i][k] = i == best ? REAL_C(1.0) : REAL_C(0.0);
    for (int pass = 0; pass < 2; pass++)
        for (size_t l = 0; l < k; l++) {
            real_t along = dot(u, l, k);
            for (size_t i = 0; i < u->rows; i++)
                u->value[i][k] -= along * u->value[i][l];
        }
    real_t norm = real_sqrt(dot(u, k, k));
    for (size_t i = 0; i < u->rows; i++)
        u->value[i][k] = u->value[i][k] / norm;
}

static void swap_sides(struct svd *svd)
{
    size_t n = svd->u.rows > svd->v.rows ? svd->u.rows : svd->v.rows;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            real_t swap = svd->u.value[i][j];
            svd->u.value[i][j] = svd->v.value[i][j];
            svd->v.value[i][j] = swap;
        }
    uint8_t rows = svd->u.rows;
    svd->u.rows = svd->u.cols = svd->v.rows;
    svd->v.rows = svd->v.cols = rows;
}

/* Makes the columns unit vectors. They are in order, because the last sweep changed nothing. */
static void make_unit_columns(struct svd *svd)
{
    size_t rows = svd->u.rows, cols = svd->v.cols;
    for (size_t k = 0; k < cols; k++)
        svd->s[k] = real_sqrt(dot(&svd->u, k, k));
    for (size_t k = 0; k < rows; k++) {
        if (k >= cols || svd->s[k] <= SHORTEST) {
            complete_column(&svd->u, k);
            continue;
        }
        for (size_t i = 0; i < rows; i++)
            svd->u.value[i][k] = svd->u.value[i][k] / svd->s[k];
    }
    for (size_t k = 0; k < cols; k++)
        svd->s[k] = svd->s[k] <= SHORTEST ? REAL_C(0.0) : svd->s[k] * svd->scale;
    if (svd->wide)
        swap_sides(svd);
}

enum err svd_step(struct svd *svd)
{
    REFLUX_ASSERT(svd->u.rows <= MATRIX_MAX && svd->v.cols <= MATRIX_MAX);
    if (svd->done)
        return ERR_STATE;
    if (svd->sweeps >= SVD_SWEEPS)
        return ERR_TIMEOUT;
    svd->sweeps++;
    if (sweep(svd))
        return ERR_BUSY;
    make_unit_columns(svd);
    svd->done = true;
    return ERR_OK;
}

enum err svd_decompose(struct svd *svd, const struct matrix *a)
{
    enum err err = svd_begin(svd, a);
    if (err)
        return err;
    do
        err = svd_step(svd);
    while (err == ERR_BUSY);
    return err;
}

static size_t singular_values(const struct svd *svd)
{
    return svd->rows < svd->cols ? svd->rows : svd->cols;
}

unsigned svd_rank(const struct svd *svd, real_t tolerance)
{
    REFLUX_ASSERT(svd->rows <= MATRIX_MAX && svd->cols <= MATRIX_MAX);
    if (tolerance <= REAL_C(0.0))
        tolerance = (real_t)(svd->rows > svd->cols ? svd->rows : svd->cols) * REAL_EPSILON;
    unsigned rank = 0;
    while (rank < singular_values(svd) && svd->s[rank] > tolerance * svd->s[0])
        rank++;
    return rank;
}

real_t svd_condition(const struct svd *svd)
{
    REFLUX_ASSERT(svd->rows >= 1 && svd->cols >= 1);
    if (svd_rank(svd, REAL_C(0.0)) < singular_values(svd))
        return INFINITY;
    return svd->s[0] / svd->s[singular_values(svd) - 1];
}

enum err svd_pseudo_inverse(const struct svd *svd, unsigned rank, struct matrix *inverse)
{
    REFLUX_ASSERT(svd->rows <= MATRIX_MAX && svd->cols <= MATRIX_MAX);
    if (rank < 1 || rank > singular_values(svd) || svd->s[rank - 1] <= REAL_C(0.0))
        return ERR_RANGE;
    inverse->rows = svd->cols;
    inverse->cols = svd->rows;
    for (size_t i = 0; i < svd->cols; i++)
        for (size_t j = 0; j < svd->rows; j++) {
            real_t sum = REAL_C(0.0);
            for (size_t k = 0; k < rank; k++)
                sum += svd->v.value[i][k] / svd->s[k] * svd->u.value[j][k];
            inverse->value[i][j] = sum;
        }
    return ERR_OK;
}
