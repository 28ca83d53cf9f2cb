#include "dense_ekf.h"

#include <string.h>

#define N DENSE_STATES

static real_t *entry(struct dense_ekf *ekf, size_t row, size_t col)
{
    return &ekf->band[col * DENSE_WIDTH + DENSE_UPPER + row - col];
}

/* ---- the band ---- */

static size_t first_of(size_t row)
{
    return row > DENSE_LOWER ? row - DENSE_LOWER : 0;
}

static size_t last_of(size_t row)
{
    return row + DENSE_UPPER < N - 1 ? row + DENSE_UPPER : N - 1;
}

/* I - h J in the place of J, and its factors in place of it. Its diagonal outweighs the rest: no pivots are sought. */
static void factor(struct dense_ekf *ekf)
{
    for (size_t k = 0; k < N * DENSE_WIDTH; k++)
        ekf->band[k] *= -ekf->h;
    for (size_t i = 0; i < N; i++)
        *entry(ekf, i, i) += 1;
    for (size_t p = 0; p < N; p++) {
        real_t inverse = 1 / *entry(ekf, p, p);
        size_t end = last_of(p);
        *entry(ekf, p, p) = inverse;
        for (size_t i = p + 1; i < N && i <= p + DENSE_LOWER; i++) {
            real_t part = *entry(ekf, i, p) * inverse;
            *entry(ekf, i, p) = part;
            for (size_t j = p + 1; j <= end; j++)
                *entry(ekf, i, j) -= part * *entry(ekf, p, j);
        }
    }
}

/* row -= sum of count rows that lie at `from`, each by its part, columns 0 to columns - 1. Rows are taken up to four at a time, so that
 * each is read once and the row itself written once. */
static void take_rows(real_t *row, const real_t *from, const real_t *part, size_t count,
                      size_t columns)
{
    for (; count >= 4; count -= 4, from += 4 * N, part += 4) {
        const real_t *a = from, *b = a + N, *c = b + N, *d = c + N;
        real_t pa = part[0], pb = part[1], pc = part[2], pd = part[3];
        for (size_t k = 0; k < columns; k++)
            row[k] -= a[k] * pa + b[k] * pb + c[k] * pc + d[k] * pd;
    }
    if (count == 3) {
        const real_t *a = from, *b = a + N, *c = b + N;
        real_t pa = part[0], pb = part[1], pc = part[2];
        for (size_t k = 0; k < columns; k++)
            row[k] -= a[k] * pa + b[k] * pb + c[k] * pc;
        return;
    }
    for (; count > 0; count--, from += N, part++)
        for (size_t k = 0; k < columns; k++)
            row[k] -= from[k] * *part;
}

/* m <- (I - h J)^-1 m, all columns at once; lower: of the result only what is not right of the diagonal is wanted. */
static void solve_rows(struct dense_ekf *ekf, real_t *m, bool lower)
{
    real_t part[DENSE_WIDTH];
    for (size_t i = 0; i < N; i++) {
        size_t first = first_of(i);
        for (size_t j = first; j < i; j++)
            part[j - first] = *entry(ekf, i, j);
        take_rows(&m[i * N], &m[first * N], part, i - first, N);
    }
    for (size_t i = N; i-- > 0;) {
        size_t columns = lower ? i + 1 : N, last = last_of(i);
        for (size_t j = i + 1; j <= last; j++)
            part[j - i - 1] = *entry(ekf, i, j);
        take_rows(&m[i * N], &m[(i + 1) * N], part, last - i, columns);
        real_t inverse = *entry(ekf, i, i);
        for (size_t k = 0; k < columns; k++)
            m[i * N + k] *= inverse;
    }
}

static void solve_state(struct dense_ekf *ekf, real_t *x)
{
    for (size_t i = 0; i < N; i++)
        for (size_t j = first_of(i); j < i; j++)
            x[i] -= *entry(ekf, i, j) * x[j];
    for (size_t i = N; i-- > 0;) {
        for (size_t j = i + 1; j <= last_of(i); j++)
            x[i] -= *entry(ekf, i, j) * x[j];
        x[i] *= *entry(ekf, i, i);
    }
}

/* ---- covariance: what is right of the diagonal is copied from what is left of it, once a sample ---- */

static void mirror(real_t *p)
{
    for (size_t i = 1; i < N; i++)
        for (size_t j = 0; j < i; j++)
            p[j * N + i] = p[i * N + j];
}

