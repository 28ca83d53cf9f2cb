#include "kinds/composition/covariance_root.h"

#include "base/assertion.h"
#include "kinds/composition/covariance_root_state.h"
#include "num/ud.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define M_MAX ((size_t)COLUMN_COMPONENTS_MAX - 1)
_Static_assert(M_MAX == 3, "what is expanded, is so for one, two and three mole fractions");

/* Functions for each row of columns take m, the number of mole fractions, and are expanded for each m with their loops undone: that takes
 * half of the instructions for two of them and a quarter for three. Functions for a stage are not expanded. */
#define EXPANDED inline __attribute__((always_inline))
#define UNDONE   _Pragma("GCC unroll 8")

/* Squares below count as none: a reflection could not be made of them with all its digits. */
#define SQUARES_LEAST REAL_C(1e-30)

/* Least diagonal element of S. */
#define ROOT_LEAST REAL_C(1e-12) /* squared: COVARIANCE_LEAST */

void covariance_root_begin(struct covariance_root *c, size_t stages, size_t m, real_t *ud,
                           real_t *own, real_t *left)
{
    *c = (struct covariance_root){
        .stages = stages, .m = m, .n = stages * m, .ud = ud, .own = own, .left = left};
}

void covariance_root_start(struct covariance_root *c)
{
    c->err = ERR_OK;
}

enum err covariance_root_err(const struct covariance_root *c)
{
    return c->err;
}

/* ---- reflections ---- */

/* m of them, which turn the columns of two neighbouring stages: reflection[i] over the m columns on the left and the first i + 1 on the right,
 * scaled so that a row loses reflection[i] times its product with it. */
struct turn {
    real_t reflection[M_MAX][2 * M_MAX];
};

static void turn_row(size_t m, const struct turn *turn, size_t i, real_t *row)
{
    const real_t *v = turn->reflection[i];
    real_t sum = ZERO;

    for (size_t k = 0; k <= m + i; k++)
        sum = real_fma(v[k], row[k], sum);
    for (size_t k = 0; k <= m + i; k++)
        row[k] = real_fma(-v[k], sum, row[k]);
}

/* The one that leaves of a row its element m + i alone; the row becomes that. */
static void make_reflection(size_t m, size_t i, real_t *row, struct turn *turn)
{
    real_t *v = turn->reflection[i], squares = ZERO, kept = row[m + i], scale = ZERO;

    for (size_t k = 0; k <= m + i; k++)
        squares = real_fma(row[k], row[k], squares);
    real_t norm = kept < ZERO ? -real_sqrt(squares) : real_sqrt(squares);
    if (squares > SQUARES_LEAST)
        scale = ONE / real_sqrt(real_fma(kept, norm, squares));
    for (size_t k = 0; k < m + i; k++) {
        v[k] = row[k] * scale;
        row[k] = ZERO;
    }
    v[m + i] = (kept + norm) * scale;
    row[m + i] = -norm;
}

/* rows[m][2m], left and right beside each other, become [0, upper triangular]. */
static void make_turn(size_t m, real_t rows[M_MAX][2 * M_MAX], struct turn *turn)
{
    for (size_t i = m; i-- > 0;) {
        make_reflection(m, i, rows[i], turn);
        for (size_t k = 0; k < i; k++)
            turn_row(m, turn, i, rows[k]);
    }
}

/* Takes the product of reflection i with a row off the row, with m and i known. */
static EXPANDED void reflect_row(size_t m, size_t i, const real_t *v, real_t *row)
{
    real_t sum = v[0] * row[0];
    UNDONE
    for (size_t k = 1; k < 2 * M_MAX; k++)
        if (k <= m + i)
            sum = real_fma(v[k], row[k], sum);
    UNDONE
    for (size_t k = 0; k < 2 * M_MAX; k++)
        if (k <= m + i)
            row[k] = real_fma(-v[k], sum, row[k]);
}

static EXPANDED void turn_all(size_t m, real_t v[M_MAX][2 * M_MAX], real_t *row)
{
    if (m > 2)
        reflect_row(m, 2, v[2], row);
    if (m > 1)
        reflect_row(m, 1, v[1], row);
    reflect_row(m, 0, v[0], row);
}

