#include "estimate/covariance_ud.h"

#include "num/ud.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define M_MAX (COLUMN_COMPONENTS_MAX - 1)

/* What is done for each row of columns stands here twice: for two mole fractions, which is what a column on a board mostly has, and for
 * any number. With its loops undone it takes a third of the instructions (tests/bench/results.md). */

/* A step's parts, in this order. */
enum phase { PHASE_NOISE, PHASE_EXTRAS, PHASE_UP, PHASE_BACK, PHASE_GROWN, PHASE_DONE };

/* Squares below count as none: a reflection could not be made of them with all its digits. */
#define SQUARES_LEAST REAL_C(1e-30)

/* Least diagonal element of S. */
#define ROOT_LEAST REAL_C(1e-12) /* squared: COVARIANCE_LEAST */

static size_t triangle_of(const struct covariance_ud *c)
{
    return c->n + c->extras;
}

size_t covariance_ud_bytes(size_t stages, size_t m, size_t extras)
{
    size_t n = stages * m;
    return (ud_count(n + extras) + 2 * n * m + 2 * (n + extras)) * sizeof(real_t);
}

enum err covariance_ud_begin(struct covariance_ud *c, size_t stages, size_t m, size_t extras,
                             const real_t *variance, void *memory)
{
    if (stages < 2 || m < 1 || m > M_MAX || stages > COLUMN_STATES_MAX / m ||
        extras > COVARIANCE_EXTRAS_MAX)
        return ERR_RANGE;
    size_t n = stages * m, all = n + extras;
    for (size_t i = 0; i < all; i++) {
        if (!isfinite(variance[i]))
            return ERR_NOT_FINITE;
        if (variance[i] < ZERO)
            return ERR_RANGE;
    }
    *c = (struct covariance_ud){.stages = stages, .m = m, .n = n, .extras = extras, .ud = memory};
    c->own = c->ud + ud_count(all);
    c->left = c->own + n * m;
    c->spare = c->left + n * m;
    for (size_t i = 0; i < all; i++)
        c->spare[i] = variance[i] > COVARIANCE_LEAST ? variance[i] : COVARIANCE_LEAST;
    ud_set_diagonal(c->ud, all, c->spare);
    return ERR_OK;
}

/* ---- reflections ---- */

/* m of them, which turn the columns of two neighbouring stages: of[i] over the m columns on the left and the first i + 1 on the right,
 * scaled so that a row loses of[i] times its product with it. */
struct turn {
    real_t of[M_MAX][2 * M_MAX];
};

static void turn_row(size_t m, const struct turn *turn, size_t i, real_t *row)
{
    const real_t *v = turn->of[i];
    real_t sum = ZERO;

    for (size_t k = 0; k <= m + i; k++)
        sum = real_fma(v[k], row[k], sum);
    for (size_t k = 0; k <= m + i; k++)
        row[k] = real_fma(-v[k], sum, row[k]);
}

