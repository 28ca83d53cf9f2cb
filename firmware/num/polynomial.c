#include "num/polynomial.h"

#include <stddef.h>

#include "base/assertion.h"

#define LARGEST REAL_C(1e15)
/* Part of its terms' magnitudes up to which a coefficient counts as rounding. At 4 x 4 there are 24 products, each with up to three
 * roundings, and sums with up to as many as a polynomial has coefficients. */
#define LOST (REAL_C(32.0) * REAL_EPSILON)

void polynomial_set(struct polynomial *p, const real_t *coefficient, unsigned n)
{
    p->n = (uint8_t)(n < POLYNOMIAL_MOST ? n : POLYNOMIAL_MOST);
    for (unsigned k = 0; k < p->n; k++)
        p->value[k] = coefficient[k];
}

enum err polynomial_check(const struct polynomial *p)
{
    if (p->n > POLYNOMIAL_MOST)
        return ERR_RANGE;
    for (unsigned k = 0; k < p->n; k++)
        if (!(real_abs(p->value[k]) <= LARGEST))
            return ERR_NOT_FINITE;
    return ERR_OK;
}

enum err polynomial_add_product(struct polynomial *sum, real_t scale, const struct polynomial *a,
                                const struct polynomial *b)
{
    REFLUX_ASSERT(a->n <= POLYNOMIAL_MOST && b->n <= POLYNOMIAL_MOST && sum->n <= POLYNOMIAL_MOST);
    if (!a->n || !b->n)
        return ERR_OK;
    unsigned n = (unsigned)a->n + b->n - 1u;
    if (n > POLYNOMIAL_MOST)
        return ERR_FULL;
    for (; sum->n < n; sum->n++)
        sum->value[sum->n] = REAL_C(0.0);
    for (unsigned i = 0; i < a->n; i++)
        for (unsigned j = 0; j < b->n; j++)
            sum->value[i + j] += scale * a->value[i] * b->value[j];
    return ERR_OK;
}

unsigned polynomial_delay(const struct polynomial *p)
{
    REFLUX_ASSERT(p->n <= POLYNOMIAL_MOST);
    unsigned k = 0;
    while (k < p->n && p->value[k] == REAL_C(0.0))
        k++;
    return k;
}

void polynomial_advance(struct polynomial *p, unsigned k)
{
    REFLUX_ASSERT(p->n <= POLYNOMIAL_MOST);
    if (k > p->n)
        k = p->n;
    p->n = (uint8_t)(p->n - k);
    for (unsigned i = 0; i < p->n; i++)
        p->value[i] = p->value[i + k];
}

void polynomial_trim(struct polynomial *p)
{
    REFLUX_ASSERT(p->n <= POLYNOMIAL_MOST);
    while (p->n && p->value[p->n - 1u] == REAL_C(0.0))
        p->n--;
}

real_t polynomial_value(const struct polynomial *p, real_t x)
{
    REFLUX_ASSERT(p->n <= POLYNOMIAL_MOST);
    real_t value = REAL_C(0.0);
    for (unsigned k = p->n; k-- > 0;)
        value = value * x + p->value[k];
    return value;
}

real_t polynomial_size(const struct polynomial *p)
{
    REFLUX_ASSERT(p->n <= POLYNOMIAL_MOST);
    real_t size = REAL_C(0.0);
    for (unsigned k = 0; k < p->n; k++)
        size += real_abs(p->value[k]);
    return size;
}

/* ---- matrices ---- */

bool polynomial_zeros_within(const struct polynomial *p, real_t radius)
{
    REFLUX_ASSERT(p->n <= POLYNOMIAL_MOST);
    struct polynomial c = {0};
    unsigned n = p->n ? p->n - 1u : 0u;
    real_t times = REAL_C(1.0) / p->value[0];
    for (unsigned k = 0; k <= n; k++, times /= radius)
        c.value[k] = p->value[k] * times;
    for (; n > 0; n--) {
        struct polynomial before = c;
        real_t last = c.value[n];
        if (!(real_abs(last) < REAL_C(1.0)))
            return false;
        for (unsigned k = 0; k < n; k++)
            c.value[k] =
                (before.value[k] - last * before.value[n - k]) / (REAL_C(1.0) - last * last);
    }
    return true;
}