/* The first `rows` rows of the columns of stages s - 1 and s, a multiple of m; those of s get their scale. */
static EXPANDED void turn_columns(size_t m, const struct covariance_root *c,
                                  const struct turn *turn, size_t s, size_t rows,
                                  const real_t *scale)
{
    real_t *column[2 * M_MAX], v[M_MAX][2 * M_MAX], part[M_MAX];

    UNDONE
    for (size_t i = 0; i < m; i++) {
        part[i] = scale[i];
        UNDONE
        for (size_t k = 0; k < 2 * m; k++)
            if (k <= m + i)
                v[i][k] = turn->reflection[i][k];
    }
    UNDONE
    for (size_t k = 0; k < 2 * m; k++)
        column[k] = c->ud + ud_count((s - 1) * m + k);
    for (size_t i = 0; i < rows; i += m) {
        UNDONE
        for (size_t r = 0; r < m; r++) {
            real_t row[2 * M_MAX];
            UNDONE
            for (size_t k = 0; k < 2 * m; k++)
                row[k] = column[k][r];
            turn_all(m, v, row);
            UNDONE
            for (size_t k = 0; k < 2 * m; k++)
                column[k][r] = k < m ? row[k] : row[k] * part[k - m];
        }
        UNDONE
        for (size_t k = 0; k < 2 * m; k++)
            column[k] += m;
    }
}

static void turn_rows(size_t m, struct turn *turn, real_t *row)
{
    if (m == 1)
        turn_all(1, turn->reflection, row);
    else if (m == 2)
        turn_all(2, turn->reflection, row);
    else if (m == 3)
        turn_all(3, turn->reflection, row);
}

/* A turn of stages s - 1 and s, for all rows above block s. */
static void turn_above(size_t m, const struct covariance_root *c, struct turn *turn, size_t s,
                       const real_t *scale)
{
    real_t *own = c->own + (s - 1) * m * m, *right[M_MAX], row[2 * M_MAX];
    size_t first = (s - 1) * m;

    if (m == 1)
        turn_columns(1, c, turn, s, first, scale);
    else if (m == 2)
        turn_columns(2, c, turn, s, first, scale);
    else if (m == 3)
        turn_columns(3, c, turn, s, first, scale);
    for (size_t k = 0; k < m; k++)
        right[k] = c->ud + ud_count(s * m + k) + first;
    for (size_t i = 0; i < m; i++, own += m) {
        for (size_t k = 0; k < m; k++) {
            row[k] = own[k];
            row[m + k] = right[k][i];
        }
        turn_rows(m, turn, row);
        for (size_t k = 0; k < m; k++) {
            own[k] = row[k];
            right[k][i] = row[m + k] * scale[k];
        }
    }
}

/* ---- extras ---- */

/* Their columns: what pushes, Phi, keep, and back to ones on the diagonal. */
void covariance_root_extra(struct covariance_root *c, const struct covariance_step *step, size_t k)
{
    REFLUX_ASSERT(k < step->extras);
    real_t *column = c->ud + ud_count(c->n + k), root = real_sqrt(column[c->n + k]), all = ZERO;

    for (size_t i = 0; i < c->n; i++)
        column[i] *= root;
    for (size_t e = 0; e <= k; e++) {
        real_t part = e == k ? root : column[c->n + e] * root;
        const real_t *push = step->push + e * c->n;
        for (size_t i = 0; i < c->n; i++)
            column[i] = real_fma(push[i], part, column[i]);
    }
    column_transition_apply(step->transition, column);
    real_t diagonal = step->keep[k] * root;
    if (!(diagonal > ROOT_LEAST))
        diagonal = ROOT_LEAST;
    real_t scale = ONE / diagonal;
    for (size_t i = 0; i < c->n; i++) {
        column[i] *= scale;
        all += column[i];
    }
    if (!isfinite(all))
        c->err = ERR_NOT_FINITE;
    for (size_t e = 0; e < k; e++)
        column[c->n + e] *= step->keep[e] * root * scale;
    column[c->n + k] = diagonal * diagonal;
}

/* ---- up ---- */

