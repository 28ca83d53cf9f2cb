#include "design/state_zeros.h"

#include <stddef.h>

#include "base/assertion.h"

/* moved <- (A + B invariant) N, N the last columns of V: what the held plant makes of states that the chain calls 0. */
static void move_hidden(const struct state_model *m, const struct matrix *invariant,
                        const struct matrix *v, size_t first, struct matrix *moved)
{
    size_t n = m->a.rows, count = n - first;
    moved->rows = (uint8_t)n;
    moved->cols = (uint8_t)count;
    for (size_t col = 0; col < count; col++) {
        real_t u[STATE_MODEL_OUTPUTS];
        for (size_t l = 0; l < m->b.cols; l++) {
            u[l] = REAL_C(0.0);
            for (size_t k = 0; k < n; k++)
                u[l] += invariant->value[l][k] * v->value[k][first + col];
        }
        for (size_t i = 0; i < n; i++) {
            real_t sum = REAL_C(0.0);
            for (size_t k = 0; k < n; k++)
                sum += m->a.value[i][k] * v->value[k][first + col];
            for (size_t l = 0; l < m->b.cols; l++)
                sum += m->b.value[i][l] * u[l];
            moved->value[i][col] = sum;
        }
    }
}

static void judge_modes(bool sampled, struct state_modes *zeros)
{
    REFLUX_ASSERT(zeros->n <= STATE_MODEL_STATES);
    for (size_t k = 0; k < zeros->n; k++) {
        real_t far = sampled ? cplx_abs(zeros->mode[k]) : zeros->mode[k].re;
        if (k == 0 || far > zeros->outermost)
            zeros->outermost = far;
    }
}

enum err state_zeros_find(const struct state_model *m, const struct matrix *chain,
                          const struct matrix *invariant, struct state_zeros_work *w,
                          struct state_modes *zeros)
{
    size_t n = m->a.rows, fixed = chain->rows;
    *zeros = (struct state_modes){0};
    enum err err = svd_decompose(&w->svd, chain);
    if (err)
        return err;
    if (svd_rank(&w->svd, REAL_C(0.0)) < fixed)
        return ERR_SINGULAR;
    if (fixed == n)
        return ERR_OK;
    const struct matrix *v = &w->svd.v;
    move_hidden(m, invariant, v, fixed, &w->moved);
    zeros->n = w->modes.rows = w->modes.cols = (uint8_t)(n - fixed);
    real_t squares = REAL_C(0.0);
    for (size_t i = 0; i < zeros->n; i++)
        for (size_t j = 0; j < zeros->n; j++) {
            real_t sum = REAL_C(0.0);
            for (size_t k = 0; k < n; k++)
                sum += v->value[k][fixed + i] * w->moved.value[k][j];
            w->modes.value[i][j] = cplx(sum, REAL_C(0.0));
            squares += sum * sum;
        }
    zeros->error = REAL_C(16.0) * (real_t)zeros->n * REAL_EPSILON * real_sqrt(squares);
    err = ceigen_values(&w->modes, zeros->mode);
    judge_modes(m->period_s > REAL_C(0.0), zeros);
    return err;
}

enum err state_loop_radius(const struct state_model *m, const struct state_law *law,
                           struct state_zeros_work *w, real_t *radius)
{
    size_t n = m->a.rows, loops = m->b.cols, all = n;
    size_t integral[STATE_MODEL_OUTPUTS], before[STATE_MODEL_OUTPUTS];
    for (size_t i = 0; i < loops; i++) {
        integral[i] = all;
        all += law->integral_s[i] > REAL_C(0.0) ? 1u : 0u;
        before[i] = all;
        all += law->derivative_s[i] > REAL_C(0.0) ? 1u : 0u;
    }
    if (all > MATRIX_MAX)
        return ERR_FULL;
    struct cmatrix *a = &w->modes;
    a->rows = a->cols = (uint8_t)all;
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j < all; j++)
            a->value[i][j] = cplx(i < n && j < n ? m->a.value[i][j] : REAL_C(0.0), REAL_C(0.0));
    /* moved: B G, and what each loop's setpoint would do is what its integral and its differences do. */
    enum err err = matrix_multiply(&m->b, law->g, &w->moved);
    for (size_t i = 0; i < n && !err; i++) {
        for (size_t j = 0; j < n; j++)
            for (size_t l = 0; l < loops; l++) {
                real_t per_sample = law->derivative_s[l] / m->period_s;
                a->value[i][j].re += m->b.value[i][l] * law->f->value[l][j] -
                                     w->moved.value[i][l] * per_sample * m->c.value[l][j];
            }
        for (size_t l = 0; l < loops; l++) {
            if (law->integral_s[l] > REAL_C(0.0))
                a->value[i][integral[l]].re = w->moved.value[i][l];
            if (law->derivative_s[l] > REAL_C(0.0))
                a->value[i][before[l]].re =
                    w->moved.value[i][l] * law->derivative_s[l] / m->period_s;
        }
    }
    for (size_t l = 0; l < loops && !err; l++) {
        if (law->integral_s[l] > REAL_C(0.0))
            a->value[integral[l]][integral[l]].re = REAL_C(1.0);
        for (size_t j = 0; j < n; j++) {
            if (law->integral_s[l] > REAL_C(0.0))
                a->value[integral[l]][j].re = -m->c.value[l][j] * m->period_s / law->integral_s[l];
            if (law->derivative_s[l] > REAL_C(0.0))
                a->value[before[l]][j].re = m->c.value[l][j];
        }
    }
    struct cplx value[STATE_MODEL_STATES];
    if (!err)
        err = ceigen_values(a, value);
    *radius = REAL_C(0.0);
    for (size_t k = 0; k < all && !err; k++)
        if (cplx_abs(value[k]) > *radius)
            *radius = cplx_abs(value[k]);
    return err;
}