static void transpose(real_t *m)
{
    for (size_t i = 1; i < N; i++)
        for (size_t j = 0; j < i; j++) {
            real_t kept = m[i * N + j];
            m[i * N + j] = m[j * N + i];
            m[j * N + i] = kept;
        }
}

static void carry_by_euler(struct dense_ekf *ekf, real_t h)
{
    real_t part[DENSE_WIDTH];
    memset(ekf->work, 0, sizeof ekf->work);
    for (size_t i = 0; i < N; i++) { /* work = -h J P */
        size_t first = first_of(i), last = last_of(i);
        for (size_t j = first; j <= last; j++)
            part[j - first] = h * *entry(ekf, i, j);
        take_rows(&ekf->work[i * N], &ekf->p[first * N], part, last + 1 - first, N);
    }
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j <= i; j++)
            ekf->p[i * N + j] -= ekf->work[i * N + j] + ekf->work[j * N + i];
}

static void carry_by_steps(struct dense_ekf *ekf)
{
    for (uint32_t k = 0; k < ekf->steps; k++) {
        if (k > 0)
            mirror(ekf->p);
        carry_by_euler(ekf, ekf->h / (real_t)ekf->steps);
    }
}

static void carry_by_band(struct dense_ekf *ekf)
{
    solve_rows(ekf, ekf->p, false);
    transpose(ekf->p);
    solve_rows(ekf, ekf->p, true);
}

/* to = a b', two rows by two at a time; lower: what is not right of the diagonal, or one beside it. N is even. */
static void product(real_t *to, const real_t *a, const real_t *b, bool lower)
{
    for (size_t i = 0; i < N; i += 2)
        for (size_t j = 0; j < (lower ? i + 2 : N); j += 2) {
            const real_t *a0 = &a[i * N], *a1 = a0 + N, *b0 = &b[j * N], *b1 = b0 + N;
            real_t s00 = 0, s01 = 0, s10 = 0, s11 = 0;
            for (size_t k = 0; k < N; k++) {
                s00 += a0[k] * b0[k];
                s01 += a0[k] * b1[k];
                s10 += a1[k] * b0[k];
                s11 += a1[k] * b1[k];
            }
            to[i * N + j] = s00;
            to[i * N + j + 1] = s01;
            to[(i + 1) * N + j] = s10;
            to[(i + 1) * N + j + 1] = s11;
        }
}

static void carry_by_transition(struct dense_ekf *ekf)
{
    memset(ekf->transition, 0, sizeof ekf->transition);
    for (size_t i = 0; i < N; i++)
        ekf->transition[i * N + i] = 1;
    solve_rows(ekf, ekf->transition, false);
    product(ekf->work, ekf->transition, ekf->p, false); /* P is symmetric */
    product(ekf->p, ekf->work, ekf->transition, true);
}

/* P over the sample, and ekf->change, which is h dx/dt, to what it comes to. */
static void carry(struct dense_ekf *ekf)
{
    if (ekf->form == DENSE_EULER) {
        carry_by_euler(ekf, ekf->h);
        return;
    }
    if (ekf->form == DENSE_STEPS)
        carry_by_steps(ekf); /* while the band is still J */
    factor(ekf);
    solve_state(ekf, ekf->change);
    if (ekf->form == DENSE_BAND)
        carry_by_band(ekf);
    if (ekf->form == DENSE_TRANSITION)
        carry_by_transition(ekf);
}

/* ---- one temperature ---- */

/* b: dT/dx of the stage. change: what the state is moved by so far. Only what is not right of the diagonal of P is read and written. */
static void work_in(struct dense_ekf *ekf, size_t stage, const real_t *b, real_t e)
{
    real_t pb[N], *p = ekf->p;
    size_t at = 2 * stage;
    for (size_t i = 0; i <= at; i++)
        pb[i] = p[at * N + i] * b[0] + p[(at + 1) * N + i] * b[1];
    for (size_t i = at + 1; i < N; i++)
        pb[i] = p[i * N + at] * b[0] + p[i * N + at + 1] * b[1];
    real_t inverse = 1 / (pb[at] * b[0] + pb[at + 1] * b[1] + ekf->noise2);
    e -= b[0] * ekf->change[at] + b[1] * ekf->change[at + 1];
    for (size_t i = 0; i < N; i++) {
        real_t gain = pb[i] * inverse, *row = &p[i * N];
        ekf->change[i] += gain * e;
        for (size_t j = 0; j <= i; j++)
            row[j] -= gain * pb[j];
    }
}