/* The two columns of a stage, rows above their diagonal block, two fractions: r of the stage itself and below, b what is carried. */
static void sweep_pair(const struct covariance_root *c, const struct column_transition *t, size_t s,
                       const real_t *root, const real_t *r, real_t *w)
{
    size_t stride = column_transition_stride(2);
    real_t *first = c->ud + ud_count(2 * s), *second = first + 2 * s + 1, *a = first + 2 * s,
           *b = second + 2 * s;
    const real_t *p = t->factors + s * stride;
    real_t a0 = r[0], b0 = r[1], a1 = r[2], b1 = r[3], of_a = root[0], of_b = root[1];

    while (a > first) {
        p -= stride;
        a -= 2;
        b -= 2;
        real_t l = p[12];
        a0 = real_fma(l, a0, a[0] * of_a);
        a1 = real_fma(l, a1, a[1] * of_a);
        b0 = real_fma(l, b0, b[0] * of_b);
        b1 = real_fma(l, b1, b[1] * of_b);
        real_t upper = real_fma(p[1], a1, p[0] * a0), next = real_fma(p[1], b1, p[0] * b0);
        a1 = real_fma(p[3], a1, p[2] * a0);
        b1 = real_fma(p[3], b1, p[2] * b0);
        a0 = upper;
        b0 = next;
        a[0] = a0;
        a[1] = a1;
        b[0] = b0;
        b[1] = b1;
    }
    a0 = a1 = b0 = b1 = ZERO; /* now of the vapour */
    for (const real_t *end = first + 2 * s; a < end; a += 2, b += 2, p += stride) {
        real_t a_low = real_fma(p[5], a1, real_fma(p[4], a0, a[0])),
               a_high = real_fma(p[7], a1, real_fma(p[6], a0, a[1])),
               b_low = real_fma(p[5], b1, real_fma(p[4], b0, b[0])),
               b_high = real_fma(p[7], b1, real_fma(p[6], b0, b[1])), keep = p[13];
        a[0] = a_low;
        a[1] = a_high;
        b[0] = b_low;
        b[1] = b_high;
        a0 = real_fma(p[9], a_high, real_fma(p[8], a_low, keep * a0));
        a1 = real_fma(p[11], a_high, real_fma(p[10], a_low, keep * a1));
        b0 = real_fma(p[9], b_high, real_fma(p[8], b_low, keep * b0));
        b1 = real_fma(p[11], b_high, real_fma(p[10], b_low, keep * b1));
    }
    w[0] = a0;
    w[1] = b0;
    w[2] = a1;
    w[3] = b1;
}

/* One column of any other number of fractions. */
static EXPANDED void sweep_one(size_t m, real_t *column, const struct column_transition *t,
                               size_t s, real_t root, const real_t *begin, real_t *vapour)
{
    size_t stride = column_transition_stride(m);
    const real_t *p = t->factors + s * stride;
    real_t r[M_MAX], b[M_MAX], w[M_MAX], *here = column + s * m;

    UNDONE
    for (size_t i = 0; i < m; i++)
        r[i] = begin[i];
    while (here > column) {
        p -= stride;
        here -= m;
        UNDONE
        for (size_t i = 0; i < m; i++)
            b[i] = real_fma(p[3 * m * m], r[i], here[i] * root);
        UNDONE
        for (size_t i = 0; i < m; i++) {
            r[i] = p[i * m] * b[0];
            UNDONE
            for (size_t k = 1; k < m; k++)
                r[i] = real_fma(p[i * m + k], b[k], r[i]);
            here[i] = r[i];
        }
    }
    UNDONE
    for (size_t i = 0; i < m; i++)
        w[i] = ZERO;
    for (; here < column + s * m; here += m, p += stride) {
        const real_t *by_vapour = p + m * m, *g = by_vapour + m * m;
        UNDONE
        for (size_t i = 0; i < m; i++) {
            b[i] = here[i];
            UNDONE
            for (size_t k = 0; k < m; k++)
                b[i] = real_fma(by_vapour[i * m + k], w[k], b[i]);
            here[i] = b[i];
        }
        UNDONE
        for (size_t i = 0; i < m; i++) {
            w[i] *= g[m * m + 1];
            UNDONE
            for (size_t k = 0; k < m; k++)
                w[i] = real_fma(g[i * m + k], b[k], w[i]);
        }
    }
    UNDONE
    for (size_t i = 0; i < m; i++)
        vapour[i] = w[i];
}

/* Columns of stage s: scaled to those of S, through the sweep down to the reboiler and the one up again as far as row block s - 1.
 * own gets their diagonal block between the sweeps, w the vapour that comes from below. */
static void sweep_columns(size_t m, const struct covariance_root *c,
                          const struct column_transition *t, size_t s, real_t *own, real_t *w)
{
    const real_t *p = t->factors + s * column_transition_stride(m);
    real_t root[M_MAX], r[M_MAX], vapour[M_MAX];

    for (size_t j = 0; j < m; j++) {
        const real_t *block = c->ud + ud_count(s * m + j) + s * m;
        root[j] = real_sqrt(block[j]);
        for (size_t i = 0; i < m; i++) {
            real_t sum = p[i * m + j];
            for (size_t k = 0; k < j; k++)
                sum = real_fma(p[i * m + k], block[k], sum);
            own[i * m + j] = sum * root[j];
        }
    }
    if (m == 2) {
        sweep_pair(c, t, s, root, own, w);
        return;
    }
    for (size_t j = 0; j < m; j++) {
        for (size_t i = 0; i < m; i++)
            r[i] = own[i * m + j];
        real_t *column = c->ud + ud_count(s * m + j);
        if (m == 1)
            sweep_one(1, column, t, s, root[j], r, vapour);
        else
            sweep_one(3, column, t, s, root[j], r, vapour);
        for (size_t i = 0; i < m; i++)
            w[i * m + j] = vapour[i];
    }
}