/* The one that leaves of a row its element m + i alone; the row becomes that. */
static void make_reflection(size_t m, size_t i, real_t *row, struct turn *turn)
{
    real_t *v = turn->of[i], squares = ZERO, kept = row[m + i], scale = ZERO;

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

#define TURN_TAKEN(turn)                                                                           \
    const real_t v0 = (turn)->of[1][0], v1 = (turn)->of[1][1], v2 = (turn)->of[1][2],              \
                 v3 = (turn)->of[1][3], w0 = (turn)->of[0][0], w1 = (turn)->of[0][1],              \
                 w2 = (turn)->of[0][2]

/* All of them for two fractions and the row a, b on the left, p, q on the right. */
#define TURN_FOUR(a, b, p, q)                                                                      \
    do {                                                                                           \
        real_t sum = real_fma(v3, (q), real_fma(v2, (p), real_fma(v1, (b), v0 * (a))));            \
        (a) = real_fma(-v0, sum, (a));                                                             \
        (b) = real_fma(-v1, sum, (b));                                                             \
        (p) = real_fma(-v2, sum, (p));                                                             \
        (q) = real_fma(-v3, sum, (q)) * scale_q;                                                   \
        sum = real_fma(w2, (p), real_fma(w1, (b), w0 * (a)));                                      \
        (a) = real_fma(-w0, sum, (a));                                                             \
        (b) = real_fma(-w1, sum, (b));                                                             \
        (p) = real_fma(-w2, sum, (p)) * scale_p;                                                   \
    } while (0)

/* All of them, of any number. */
static void turn_rows(size_t m, const struct turn *turn, real_t *row)
{
    if (m == 2) {
        TURN_TAKEN(turn);
        const real_t scale_p = ONE, scale_q = ONE;
        TURN_FOUR(row[0], row[1], row[2], row[3]);
        return;
    }
    for (size_t i = m; i-- > 0;)
        turn_row(m, turn, i, row);
}

static void turn_fours(const struct covariance_ud *c, const struct turn *turn, size_t s,
                       size_t rows, const real_t *scale)
{
    TURN_TAKEN(turn);
    const real_t scale_p = scale[0], scale_q = scale[1];
    real_t *a = c->ud + ud_count(2 * s - 2), *b = a + 2 * s - 1, *p = b + 2 * s, *q = p + 2 * s + 1;

    for (const real_t *end = a + rows; a < end; a += 2, b += 2, p += 2, q += 2) {
        real_t a0 = a[0], b0 = b[0], p0 = p[0], q0 = q[0];
        TURN_FOUR(a0, b0, p0, q0);
        a[0] = a0;
        b[0] = b0;
        p[0] = p0;
        q[0] = q0;
        real_t a1 = a[1], b1 = b[1], p1 = p[1], q1 = q[1];
        TURN_FOUR(a1, b1, p1, q1);
        a[1] = a1;
        b[1] = b1;
        p[1] = p1;
        q[1] = q1;
    }
}

/* The first `rows` rows of the columns of stages s - 1 and s; those of s get their scale. */
static void turn_columns(size_t m, const struct covariance_ud *c, const struct turn *turn, size_t s,
                         size_t rows, const real_t *scale)
{
    real_t *column[2 * M_MAX], row[2 * M_MAX];

    if (m == 2) {
        turn_fours(c, turn, s, rows, scale);
        return;
    }
    for (size_t k = 0; k < 2 * m; k++)
        column[k] = c->ud + ud_count((s - 1) * m + k);
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; k < 2 * m; k++)
            row[k] = column[k][i];
        turn_rows(m, turn, row);
        for (size_t k = 0; k < m; k++) {
            column[k][i] = row[k];
            column[m + k][i] = row[m + k] * scale[k];
        }
    }
}