enum err dense_ekf_model(struct dense_ekf *ekf, const struct column_inputs *inputs, const real_t *t)
{
    struct column_fault fault;
    enum err err = column_set_inputs(&ekf->column, inputs, &fault);
    if (!err)
        err = column_rates(&ekf->column, ekf->x, ekf->change);
    if (err)
        return err;
    column_jacobian(&ekf->column, ekf->x, ekf->band, DENSE_WIDTH, DENSE_UPPER);
    for (size_t k = 0; k < BENCH_SENSORS; k++) {
        real_t dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX], full[3];
        size_t s = ekf->stage[k];
        ekf->e[k] = t[k] - ekf->column.temperature[s];
        full[0] = ekf->x[2 * s];
        full[1] = ekf->x[2 * s + 1];
        full[2] = 1 - full[0] - full[1];
        vle_slopes(3, full, &ekf->column.k[3 * s], &ekf->column.dk[3 * s], ekf->b[k], dy);
    }
    for (size_t i = 0; i < N; i++)
        ekf->change[i] *= ekf->h;
    return ERR_OK;
}

void dense_ekf_covariance(struct dense_ekf *ekf)
{
    carry(ekf);
    for (size_t i = 0; i < N; i++)
        ekf->p[i * N + i] += ekf->h * ekf->model2;
    for (size_t k = 0; k < BENCH_SENSORS; k++)
        work_in(ekf, ekf->stage[k], ekf->b[k], ekf->e[k]);
    mirror(ekf->p);
    (void)column_move(&ekf->column, ekf->x, ekf->change);
}

enum err dense_ekf_step(struct dense_ekf *ekf, const struct column_inputs *inputs, const real_t *t)
{
    enum err err = dense_ekf_model(ekf, inputs, t);
    if (!err)
        dense_ekf_covariance(ekf);
    return err;
}

/* ---- beginning ---- */

static uint32_t steps_of(struct dense_ekf *ekf)
{
    real_t v[N], w[N], largest = 0;
    column_jacobian(&ekf->column, ekf->x, ekf->band, DENSE_WIDTH, DENSE_UPPER);
    for (size_t i = 0; i < N; i++)
        v[i] = i % 2 ? 1 : REAL_C(-0.7);
    for (unsigned k = 0; k < 300; k++) { /* powers of J on a vector */
        largest = 0;
        for (size_t i = 0; i < N; i++) {
            w[i] = 0;
            for (size_t j = first_of(i); j <= last_of(i); j++)
                w[i] += *entry(ekf, i, j) * v[j];
            largest = real_abs(w[i]) > largest ? real_abs(w[i]) : largest;
        }
        for (size_t i = 0; i < N; i++)
            v[i] = w[i] / largest;
    }
    return (uint32_t)(BENCH_STEP_S * largest) +
           1; /* each term of J P + P J' goes twice as fast as J */
}

enum err dense_ekf_begin(struct dense_ekf *ekf, const struct composition_block *like,
                         enum dense_form form)
{
    struct column_fault fault;
    memset(ekf, 0, sizeof *ekf);
    ekf->config = like->model.table.config;
    ekf->form = form;
    ekf->h = form == DENSE_EULER ? REAL_C(0.3) : BENCH_STEP_S;
    ekf->noise2 = like->sensors.sensor[0].noise2; /* of all of them, as the bench begins */
    ekf->model2 = like->sensors.model2;
    for (size_t k = 0; k < BENCH_SENSORS; k++)
        ekf->stage[k] = like->sensors.sensor[k].stage;
    for (size_t i = 0; i < N; i++) {
        ekf->x[i] = like->model.x[i];
        ekf->p[i * N + i] = like->sensors.model2 * 3600;
    }
    enum err err = column_init(&ekf->column, &ekf->config, &fault);
    if (!err)
        err = column_set_inputs(&ekf->column, &like->model.inputs, &fault);
    if (!err)
        err = column_rates(&ekf->column, ekf->x, ekf->change);
    if (!err)
        ekf->steps = steps_of(ekf);
    return err;
}

uint32_t dense_ekf_bytes(enum dense_form form)
{
    uint32_t unused = form == DENSE_TRANSITION ? 0 : form == DENSE_BAND ? 2 : 1;
    return (uint32_t)(sizeof(struct dense_ekf) - unused * N * N * sizeof(real_t));
}