/* The stage's own rows, in the columns of one stage: d = r + T w, w <- keep w + G d. */
static void pass_pair(const real_t *p, real_t *d, real_t *w)
{
    const real_t *g = p + 4;
    real_t keep = g[5];
    for (size_t j = 0; j < 2; j++) {
        real_t low = w[j], high = w[2 + j], first = real_fma(p[1], high, real_fma(p[0], low, d[j])),
               second = real_fma(p[3], high, real_fma(p[2], low, d[2 + j]));
        d[j] = first;
        d[2 + j] = second;
        w[j] = real_fma(g[1], second, real_fma(g[0], first, keep * low));
        w[2 + j] = real_fma(g[3], second, real_fma(g[2], first, keep * high));
    }
}

static void pass_stage(size_t m, const struct column_transition *t, size_t s, real_t *d, real_t *w)
{
    const real_t *p = t->factors + s * column_transition_stride(m) + m * m, *g = p + m * m;
    real_t next[M_MAX * M_MAX];

    if (m == 2) {
        pass_pair(p, d, w);
        return;
    }
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            for (size_t k = 0; k < m; k++)
                d[i * m + j] = real_fma(p[i * m + k], w[k * m + j], d[i * m + j]);
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++) {
            next[i * m + j] = g[m * m + 1] * w[i * m + j];
            for (size_t k = 0; k < m; k++)
                next[i * m + j] = real_fma(g[i * m + k], d[k * m + j], next[i * m + j]);
        }
    for (size_t i = 0; i < m * m; i++)
        w[i] = next[i];
}

void covariance_root_up(struct covariance_root *c, const struct column_transition *t, size_t s)
{
    size_t m = c->m;
    real_t *own = c->own + s * m * m, *left = c->left + s * m * m;
    real_t w[M_MAX * M_MAX], rows[M_MAX][2 * M_MAX], row[2 * M_MAX], ones[M_MAX];
    struct turn turn;

    for (size_t j = 0; j < m; j++)
        ones[j] = ONE;
    sweep_columns(m, c, t, s, own, w);
    pass_stage(m, t, s, own, w);
    if (s > 0) {
        for (size_t i = 0; i < m * m; i++)
            left[i] = ZERO;
        pass_stage(m, t, s, left, c->below);
    }
    if (s > 0 && s + 1 < c->stages) {
        for (size_t i = 0; i < m; i++)
            for (size_t k = 0; k < m; k++) {
                rows[i][k] = c->below[i * m + k];
                rows[i][m + k] = w[i * m + k];
            }
        make_turn(m, rows, &turn);
        turn_above(m, c, &turn, s, ones);
        for (size_t i = 0; i < m; i++) {
            for (size_t k = 0; k < m; k++) {
                row[k] = left[i * m + k];
                row[m + k] = own[i * m + k];
            }
            turn_rows(m, &turn, row);
            for (size_t k = 0; k < m; k++) {
                left[i * m + k] = row[k];
                own[i * m + k] = row[m + k];
                w[i * m + k] = k < i ? ZERO : rows[i][m + k];
            }
        }
    }
    for (size_t i = 0; i < m * m; i++)
        c->below[i] = w[i];
}

/* ---- back ---- */

/* Columns of stage s are done but for their scale: their diagonal block is upper triangular. */
static void finish_block(size_t m, struct covariance_root *c, size_t s,
                         real_t rows[M_MAX][2 * M_MAX], real_t *scale)
{
    for (size_t j = 0; j < m; j++) {
        real_t *column = c->ud + ud_count(s * m + j) + s * m, diagonal = rows[j][m + j];
        if (!isfinite(diagonal))
            c->err = ERR_NOT_FINITE;
        if (!(real_abs(diagonal) > ROOT_LEAST))
            diagonal = diagonal < ZERO ? -ROOT_LEAST : ROOT_LEAST;
        scale[j] = ONE / diagonal;
        for (size_t i = 0; i < j; i++)
            column[i] = rows[i][m + j] * scale[j];
        column[j] = diagonal * diagonal;
    }
}

void covariance_root_back(struct covariance_root *c, size_t s)
{
    size_t m = c->m;
    const real_t *own = c->own + s * m * m, *left = c->left + s * m * m;
    real_t rows[M_MAX][2 * M_MAX], scale[M_MAX];
    struct turn turn;

    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < m; k++) {
            rows[i][k] = s > 0 ? left[i * m + k] : ZERO;
            rows[i][m + k] = own[i * m + k];
        }
    make_turn(m, rows, &turn);
    finish_block(m, c, s, rows, scale);
    if (s > 0)
        turn_above(m, c, &turn, s, scale);
}
