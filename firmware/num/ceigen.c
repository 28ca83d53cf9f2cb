#include "num/ceigen.h"

#include <stddef.h>

#include "base/assertion.h"

#define ROUNDS_EACH 40
#define STUCK_AFTER 10 /* rounds without a zero after which another shift is tried */

static real_t one_norm(struct cplx a)
{
    return real_abs(a.re) + real_abs(a.im);
}

/* Returns the square root with re >= 0. */
static struct cplx principal_root(struct cplx a)
{
    real_t size = real_sqrt(cplx_square(a));
    if (size <= REAL_C(0.0))
        return cplx(REAL_C(0.0), REAL_C(0.0));
    real_t large = real_sqrt(REAL_C(0.5) * (size + real_abs(a.re)));
    real_t small = real_abs(a.im) / (large + large);
    real_t re = a.re >= REAL_C(0.0) ? large : small, im = a.re >= REAL_C(0.0) ? small : large;
    return cplx(re, a.im < REAL_C(0.0) ? -im : im);
}

/* Makes zeros below the first subdiagonal of column k: reflects the rows, then the columns, past k at v, which has unit length. */
static void reflect(struct cmatrix *a, size_t k)
{
    size_t n = a->rows;
    struct cplx v[MATRIX_MAX];
    real_t below = REAL_C(0.0);
    for (size_t i = k + 2; i < n; i++)
        below += cplx_square(a->value[i][k]);
    if (below <= REAL_C(0.0))
        return;
    struct cplx first = a->value[k + 1][k];
    real_t own = cplx_abs(first), length = real_sqrt(below + own * own);
    struct cplx way =
        own > REAL_C(0.0) ? cplx_scale(first, REAL_C(1.0) / own) : cplx(REAL_C(1.0), REAL_C(0.0));
    for (size_t i = k + 1; i < n; i++)
        v[i] = a->value[i][k];
    v[k + 1] = cplx_add(first, cplx_scale(way, length));
    real_t size = real_sqrt(below + cplx_square(v[k + 1]));
    for (size_t i = k + 1; i < n; i++)
        v[i] = cplx_scale(v[i], REAL_C(1.0) / size);
    for (size_t j = k; j < n; j++) {
        struct cplx along = cplx(REAL_C(0.0), REAL_C(0.0));
        for (size_t i = k + 1; i < n; i++)
            along = cplx_add(along, cplx_mul(cplx_conj(v[i]), a->value[i][j]));
        for (size_t i = k + 1; i < n; i++)
            a->value[i][j] =
                cplx_sub(a->value[i][j], cplx_scale(cplx_mul(along, v[i]), REAL_C(2.0)));
    }
    for (size_t i = 0; i < n; i++) {
        struct cplx along = cplx(REAL_C(0.0), REAL_C(0.0));
        for (size_t j = k + 1; j < n; j++)
            along = cplx_add(along, cplx_mul(a->value[i][j], v[j]));
        for (size_t j = k + 1; j < n; j++)
            a->value[i][j] =
                cplx_sub(a->value[i][j], cplx_scale(cplx_mul(along, cplx_conj(v[j])), REAL_C(2.0)));
    }
}

/* Returns the eigenvalue of the block's last two rows and columns that is nearer to the last element. */
static struct cplx wilkinson_shift(const struct cmatrix *a, size_t last)
{
    struct cplx p = a->value[last - 1][last - 1], q = a->value[last][last];
    struct cplx half = cplx_scale(cplx_sub(p, q), REAL_C(0.5));
    struct cplx bc = cplx_mul(a->value[last - 1][last], a->value[last][last - 1]);
    struct cplx root = principal_root(cplx_add(cplx_mul(half, half), bc));
    if (half.re * root.re + half.im * root.im < REAL_C(0.0))
        root = cplx(-root.re, -root.im);
    struct cplx sum = cplx_add(half, root);
    if (one_norm(sum) <= REAL_C(0.0))
        return q;
    return cplx_sub(q, cplx_div(bc, sum));
}

/* Does one QR round on the rows and columns from first to last: A - shift = Q R, and A becomes R Q + shift. Each rotation has a real
 * cosine. */
