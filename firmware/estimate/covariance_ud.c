#include "estimate/covariance_ud.h"

#include "num/ud.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define M_MAX (COLUMN_COMPONENTS_MAX - 1)

/* As in model/column_implicit.c: expanded for two mole fractions, and for any number. */
#define EXPANDED inline __attribute__((always_inline))

/* A step's parts, in this order. */
enum phase { PHASE_EXTRAS, PHASE_UP, PHASE_BACK, PHASE_GROWN, PHASE_NOISE, PHASE_DONE };

/* Squares below count as none: a reflection could not be made of them with all its digits. */
#define SQUARES_LEAST REAL_C(1e-30)

/* Least diagonal element of S. */
#define ROOT_LEAST REAL_C(1e-9)

static size_t triangle_of(const struct covariance_ud *c)
{
    return c->n + c->extras;
}

size_t covariance_ud_bytes(size_t stages, size_t m, size_t extras)
{
    size_t n = stages * m;
    return (ud_count(n + extras) + 2 * n * m + n + extras) * sizeof(real_t);
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

static EXPANDED void turn_row(size_t m, const struct turn *turn, size_t i, real_t *row)
{
    const real_t *v = turn->of[i];
    real_t sum = ZERO;

    for (size_t k = 0; k <= m + i; k++)
        sum = real_fma(v[k], row[k], sum);
    for (size_t k = 0; k <= m + i; k++)
        row[k] = real_fma(-v[k], sum, row[k]);
}

/* The one that leaves of a row its element m + i alone. */
static EXPANDED void make_reflection(size_t m, size_t i, const real_t *row, struct turn *turn)
{
    real_t *v = turn->of[i], squares = ZERO, scale = ZERO;

    for (size_t k = 0; k <= m + i; k++)
        squares += row[k] * row[k];
    real_t norm = real_sqrt(squares), kept = row[m + i];
    if (squares > SQUARES_LEAST)
        scale = ONE / real_sqrt(squares + real_abs(kept) * norm);
    for (size_t k = 0; k < m + i; k++)
        v[k] = row[k] * scale;
    v[m + i] = (kept + (kept < ZERO ? -norm : norm)) * scale;
}

/* rows[m][2m], left and right beside each other, become [0, upper triangular]. */
static EXPANDED void make_turn(size_t m, real_t rows[M_MAX][2 * M_MAX], struct turn *turn)
{
    for (size_t i = m; i-- > 0;) {
        make_reflection(m, i, rows[i], turn);
        for (size_t k = 0; k <= i; k++)
            turn_row(m, turn, i, rows[k]);
    }
}

static EXPANDED void turn_rows(size_t m, const struct turn *turn, real_t *row)
{
    for (size_t i = m; i-- > 0;)
        turn_row(m, turn, i, row);
}

/* The first `rows` rows of the columns of stages s - 1 and s; those of s get their scale. */
static EXPANDED void turn_columns(size_t m, const struct covariance_ud *c, const struct turn *turn,
                                  size_t s, size_t rows, const real_t *scale)
{
    real_t *column[2 * M_MAX], row[2 * M_MAX];

    for (size_t k = 0; k < 2 * m; k++)
        column[k] = c->ud + ud_count((s - 1) * m + k);
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; k < 2 * m; k++)
            row[k] = column[k][i];
        turn_rows(m, turn, row);
        for (size_t k = 0; k < m; k++)
            column[k][i] = row[k];
        for (size_t k = m; k < 2 * m; k++)
            column[k][i] = scale ? row[k] * scale[k - m] : row[k];
    }
}

/* A turn of stages s - 1 and s, for all rows above block s. */
static EXPANDED void turn_above(size_t m, const struct covariance_ud *c, const struct turn *turn,
                                size_t s, const real_t *scale)
{
    real_t *own = c->own + (s - 1) * m * m, row[2 * M_MAX];
    size_t first = (s - 1) * m;

    turn_columns(m, c, turn, s, first, scale);
    for (size_t i = 0; i < m; i++) {
        for (size_t k = 0; k < m; k++) {
            row[k] = own[i * m + k];
            row[m + k] = c->ud[ud_count(s * m + k) + first + i];
        }
        turn_rows(m, turn, row);
        for (size_t k = 0; k < m; k++) {
            own[i * m + k] = row[k];
            c->ud[ud_count(s * m + k) + first + i] = scale ? row[m + k] * scale[k] : row[m + k];
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

/* Columns of stage s: scaled to those of S, through the sweep down to the reboiler and the one up again as far as row block s - 1.
 * own gets their diagonal block between the sweeps, w the vapour that comes from below. */
static EXPANDED void sweep_columns(size_t m, const struct covariance_ud *c,
                                   const struct column_transition *t, size_t s, real_t *own,
                                   real_t *w)
{
    size_t stride = column_transition_stride(m);
    const real_t *p = t->of + s * stride;
    real_t *column[M_MAX], root[M_MAX], r[M_MAX * M_MAX], b[M_MAX * M_MAX];

    for (size_t j = 0; j < m; j++) {
        column[j] = c->ud + ud_count(s * m + j);
        root[j] = real_sqrt(column[j][s * m + j]);
        for (size_t i = 0; i < m; i++)
            b[i * m + j] = i < j ? column[j][s * m + i] * root[j] : i == j ? root[j] : ZERO;
    }
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++) {
            real_t sum = ZERO;
            for (size_t k = 0; k < m; k++)
                sum = real_fma(p[i * m + k], b[k * m + j], sum);
            r[i * m + j] = own[i * m + j] = sum;
        }
    for (size_t row = s * m; row > 0;) {
        p -= stride;
        row -= m;
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++)
                b[i * m + j] = real_fma(p[3 * m * m], r[i * m + j], column[j][row + i] * root[j]);
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++) {
                real_t sum = p[i * m] * b[j];
                for (size_t k = 1; k < m; k++)
                    sum = real_fma(p[i * m + k], b[k * m + j], sum);
                r[i * m + j] = column[j][row + i] = sum;
            }
    }
    for (size_t i = 0; i < m * m; i++)
        w[i] = ZERO;
    p = t->of + m * m;
    for (size_t row = 0; row < s * m; row += m, p += stride) {
        const real_t *g = p + m * m;
        real_t keep = g[m * m + 1];
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++) {
                real_t sum = column[j][row + i];
                for (size_t k = 0; k < m; k++)
                    sum = real_fma(p[i * m + k], w[k * m + j], sum);
                b[i * m + j] = column[j][row + i] = sum;
            }
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++) {
                real_t sum = keep * w[i * m + j];
                for (size_t k = 0; k < m; k++)
                    sum = real_fma(g[i * m + k], b[k * m + j], sum);
                w[i * m + j] = sum;
            }
    }
}

