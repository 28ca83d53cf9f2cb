#include "interact/rga.h"

#include <math.h>
#include <stddef.h>

#include "base/assertion.h"

#define SUM_ERROR_MAX REAL_C(0.05)

static real_t of_cplx(struct cplx a)
{
    return real_abs(a.re) + real_abs(a.im);
}

/* Scales that relative gains do not depend on: of a square matrix both sides, of a tall one the columns, of a wide one
 * the rows. */
static void free_scales(const struct matrix *a, real_t *r, real_t *c)
{
    matrix_equilibrate(a, false, r, c);
    for (size_t i = 0; i < a->rows && a->rows > a->cols; i++)
        r[i] = REAL_C(1.0);
    for (size_t j = 0; j < a->cols && a->cols > a->rows; j++)
        c[j] = REAL_C(1.0);
}

/* The sums that are 1 by definition; what they miss is the rounding that the inverse has collected. */
static bool sums_are_one(const struct matrix *lambda)
{
    bool columns = lambda->rows >= lambda->cols;
    size_t n = columns ? lambda->cols : lambda->rows, m = columns ? lambda->rows : lambda->cols;
    for (size_t k = 0; k < n; k++) {
        real_t sum = REAL_C(0.0);
        for (size_t l = 0; l < m; l++)
            sum += columns ? lambda->value[l][k] : lambda->value[k][l];
        if (!(real_abs(sum - REAL_C(1.0)) <= SUM_ERROR_MAX))
            return false;
    }
    return true;
}

/* work->scaled = diag(r) gains diag(c), and its inverse. */
static enum err invert_scaled(const struct matrix *gains, struct rga_work *work, real_t *r,
                              real_t *c)
{
    free_scales(gains, r, c);
    work->scaled.rows = gains->rows;
    work->scaled.cols = gains->cols;
    for (size_t i = 0; i < gains->rows; i++)
        for (size_t j = 0; j < gains->cols; j++)
            work->scaled.value[i][j] = gains->value[i][j] * r[i] * c[j];
    enum err err = matrix_pseudo_inverse(&work->scaled, &work->pseudo, &work->inverse);
    return err == ERR_NOT_FINITE ? ERR_SINGULAR : err;
}

enum err rga_compute(const struct matrix *gains, struct rga_work *work, struct matrix *lambda)
{
    enum err err = matrix_check(gains);
    if (err)
        return err;
    real_t r[MATRIX_MAX], c[MATRIX_MAX];
    err = invert_scaled(gains, work, r, c);
    if (err)
        return err;
    lambda->rows = gains->rows;
    lambda->cols = gains->cols;
    for (size_t i = 0; i < gains->rows; i++)
        for (size_t j = 0; j < gains->cols; j++)
            lambda->value[i][j] = work->scaled.value[i][j] * work->inverse.value[j][i];
    return sums_are_one(lambda) ? ERR_OK : ERR_SINGULAR;
}

enum err rga_at(const struct interact_plant *plant, const struct pairs *pairs, real_t omega,
                struct rga_at_work *work, struct matrix *magnitude, struct matrix *real_part)
{
    if (!real_is_finite(omega))
        return ERR_NOT_FINITE;
    if (omega < REAL_C(0.0) || (pairs && pairs->n < 1))
        return ERR_RANGE;
    interact_response(plant, pairs, omega, &work->response);
    struct cmatrix *g = &work->response;
    real_t r[MATRIX_MAX], c[MATRIX_MAX];
    work->size.rows = g->rows;
    work->size.cols = g->cols;
    for (size_t i = 0; i < g->rows; i++)
        for (size_t j = 0; j < g->cols; j++)
            work->size.value[i][j] = of_cplx(g->value[i][j]);
    enum err err = matrix_check(&work->size);
    if (err)
        return err;
    free_scales(&work->size, r, c);
    for (size_t i = 0; i < g->rows; i++)
        for (size_t j = 0; j < g->cols; j++)
            g->value[i][j] = cplx_scale(g->value[i][j], r[i] * c[j]);
    err = cmatrix_pseudo_inverse(g, &work->pseudo, &work->inverse);
    if (err)
        return err;
    for (size_t i = 0; i < g->rows; i++)
        for (size_t j = 0; j < g->cols; j++) {
            struct cplx lambda = cplx_mul(g->value[i][j], work->inverse.value[j][i]);
            if (magnitude)
                magnitude->value[i][j] = cplx_abs(lambda);
            if (real_part)
                real_part->value[i][j] = lambda.re;
        }
    if (magnitude) {
        magnitude->rows = g->rows;
        magnitude->cols = g->cols;
    }
    if (real_part) {
        real_part->rows = g->rows;
        real_part->cols = g->cols;
    }
    return ERR_OK;
}