/* A turn of stages s - 1 and s, for all rows above block s. */
static void turn_above(size_t m, const struct covariance_ud *c, const struct turn *turn, size_t s,
                       const real_t *scale)
{
    real_t *own = c->own + (s - 1) * m * m, *right[M_MAX], row[2 * M_MAX];
    size_t first = (s - 1) * m;

    turn_columns(m, c, turn, s, first, scale);
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
static void carry_extra(struct covariance_ud *c, const struct covariance_step *step, size_t k)
{
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
static void sweep_pair(const struct covariance_ud *c, const struct column_transition *t, size_t s,
                       const real_t *root, const real_t *r, real_t *w)
{
    size_t stride = column_transition_stride(2);
    real_t *first = c->ud + ud_count(2 * s), *second = first + 2 * s + 1, *a = first + 2 * s,
           *b = second + 2 * s;
    const real_t *p = t->of + s * stride;
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

/* One column of any number of fractions: r[m] of the stage itself. */
static void sweep_one(size_t m, real_t *column, const struct column_transition *t, size_t s,
                      real_t root, real_t *r, real_t *w)
{
    size_t stride = column_transition_stride(m);
    const real_t *p = t->of + s * stride;
    real_t b[M_MAX];

    for (size_t row = s * m; row > 0;) {
        p -= stride;
        row -= m;
        for (size_t i = 0; i < m; i++)
            b[i] = real_fma(p[3 * m * m], r[i], column[row + i] * root);
        for (size_t i = 0; i < m; i++) {
            r[i] = ZERO;
            for (size_t k = 0; k < m; k++)
                r[i] = real_fma(p[i * m + k], b[k], r[i]);
            column[row + i] = r[i];
        }
    }
    for (size_t i = 0; i < m; i++)
        w[i] = ZERO;
    for (size_t row = 0; row < s * m; row += m, p += stride) {
        const real_t *by_vapour = p + m * m, *g = by_vapour + m * m;
        for (size_t i = 0; i < m; i++)
            for (size_t k = 0; k < m; k++)
                column[row + i] = real_fma(by_vapour[i * m + k], w[k], column[row + i]);
        for (size_t i = 0; i < m; i++) {
            w[i] *= g[m * m + 1];
            for (size_t k = 0; k < m; k++)
                w[i] = real_fma(g[i * m + k], column[row + k], w[i]);
        }
    }
}

/* Columns of stage s: scaled to those of S, through the sweep down to the reboiler and the one up again as far as row block s - 1.
 * own gets their diagonal block between the sweeps, w the vapour that comes from below. */
static void sweep_columns(size_t m, const struct covariance_ud *c,
                          const struct column_transition *t, size_t s, real_t *own, real_t *w)
{
    const real_t *p = t->of + s * column_transition_stride(m);
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
        sweep_one(m, c->ud + ud_count(s * m + j), t, s, root[j], r, vapour);
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
    const real_t *p = t->of + s * column_transition_stride(m) + m * m, *g = p + m * m;
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

static void go_up(size_t m, struct covariance_ud *c, const struct column_transition *t, size_t s)
{
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
static void finish_block(size_t m, struct covariance_ud *c, size_t s, real_t rows[M_MAX][2 * M_MAX],
                         real_t *scale)
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

static void go_back(size_t m, struct covariance_ud *c, size_t s)
{
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

/* ---- a step ---- */

/* The next thing of a phase; returns how many elements of the triangle it was about. */
static size_t do_extra(struct covariance_ud *c, const struct covariance_step *step)
{
    carry_extra(c, step, c->at);
    return 2 * c->n;
}

static size_t do_up(struct covariance_ud *c, const struct covariance_step *step)
{
    go_up(c->m, c, step->transition, c->at);
    return 2 * (c->at + 1) * c->m * c->m;
}

static size_t do_back(struct covariance_ud *c)
{
    size_t s = c->stages - 1 - c->at;
    go_back(c->m, c, s);
    return (s + 1) * c->m * c->m;
}

/* Variance for `at`, and with it for the state behind it where there is one more of `left` and it is the next. */
static size_t add_from(struct covariance_ud *c, size_t at, const real_t *variance, size_t left)
{
    if (!(variance[0] > ZERO))
        return 1;
    if (left > 1 && variance[1] > ZERO) {
        ud_add_pair(c->ud, at + 1, variance[1], variance[0], c->spare);
        c->at++;
        return ud_count(at + 1);
    }
    ud_add_at(c->ud, at, variance[0], c->spare);
    return ud_count(at) / 2;
}

static size_t add_noise(struct covariance_ud *c, const struct covariance_step *step)
{
    size_t i = (step->noise_first + c->at) % c->n, left = step->noise_count - c->at;
    return add_from(c, i, step->noise + i, left < c->n - i ? left : c->n - i);
}

static size_t length_of(const struct covariance_ud *c, const struct covariance_step *step)
{
    switch ((enum phase)c->phase) {
    case PHASE_EXTRAS:
    case PHASE_GROWN:
        return c->extras;
    case PHASE_UP:
    case PHASE_BACK:
        return c->stages;
    case PHASE_NOISE:
        return step->noise_count;
    case PHASE_DONE:
        break;
    }
    return 0;
}

static size_t do_next(struct covariance_ud *c, const struct covariance_step *step)
{
    switch ((enum phase)c->phase) {
    case PHASE_EXTRAS:
        return do_extra(c, step);
    case PHASE_UP:
        return do_up(c, step);
    case PHASE_BACK:
        return do_back(c);
    case PHASE_GROWN:
        return add_from(c, c->n + c->at, step->grown + c->at, c->extras - c->at);
    case PHASE_NOISE:
        return add_noise(c, step);
    case PHASE_DONE:
        break;
    }
    return 1;
}

bool covariance_ud_carry_piece(struct covariance_ud *c, const struct covariance_step *step,
                               size_t effort)
{
    size_t done = 0;

    if (c->phase == PHASE_NOISE && c->at == 0)
        c->err = ERR_OK;
    while (c->phase < PHASE_DONE) {
        if (c->at == length_of(c, step)) {
            c->phase++;
            c->at = 0;
            continue;
        }
        if (done >= effort)
            return true;
        done += do_next(c, step);
        c->at++;
    }
    c->phase = PHASE_NOISE;
    return false;
}

/* ---- measurements ---- */

/* From `at` on: f = U'h, g = D f. Returns f'g. */
static real_t project(const struct covariance_ud *c, const struct covariance_measurement *z,
                      real_t *f, real_t *g)
{
    size_t end = z->at + z->count, all = triangle_of(c), extra = c->n + z->extra;
    const real_t *column = c->ud + ud_count(z->at);
    real_t variance = ZERO;

    if (z->extra >= c->extras)
        extra = all;
    for (size_t j = z->at; j < all; column += ++j) {
        real_t sum = j < end ? z->slope[j - z->at] : ZERO, own = column[j];
        for (size_t i = z->at, above = j < end ? j : end; i < above; i++)
            sum = real_fma(column[i], z->slope[i - z->at], sum);
        if (j >= extra)
            sum = real_fma(j == extra ? ONE : column[extra], z->extra_slope, sum);
        own *= sum;
        f[j] = sum;
        g[j] = own;
        variance = real_fma(sum, own, variance);
    }
    return variance;
}

real_t covariance_ud_of(struct covariance_ud *c, const struct covariance_measurement *z)
{
    return project(c, z, c->spare, c->spare + triangle_of(c));
}

real_t covariance_ud_take(struct covariance_ud *c, const struct covariance_measurement *z,
                          real_t *gain)
{
    size_t all = triangle_of(c);
    real_t alpha = project(c, z, c->spare, gain) + z->variance, scale = ZERO;

    for (size_t j = 0; j < z->at; j++)
        c->spare[j] = gain[j] = ZERO;
    if (!(z->variance > ZERO) || !(alpha > ZERO) || !isfinite(alpha)) {
        for (size_t j = 0; j < all; j++)
            gain[j] = ZERO;
        return ZERO;
    }
    alpha = ud_correct_from(c->ud, all, z->at, c->spare, gain, z->variance, ONE);
    scale = ONE / alpha;
    for (size_t j = 0; j < all; j++)
        gain[j] *= scale;
    return alpha;
}

void covariance_ud_extremes(struct covariance_ud *c, real_t *least, real_t *most)
{
    size_t all = triangle_of(c);
    real_t *variance = c->spare;
    const real_t *column = c->ud;

    for (size_t j = 0; j < all; column += ++j) {
        real_t d = column[j];
        for (size_t i = 0; i < j; i++)
            variance[i] = real_fma(column[i] * column[i], d, variance[i]);
        variance[j] = d;
    }
    *least = *most = variance[0];
    for (size_t j = 1; j < all; j++) {
        *least = variance[j] < *least ? variance[j] : *least;
        *most = variance[j] > *most ? variance[j] : *most;
    }
}