enum err polynomial_matrix_check(const struct polynomial_matrix *m)
{
    if (m->rows < 1 || m->rows > POLYNOMIAL_MATRIX_MOST || m->cols < 1 ||
        m->cols > POLYNOMIAL_MATRIX_MOST)
        return ERR_RANGE;
    for (unsigned i = 0; i < m->rows; i++)
        for (unsigned j = 0; j < m->cols; j++) {
            enum err err = polynomial_check(&m->value[i][j]);
            if (err)
                return err;
        }
    return ERR_OK;
}

enum err polynomial_matrix_multiply(const struct polynomial_matrix *a,
                                    const struct polynomial_matrix *b, struct polynomial_matrix *c)
{
    REFLUX_ASSERT(a->rows <= POLYNOMIAL_MATRIX_MOST && a->cols <= POLYNOMIAL_MATRIX_MOST &&
                  b->cols <= POLYNOMIAL_MATRIX_MOST);
    if (a->cols != b->rows)
        return ERR_RANGE;
    c->rows = a->rows;
    c->cols = b->cols;
    for (unsigned i = 0; i < c->rows; i++)
        for (unsigned j = 0; j < c->cols; j++) {
            c->value[i][j].n = 0;
            for (unsigned k = 0; k < a->cols; k++) {
                enum err err = polynomial_add_product(&c->value[i][j], REAL_C(1.0), &a->value[i][k],
                                                      &b->value[k][j]);
                if (err)
                    return err;
            }
        }
    return ERR_OK;
}

/* ---- determinant and adjugate ---- */

/* Adds sign a b to sum, and the magnitudes of its terms to size. a_size holds those of a. */
static enum err add_term(struct polynomial *sum, struct polynomial *size, real_t sign,
                         const struct polynomial *a, const struct polynomial *a_size,
                         const struct polynomial *b)
{
    enum err err = polynomial_add_product(sum, sign, a, b);
    if (err || !a_size->n || !b->n)
        return err;
    unsigned n = (unsigned)a_size->n + b->n - 1u;
    if (n > POLYNOMIAL_MOST)
        return ERR_FULL;
    for (; size->n < n; size->n++)
        size->value[size->n] = REAL_C(0.0);
    for (unsigned i = 0; i < a_size->n; i++)
        for (unsigned j = 0; j < b->n; j++)
            size->value[i + j] += real_abs(a_size->value[i] * b->value[j]);
    return ERR_OK;
}

static void clean(struct polynomial *p, const struct polynomial *size)
{
    for (unsigned k = 0; k < p->n; k++)
        if (real_abs(p->value[k]) <= LOST * size->value[k])
            p->value[k] = REAL_C(0.0);
    polynomial_trim(p);
}

