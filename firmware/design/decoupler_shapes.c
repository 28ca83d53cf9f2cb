#include "design/decoupler_shapes.h"

#include <stddef.h>

static enum err check_square_gains(const struct matrix *gains)
{
    enum err err = matrix_check(gains);
    if (err)
        return err;
    return gains->rows == gains->cols && gains->rows <= DECOUPLER_SHAPE_LOOPS ? ERR_OK : ERR_RANGE;
}

/* Columns of D get a diagonal of 1; then what the loops see. */
static enum err finish_shape(const struct matrix *gains, struct decoupler_shape *shape)
{
    size_t n = gains->rows;
    shape->d.rows = shape->d.cols = gains->rows;
    for (size_t k = 0; k < n; k++) {
        real_t own = shape->d.value[k][k];
        for (size_t i = 0; i < n; i++)
            if (!(real_abs(shape->d.value[i][k]) <= REAL_C(1e6) * real_abs(own)) ||
                own == REAL_C(0.0))
                return ERR_SINGULAR;
        for (size_t i = 0; i < n; i++)
            shape->d.value[i][k] /= own;
    }
    enum err err = matrix_multiply(gains, &shape->d, &shape->seen);
    for (size_t k = 0; k < n && !err; k++) {
        real_t most = REAL_C(0.0), own = shape->seen.value[k][k], size = REAL_C(0.0);
        for (size_t l = 0; l < n; l++) {
            size += real_abs(gains->value[k][l] * shape->d.value[l][k]);
            if (l != k && real_abs(shape->seen.value[k][l]) > most)
                most = real_abs(shape->seen.value[k][l]);
        }
        if (!(real_abs(own) > (real_t)n * REAL_EPSILON * size))
            return ERR_SINGULAR;
        shape->gain[k] = own;
        shape->left[k] = most / real_abs(own);
    }
    return err;
}

enum err decoupler_partial(const struct matrix *gains,
                           const real_t factor[DECOUPLER_SHAPE_LOOPS][DECOUPLER_SHAPE_LOOPS],
                           struct decoupler_shape_work *work, struct decoupler_shape *shape)
{
    enum err err = check_square_gains(gains);
    if (err)
        return err;
    size_t n = gains->rows;
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l < n; l++)
            if (k != l && !real_within(factor[k][l], REAL_C(0.0), REAL_C(1.0)))
                return ERR_RANGE;
    err = matrix_pseudo_inverse(gains, &work->pseudo, &work->inverse);
    if (err)
        return err;
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l < n; l++)
            shape->d.value[k][l] =
                work->inverse.value[k][l] * (k == l ? REAL_C(1.0) : factor[k][l]);
    return finish_shape(gains, shape);
}

enum err decoupler_one_way(const struct matrix *gains, const uint8_t *rank,
                           struct decoupler_shape_work *work, struct decoupler_shape *shape)
{
    enum err err = check_square_gains(gains);
    if (err)
        return err;
    size_t n = gains->rows;
    unsigned seen = 0;
    for (size_t k = 0; k < n; k++)
        if (rank[k] < n)
            seen |= 1u << rank[k];
    if (seen != (1u << n) - 1u)
        return ERR_RANGE;
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l < n; l++)
            shape->d.value[k][l] = k == l ? REAL_C(1.0) : REAL_C(0.0);
    /* Loop rank[l] moves the inputs of those before it so that their outputs stay. */
    for (size_t l = 1; l < n; l++) {
        struct matrix *before = &work->inverse;
        real_t x[MATRIX_MAX];
        before->rows = before->cols = (uint8_t)l;
        for (size_t i = 0; i < l; i++) {
            x[i] = -gains->value[rank[i]][rank[l]];
            for (size_t j = 0; j < l; j++)
                before->value[i][j] = gains->value[rank[i]][rank[j]];
        }
        err = lu_factor(before, &work->pseudo.lu);
        if (err)
            return err;
        lu_solve(&work->pseudo.lu, x, x);
        for (size_t i = 0; i < l; i++)
            shape->d.value[rank[i]][rank[l]] = x[i];
    }
    return finish_shape(gains, shape);
}

enum err decoupler_by_directions(const struct matrix *gains, real_t condition_hi,
                                 struct decoupler_shape_work *work, struct decoupler_shape *shape,
                                 uint8_t *limited)
{
    enum err err = check_square_gains(gains);
    if (!err && !real_within(condition_hi, REAL_C(1.0), REAL_C(1e4)))
        err = ERR_RANGE;
    if (!err)
        err = svd_decompose(&work->svd, gains);
    if (err)
        return err;
    const struct svd *svd = &work->svd;
    size_t n = gains->rows;
    if (!(svd->s[0] > REAL_C(0.0)))
        return ERR_SINGULAR;
    *limited = 0;
    real_t inverse[DECOUPLER_SHAPE_LOOPS];
    for (size_t k = 0; k < n; k++) {
        bool weak = svd->s[k] * condition_hi < svd->s[0];
        inverse[k] = weak ? condition_hi / svd->s[0] : REAL_C(1.0) / svd->s[k];
        *limited = (uint8_t)(*limited + weak);
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            real_t sum = REAL_C(0.0);
            for (size_t k = 0; k < n; k++)
                sum += svd->v.value[i][k] * inverse[k] * svd->u.value[j][k];
            shape->d.value[i][j] = sum;
        }
    return finish_shape(gains, shape);
}
