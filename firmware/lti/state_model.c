#include "lti/state_model.h"

#include <stddef.h>

#define TERMS     12 /* of the series: at a norm of 1/4 the next one is 2e-17 */
#define HALVES_HI 60

static enum err refuse_model(const char **field, const char **wanted, enum err code,
                             const char *is_wrong, const char *would_do)
{
    if (field)
        *field = is_wrong;
    if (wanted)
        *wanted = would_do;
    return code;
}

enum err state_model_check(const struct state_model *m, const char **field, const char **wanted)
{
    unsigned n = m->a.rows;
    if (n < 1 || n > STATE_MODEL_STATES || m->a.cols != n)
        return refuse_model(field, wanted, ERR_RANGE, "a", "square, of 1 to 16 states");
    if (m->b.rows != n || m->b.cols < 1 || m->b.cols > STATE_MODEL_OUTPUTS)
        return refuse_model(field, wanted, ERR_RANGE, "b", "a row for each state, 1 to 8 columns");
    if (m->c.cols != n || m->c.rows < 1 || m->c.rows > STATE_MODEL_OUTPUTS)
        return refuse_model(field, wanted, ERR_RANGE, "c", "a column for each state, 1 to 8 rows");
    if (m->e.cols > STATE_MODEL_DISTURBANCES || (m->e.cols && m->e.rows != n))
        return refuse_model(field, wanted, ERR_RANGE, "e", "a row for each state, 0 to 8 columns");
    if (!real_within(m->period_s, REAL_C(0.0), REAL_C(1e6)))
        return refuse_model(field, wanted, ERR_RANGE, "period_s", "0 (continuous) to 1e6");
    const struct matrix *all[] = {&m->a, &m->b, &m->c, &m->e};
    static const char *const name[] = {"a", "b", "c", "e"};
    for (size_t k = 0; k < 4; k++)
        if (all[k]->cols && matrix_check(all[k]))
            return refuse_model(field, wanted, ERR_NOT_FINITE, name[k],
                                "numbers of magnitude to 1e15");
    return ERR_OK;
}

/* Largest sum of the magnitudes of a row. */
static real_t row_norm(const struct matrix *a)
{
    real_t most = REAL_C(0.0);
    for (size_t i = 0; i < a->rows; i++) {
        real_t sum = REAL_C(0.0);
        for (size_t j = 0; j < a->cols; j++)
            sum += real_abs(a->value[i][j]);
        if (sum > most)
            most = sum;
    }
    return most;
}

static void scale_matrix(struct matrix *a, real_t by)
{
    for (size_t i = 0; i < a->rows; i++)
        for (size_t j = 0; j < a->cols; j++)
            a->value[i][j] *= by;
}

static void add_identity(struct matrix *a)
{
    for (size_t i = 0; i < a->rows; i++)
        a->value[i][i] += REAL_C(1.0);
}

/* sum <- (exp(A h) - 1)/A = h (1 + Z/2 (1 + Z/3 (1 + ...))), Z = A h, from its innermost bracket. */
static enum err sum_series(const struct matrix *z, real_t h, struct state_model_work *w)
{
    w->sum = *z;
    scale_matrix(&w->sum, REAL_C(1.0) / (real_t)TERMS);
    add_identity(&w->sum);
    for (unsigned k = TERMS - 1u; k >= 2; k--) {
        enum err err = matrix_multiply(z, &w->sum, &w->next);
        if (err)
            return err;
        w->sum = w->next;
        scale_matrix(&w->sum, REAL_C(1.0) / (real_t)k);
        add_identity(&w->sum);
    }
    scale_matrix(&w->sum, h);
    return ERR_OK;
}

enum err state_model_sample(const struct state_model *m, real_t period_s,
                            struct state_model_work *w, struct state_model *s)
{
    enum err err = state_model_check(m, NULL, NULL);
    if (err)
        return err;
    if (m->period_s != REAL_C(0.0) || !(period_s > REAL_C(0.0)) || !(period_s <= REAL_C(1e6)))
        return ERR_RANGE;
    real_t size = row_norm(&m->a) * period_s, h = period_s;
    unsigned halves = 0;
    for (; size > REAL_C(0.25) && halves < HALVES_HI; halves++) {
        size *= REAL_C(0.5);
        h *= REAL_C(0.5);
    }
    if (size > REAL_C(0.25))
        return ERR_RANGE;
    s->a = m->a;
    scale_matrix(&s->a, h);
    err = sum_series(&s->a, h, w);
    /* What is kept is exp(Z) - 1: adding 1 before the doublings would round away what slow states do in so short a time. */
    w->power = m->a;
    if (!err)
        err = matrix_multiply(&w->power, &w->sum, &s->a);
    for (unsigned k = 0; k < halves && !err; k++) {
        /* Integral over twice the time: sum + exp(Z) sum = 2 sum + (exp(Z) - 1) sum. */
        err = matrix_multiply(&s->a, &w->sum, &w->next);
        for (size_t i = 0; i < w->sum.rows && !err; i++)
            for (size_t j = 0; j < w->sum.cols; j++)
                w->sum.value[i][j] = REAL_C(2.0) * w->sum.value[i][j] + w->next.value[i][j];
        /* exp(2 Z) - 1 = 2 (exp(Z) - 1) + (exp(Z) - 1)^2 */
        w->power = s->a;
        if (!err)
            err = matrix_multiply(&w->power, &w->power, &s->a);
        for (size_t i = 0; i < s->a.rows && !err; i++)
            for (size_t j = 0; j < s->a.cols; j++)
                s->a.value[i][j] += REAL_C(2.0) * w->power.value[i][j];
    }
    if (err)
        return err;
    add_identity(&s->a);
    s->c = m->c;
    s->e.rows = m->e.rows;
    s->e.cols = 0;
    err = matrix_multiply(&w->sum, &m->b, &s->b);
    if (!err && m->e.cols)
        err = matrix_multiply(&w->sum, &m->e, &s->e);
    s->period_s = period_s;
    return err || state_model_check(s, NULL, NULL) ? ERR_RANGE : ERR_OK;
}