/* Pairs of columns, in the order of polynomial_minors.two. */
static const uint8_t pair[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static unsigned pair_of(unsigned a, unsigned b)
{
    REFLUX_ASSERT(a < b && b < POLYNOMIAL_MATRIX_MOST);
    unsigned k = 0;
    while (pair[k][0] != a || pair[k][1] != b)
        k++;
    return k;
}

/* Finds all minors of rows r and s. */
static enum err find_two(const struct polynomial_matrix *m, unsigned r, unsigned s,
                         struct polynomial_minors *w)
{
    for (unsigned k = 0; k < 6; k++) {
        if (pair[k][1] >= m->cols)
            continue;
        const struct polynomial *a = &m->value[r][pair[k][0]], *b = &m->value[r][pair[k][1]];
        w->two[k].n = w->two_size[k].n = 0;
        enum err err =
            add_term(&w->two[k], &w->two_size[k], REAL_C(1.0), a, a, &m->value[s][pair[k][1]]);
        if (!err)
            err =
                add_term(&w->two[k], &w->two_size[k], REAL_C(-1.0), b, b, &m->value[s][pair[k][0]]);
        if (err)
            return err;
    }
    return ERR_OK;
}

/* Finds the minor of the two rows in w->two and of row r, in columns c[0] < c[1] < c[2]. */
static enum err find_three(const struct polynomial_matrix *m, unsigned r, const uint8_t c[3],
                           struct polynomial_minors *w, struct polynomial *minor,
                           struct polynomial *size)
{
    minor->n = size->n = 0;
    for (unsigned k = 0; k < 3; k++) {
        unsigned two = pair_of(c[k == 0 ? 1 : 0], c[k == 2 ? 1 : 2]);
        enum err err = add_term(minor, size, k == 1 ? REAL_C(-1.0) : REAL_C(1.0), &w->two[two],
                                &w->two_size[two], &m->value[r][c[k]]);
        if (err)
            return err;
    }
    return ERR_OK;
}

static void others_than(unsigned left_out, unsigned n, uint8_t other[POLYNOMIAL_MATRIX_MOST])
{
    unsigned count = 0;
    for (unsigned k = 0; k < n; k++)
        if (k != left_out)
            other[count++] = (uint8_t)k;
}

enum err polynomial_determinant(const struct polynomial_matrix *m, struct polynomial_minors *work,
                                struct polynomial *det)
{
    static const uint8_t three[3] = {0, 1, 2};
    enum err err = polynomial_matrix_check(m);
    if (!err && m->rows != m->cols)
        err = ERR_RANGE;
    if (err)
        return err;
    if (m->rows == 1) {
        *det = m->value[0][0];
        polynomial_trim(det);
        return ERR_OK;
    }
    err = find_two(m, 0, 1, work);
    if (err)
        return err;
    det->n = work->part_size.n = 0;
    if (m->rows == 2) {
        *det = work->two[0];
        work->part_size = work->two_size[0];
    } else if (m->rows == 3) {
        err = find_three(m, 2, three, work, det, &work->part_size);
    } else {
        uint8_t other[POLYNOMIAL_MATRIX_MOST];
        for (unsigned k = 0; k < 4 && !err; k++) {
            others_than(k, 4, other);
            err = find_three(m, 2, other, work, &work->three, &work->three_size);
            if (!err)
                err = add_term(det, &work->part_size, k % 2 ? REAL_C(1.0) : REAL_C(-1.0),
                               &work->three, &work->three_size, &m->value[3][k]);
        }
    }
    if (err)
        return err;
    clean(det, &work->part_size);
    return ERR_OK;
}

/* Finds the minor without row i and column j. */
static enum err find_minor(const struct polynomial_matrix *m, unsigned i, unsigned j,
                           struct polynomial_minors *w, struct polynomial *minor)
{
    uint8_t row[POLYNOMIAL_MATRIX_MOST], col[POLYNOMIAL_MATRIX_MOST];
    others_than(i, m->rows, row);
    others_than(j, m->cols, col);
    if (m->rows == 2) {
        *minor = m->value[row[0]][col[0]];
        polynomial_trim(minor);
        return ERR_OK;
    }
    enum err err = find_two(m, row[0], row[1], w);
    if (err)
        return err;
    if (m->rows == 3) {
        unsigned two = pair_of(col[0], col[1]);
        *minor = w->two[two];
        w->part_size = w->two_size[two];
    } else {
        err = find_three(m, row[2], col, w, minor, &w->part_size);
        if (err)
            return err;
    }
    clean(minor, &w->part_size);
    return ERR_OK;
}

enum err polynomial_adjugate(const struct polynomial_matrix *m, struct polynomial_minors *work,
                             struct polynomial_matrix *adj)
{
    enum err err = polynomial_matrix_check(m);
    if (!err && m->rows != m->cols)
        err = ERR_RANGE;
    if (err)
        return err;
    adj->rows = adj->cols = m->rows;
    if (m->rows == 1) {
        const real_t one = REAL_C(1.0);
        polynomial_set(&adj->value[0][0], &one, 1);
        return ERR_OK;
    }
    for (unsigned i = 0; i < m->rows; i++)
        for (unsigned j = 0; j < m->rows; j++) {
            struct polynomial *p = &adj->value[j][i];
            err = find_minor(m, i, j, work, p);
            if (err)
                return err;
            for (unsigned k = 0; k < p->n && (i + j) % 2; k++)
                p->value[k] = -p->value[k];
        }
    return ERR_OK;
}