/* The stage's own rows, in the columns of one stage: d = r + T w, w <- keep w + G d. */
static EXPANDED void pass_stage(size_t m, const struct column_transition *t, size_t s, real_t *d,
                                real_t *w)
{
    const real_t *p = t->of + s * column_transition_stride(m) + m * m, *g = p + m * m;
    real_t next[M_MAX * M_MAX];

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

static EXPANDED void go_up(size_t m, struct covariance_ud *c, const struct column_transition *t,
                           size_t s)
{
    real_t *own = c->own + s * m * m, *left = c->left + s * m * m;
    real_t w[M_MAX * M_MAX], rows[M_MAX][2 * M_MAX], row[2 * M_MAX];
    struct turn turn;

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
        turn_above(m, c, &turn, s, NULL);
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
static EXPANDED void finish_block(size_t m, struct covariance_ud *c, size_t s,
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

static EXPANDED void go_back(size_t m, struct covariance_ud *c, size_t s)
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
    if (c->m == 2)
        go_up(2, c, step->transition, c->at);
    else
        go_up(c->m, c, step->transition, c->at);
    return 2 * (c->at + 1) * c->m * c->m;
}

static size_t do_back(struct covariance_ud *c)
{
    size_t s = c->stages - 1 - c->at;
    if (c->m == 2)
        go_back(2, c, s);
    else
        go_back(c->m, c, s);
    return (s + 1) * c->m * c->m;
}

static size_t add_at(struct covariance_ud *c, size_t at, real_t variance)
{
    if (!(variance > ZERO))
        return 1;
    ud_add_at(c->ud, at, variance, c->spare);
    return ud_count(at + 1) / 2;
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
        return add_at(c, c->n + c->at, step->grown[c->at]);
    case PHASE_NOISE: {
        size_t i = (step->noise_first + c->at) % c->n;
        return add_at(c, i, step->noise[i]);
    }
    case PHASE_DONE:
        break;
    }
    return 1;
}

bool covariance_ud_carry_piece(struct covariance_ud *c, const struct covariance_step *step,
                               size_t effort)
{
    size_t done = 0;

    if (c->phase == PHASE_EXTRAS && c->at == 0)
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
    c->phase = PHASE_EXTRAS;
    return false;
}

/* ---- measurements ---- */

/* f = U'h in spare, from `at` on. */
static void project(const struct covariance_ud *c, const struct covariance_measurement *z)
{
    size_t end = z->at + z->count, all = triangle_of(c);
    const real_t *column = c->ud + ud_count(z->at);

    for (size_t j = z->at; j < all; column += ++j) {
        real_t sum = ZERO;
        size_t above = j < end ? j : end;
        for (size_t i = z->at; i < above; i++)
            sum = real_fma(column[i], z->slope[i - z->at], sum);
        if (j < end)
            sum += z->slope[j - z->at];
        if (z->extra < c->extras && j >= c->n + z->extra)
            sum =
                real_fma(j == c->n + z->extra ? ONE : column[c->n + z->extra], z->extra_slope, sum);
        c->spare[j] = sum;
    }
}

real_t covariance_ud_of(struct covariance_ud *c, const struct covariance_measurement *z)
{
    real_t variance = ZERO;

    project(c, z);
    for (size_t j = z->at; j < triangle_of(c); j++)
        variance = real_fma(c->spare[j] * c->spare[j], c->ud[ud_count(j) + j], variance);
    return variance;
}

real_t covariance_ud_take(struct covariance_ud *c, const struct covariance_measurement *z,
                          real_t *gain)
{
    size_t all = triangle_of(c);
    real_t alpha = covariance_ud_of(c, z) + z->variance;

    for (size_t j = 0; j < all; j++)
        gain[j] = j < z->at ? ZERO : c->spare[j] * c->ud[ud_count(j) + j];
    if (!(z->variance > ZERO) || !(alpha > ZERO) || !isfinite(alpha)) {
        for (size_t j = 0; j < all; j++)
            gain[j] = ZERO;
        return ZERO;
    }
    for (size_t j = 0; j < z->at; j++)
        c->spare[j] = ZERO;
    alpha = ud_correct_from(c->ud, all, z->at, c->spare, gain, z->variance, ONE);
    real_t scale = ONE / alpha;
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