static void qr_round(struct cmatrix *a, size_t first, size_t last, struct cplx shift)
{
    real_t cosine[MATRIX_MAX];
    struct cplx sine[MATRIX_MAX];
    for (size_t i = first; i <= last; i++)
        a->value[i][i] = cplx_sub(a->value[i][i], shift);
    for (size_t k = first; k < last; k++) {
        struct cplx x = a->value[k][k], y = a->value[k + 1][k];
        real_t own = cplx_abs(x), size = real_sqrt(own * own + cplx_square(y));
        if (size <= REAL_C(0.0)) {
            cosine[k] = REAL_C(1.0);
            sine[k] = cplx(REAL_C(0.0), REAL_C(0.0));
            continue;
        }
        struct cplx way =
            own > REAL_C(0.0) ? cplx_scale(x, REAL_C(1.0) / own) : cplx(REAL_C(1.0), REAL_C(0.0));
        cosine[k] = own / size;
        sine[k] = cplx_scale(cplx_mul(way, cplx_conj(y)), REAL_C(1.0) / size);
        for (size_t j = k; j <= last; j++) {
            struct cplx up = a->value[k][j], down = a->value[k + 1][j];
            a->value[k][j] = cplx_add(cplx_scale(up, cosine[k]), cplx_mul(sine[k], down));
            a->value[k + 1][j] =
                cplx_sub(cplx_scale(down, cosine[k]), cplx_mul(cplx_conj(sine[k]), up));
        }
    }
    for (size_t k = first; k < last; k++)
        for (size_t i = first; i <= k + 1; i++) {
            struct cplx left = a->value[i][k], right = a->value[i][k + 1];
            a->value[i][k] =
                cplx_add(cplx_scale(left, cosine[k]), cplx_mul(right, cplx_conj(sine[k])));
            a->value[i][k + 1] = cplx_sub(cplx_scale(right, cosine[k]), cplx_mul(left, sine[k]));
        }
    for (size_t i = first; i <= last; i++)
        a->value[i][i] = cplx_add(a->value[i][i], shift);
}

/* Returns the first row of the block that ends at `last`. Above that row the subdiagonal is negligible beside its neighbours. */
static size_t block_start(const struct cmatrix *a, size_t last, real_t whole)
{
    size_t first = last;
    for (; first > 0; first--) {
        real_t near = one_norm(a->value[first][first]) + one_norm(a->value[first - 1][first - 1]);
        near = near > REAL_C(0.0) ? near : whole;
        if (one_norm(a->value[first][first - 1]) <= REAL_EPSILON * near)
            break;
    }
    return first;
}

enum err ceigen_values(struct cmatrix *a, struct cplx *values)
{
    enum err err = cmatrix_check(a);
    if (err)
        return err;
    if (a->rows != a->cols)
        return ERR_RANGE;
    size_t n = a->rows;
    real_t whole = REAL_C(0.0);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            whole += one_norm(a->value[i][j]);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n && whole > REAL_C(0.0); j++)
            a->value[i][j] = cplx_scale(a->value[i][j], REAL_C(1.0) / whole);
    for (size_t k = 0; k + 2 < n; k++)
        reflect(a, k);
    size_t left = n;
    unsigned stuck = 0;
    for (unsigned round = 0; left > 0; round++) {
        if (round >= ROUNDS_EACH * n)
            return ERR_TIMEOUT;
        size_t last = left - 1, first = block_start(a, last, REAL_C(1.0));
        if (first == last) {
            left--;
            stuck = 0;
            continue;
        }
        stuck++;
        struct cplx shift = wilkinson_shift(a, last);
        if (stuck % STUCK_AFTER == 0)
            shift = cplx_add(a->value[last][last],
                             cplx(one_norm(a->value[last][last - 1]), REAL_C(0.0)));
        qr_round(a, first, last, shift);
    }
    for (size_t i = 0; i < n; i++)
        values[i] = cplx_scale(a->value[i][i], whole);
    return ERR_OK;
}

void ceigen_follow(const struct cplx *before, struct cplx *now, uint8_t n)
{
    REFLUX_ASSERT(n <= MATRIX_MAX);
    struct cplx ordered[MATRIX_MAX];
    uint16_t placed = 0, taken = 0;
    for (uint8_t round = 0; round < n; round++) {
        uint8_t to = 0, from = 0;
        real_t nearest = REAL_C(-1.0);
        for (uint8_t i = 0; i < n; i++)
            for (uint8_t j = 0; j < n; j++) {
                if ((placed & (1u << i)) != 0u || (taken & (1u << j)) != 0u)
                    continue;
                real_t apart = cplx_square(cplx_sub(before[i], now[j]));
                if (nearest < REAL_C(0.0) || apart < nearest) {
                    nearest = apart;
                    to = i;
                    from = j;
                }
            }
        ordered[to] = now[from];
        placed = (uint16_t)(placed | (1u << to));
        taken = (uint16_t)(taken | (1u << from));
    }
    for (uint8_t i = 0; i < n; i++)
        now[i] = ordered[i];
}