enum err rga_of_pair(const struct interact_plant *plant, const struct pairs *pairs, uint8_t k,
                     real_t omega, struct rga_pair_work *work, real_t *magnitude)
{
    REFLUX_ASSERT(k < pairs->n && pairs->n <= INTERACT_MAX);
    struct cplx diagonal[INTERACT_MAX];
    if (!real_is_finite(omega) || omega < REAL_C(0.0))
        return ERR_RANGE;
    interact_response(plant, pairs, omega, &work->response);
    /* Rows over their element of the pair, which relative gains do not depend on. */
    for (size_t i = 0; i < pairs->n; i++) {
        struct cplx *row = work->response.value[i], own = row[i];
        if (!(of_cplx(own) > REAL_C(0.0)))
            return ERR_SINGULAR;
        for (size_t j = 0; j < pairs->n; j++)
            row[j] = cplx_div(row[j], own);
    }
    enum err err = clu_factor(&work->response, &work->lu);
    if (err)
        return ERR_SINGULAR;
    clu_inverse_diagonal(&work->lu, diagonal);
    *magnitude = cplx_abs(diagonal[k]);
    return ERR_OK;
}

real_t rga_number(const struct matrix *lambda, const struct pairs *pairs)
{
    REFLUX_ASSERT(pairs->n <= INTERACT_MAX);
    real_t sum = REAL_C(0.0);
    for (size_t k = 0; k < pairs->n; k++)
        for (size_t l = 0; l < pairs->n; l++) {
            real_t one = k == l ? REAL_C(1.0) : REAL_C(0.0);
            sum += real_abs(lambda->value[pairs->output[k]][pairs->input[l]] - one);
        }
    return sum;
}

real_t rga_smallest_error(const struct matrix *lambda, uint8_t *output, uint8_t *input)
{
    real_t most = REAL_C(-1.0);
    for (size_t i = 0; i < lambda->rows; i++)
        for (size_t j = 0; j < lambda->cols; j++)
            if (real_abs(lambda->value[i][j]) > most) {
                most = real_abs(lambda->value[i][j]);
                *output = (uint8_t)i;
                *input = (uint8_t)j;
            }
    return REAL_C(1.0) / most;
}

enum err rga_determinant_sds(const struct matrix *gains, const struct matrix *sd,
                             const struct matrix *common, struct rga_work *work, real_t *sds)
{
    if (gains->rows != gains->cols || sd->rows != gains->rows || sd->cols != gains->cols)
        return ERR_RANGE;
    enum err err = matrix_check(gains);
    if (err)
        return err;
    real_t r[MATRIX_MAX], c[MATRIX_MAX], variance = REAL_C(0.0);
    err = invert_scaled(gains, work, r, c);
    if (err)
        return err;
    for (size_t i = 0; i < gains->rows; i++) {
        real_t together = REAL_C(0.0);
        for (size_t j = 0; j < gains->cols; j++) {
            real_t slope = work->inverse.value[j][i] * r[i] * c[j];
            real_t part = slope * sd->value[i][j];
            variance += part * part;
            if (common)
                together += slope * common->value[i][j];
        }
        variance -= together * together;
    }
    *sds = variance > REAL_C(0.0) ? REAL_C(1.0) / real_sqrt(variance) : INFINITY;
    return ERR_OK;
}

enum err niederlinski_index(const struct matrix *gains, const struct pairs *pairs,
                            struct rga_work *work, real_t *index)
{
    struct matrix *k = &work->scaled;
    size_t n = pairs->n;
    if (n < 1 || n > MATRIX_MAX)
        return ERR_RANGE;
    k->rows = k->cols = pairs->n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            if (pairs->output[i] >= gains->rows || pairs->input[j] >= gains->cols)
                return ERR_RANGE;
            k->value[i][j] = gains->value[pairs->output[i]][pairs->input[j]];
        }
    /* Rows over their diagonal element: the determinant is the index. */
    for (size_t i = 0; i < n; i++) {
        real_t diagonal = k->value[i][i];
        if (real_abs(diagonal) <= REAL_C(0.0))
            return ERR_SINGULAR;
        for (size_t j = 0; j < n; j++)
            k->value[i][j] = k->value[i][j] / diagonal;
    }
    enum err err = lu_factor(k, &work->pseudo.lu);
    if (err)
        return ERR_SINGULAR;
    int sign;
    real_t log_magnitude;
    lu_determinant(&work->pseudo.lu, &sign, &log_magnitude);
    *index = (real_t)sign * real_exp(log_magnitude);
    return ERR_OK;
}
