#include "num/ud_scaled.h"

#include "base/assertion.h"
#include "num/scaled_inline.h"

#ifdef REFLUX_FIXED_POINT

/* Bits of the largest mantissa of a column of U, and of P phi on its way, once they are normalised. With a factor of 31 bits, the
 * upper word of the product has as many. */
#define COLUMN_BITS 26
#define GAIN_BITS   27

static size_t ud_place(size_t j)
{
    return j * (j + 1) / 2;
}

/* The word of a column holds its exponent, and in the lowest WIDTH_BITS the bits of its largest mantissa (0: the column is 0). */
#define WIDTH_BITS 5

static int32_t *column_scale(ud_cell_t *ud, size_t n, size_t j)
{
    return &ud[ud_place(n) + j];
}

static int32_t scale_of(int32_t exponent, int32_t wide)
{
    return exponent * (1 << WIDTH_BITS) + wide;
}

static scaled_t get_u(const ud_cell_t *ud, size_t n, size_t i, size_t j)
{
    return scaled_normal(ud[ud_place(j) + i], ud[ud_place(n) + j] >> WIDTH_BITS);
}

static scaled_t get_d(const ud_cell_t *ud, size_t n, size_t j)
{
    return (scaled_t){ud[ud_place(j) + j], ud[ud_place(n) + n + j]};
}

static void set_d(ud_cell_t *ud, size_t n, size_t j, scaled_t d)
{
    ud[ud_place(j) + j] = d.m;
    ud[ud_place(n) + n + j] = d.e;
}

/* Returns the bits of the largest of some numbers. mask: their magnitudes OR-ed. */
static int32_t width(uint32_t mask)
{
    return mask ? 32 - __builtin_clz(mask) : 0;
}

/* Returns m * 2^-right, to the nearest. right may have any sign that keeps the result in range, and any value where m is 0. Beyond 62
 * bits the result is 0. */
static int64_t shifted(int64_t m, int32_t right)
{
    if (right <= 0 && m)
        return m * ((int64_t)1 << -right);
    return right > 62 || !m ? 0 : (m + ((int64_t)1 << (right - 1))) >> right;
}

/* Sets column j to u. */
static void set_column(ud_cell_t *ud, size_t n, size_t j, const scaled_t *u)
{
    int32_t e = -SCALED_EXPONENT_MAX;
    for (size_t i = 0; i < j; i++)
        e = u[i].m && u[i].e > e ? u[i].e : e;
    for (size_t i = 0; i < j; i++)
        ud[ud_place(j) + i] = (int32_t)shifted(u[i].m, e - u[i].e + 30 - COLUMN_BITS);
    *column_scale(ud, n, j) = scale_of(e + 30 - COLUMN_BITS, j ? COLUMN_BITS : 0);
}

void ud_scaled_set_diagonal(ud_cell_t *ud, size_t n, const scaled_t *p)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX);
    for (size_t j = 0; j < n; j++) {
        for (size_t i = 0; i < j; i++)
            ud[ud_place(j) + i] = 0;
        *column_scale(ud, n, j) = scale_of(-COLUMN_BITS, 0);
        set_d(ud, n, j, p[j]);
    }
}

/* Returns phi_j + sum * 2^e, e being the exponent of the column. It adds in one number of 64 bits where that fits. */
static scaled_t projected(num_t phi, int64_t sum, int32_t e)
{
    if (e <= 0 && e >= -30)
        return scaled_from_product(sum + phi.q * ((int64_t)1 << -e), e - NUM_FRACTION_BITS);
    return scaled_add(scaled_from_num(phi), scaled_from_product(sum, e - NUM_FRACTION_BITS));
}

/* The sums stay below 2^63, also with phi_j: 24 products are each below 2^27 times 2^31. Of up to 35 products, with |phi| below 64,
 * each is below 2^27 times 2^30. */
void ud_scaled_project(const ud_cell_t *ud, size_t n, const num_t *phi, scaled_t *f, scaled_t *g)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX);
    const ud_cell_t *exponent = ud + ud_place(n), *d_exponent = exponent + n;
    for (size_t j = 0; j < n; j++) {
        const num_t *p = phi;
        int64_t sum = 0;
        for (const ud_cell_t *end = ud + j; ud < end;)
            sum += (int64_t)*ud++ * (p++)->q;
        f[j] = sum ? projected(phi[j], sum, exponent[j] >> WIDTH_BITS)
                   : inline_normal(phi[j].q, -NUM_FRACTION_BITS);
        g[j] = inline_mul((scaled_t){*ud++, d_exponent[j]}, f[j]);
    }
}

scaled_t ud_scaled_variance(const scaled_t *f, const scaled_t *g, size_t n)
{
    scaled_t sum = {0, 0};
    for (size_t i = 0; i < n; i++)
        sum = scaled_add(sum, scaled_mul(f[i], g[i]));
    return sum;
}

/* P phi while it grows column by column: the common exponent of the mantissas, and their magnitudes OR-ed. */
struct growing {
    int32_t e;
    uint32_t mask;
};

static void move_right(struct growing *b, scaled_t *g, size_t count, int32_t right)
{
    for (size_t i = 0; i < count; i++)
        g[i].m = right > 31 ? 0 : (g[i].m + (1 << (right - 1))) >> right;
    b->mask >>= right < 32 ? right : 31;
    b->e += right;
}

/* Returns the shift to the right that mantissas need to have room for a number below 2^top; 0 where there is room, so that all bits are
 * kept. */
static inline int32_t room_wanted(const struct growing *b, int32_t top)
{
    int32_t right = top + 1 - GAIN_BITS - b->e, own = width(b->mask) + 1 - GAIN_BITS;
    right = own > right ? own : right;
    return right > 0 ? right : 0;
}

static inline void make_ud_room(struct growing *b, scaled_t *g, size_t count, int32_t top)
{
    if (!b->mask)
        b->e = top + 1 - GAIN_BITS;
    else if (room_wanted(b, top))
        move_right(b, g, count, room_wanted(b, top));
}

/* Shifts and factors of the mantissas of a column and of P phi, with which the upper word of a product comes out in the right place. */
struct moves {
    int32_t old_right, column_left, gain_left, gain_right, lambda, own;
};

/* Adds b lambda to u, and u own to b, in mantissas alone. b is shifted right for its sum only after u has taken it with all its digits.
 * Otherwise, where little noise makes lambda large and b small beside u own, U would take the lost digits. Returns the bits of b, and
 * puts those of u into *column_mask. */
static uint32_t correct_mantissas(ud_cell_t *u, size_t j, scaled_t *g, const struct moves *m,
                                  uint32_t *column_mask)
{
    int32_t half = m->old_right ? 1 << (m->old_right - 1) : 0, old_right = m->old_right;
    int32_t column_left = m->column_left, gain_left = m->gain_left, lambda = m->lambda,
            own = m->own, gain_right = m->gain_right;
    int32_t gain_half = gain_right ? 1 << (gain_right - 1) : 0;
    uint32_t mask = 0, wide = 0;
    for (ud_cell_t *end = u + j; u < end; u++, g++) {
        int32_t old = *u, gain = g->m;
        int32_t now = ((old + half) >> old_right) +
                      inline_high((int32_t)((uint32_t)gain << gain_left), lambda);
        gain = ((gain + gain_half) >> gain_right) +
               inline_high((int32_t)((uint32_t)old << column_left), own);
        *u = now;
        g->m = gain;
        wide |= (uint32_t)(now ^ (now >> 31));
        mask |= (uint32_t)(gain ^ (gain >> 31));
    }
    *column_mask = wide;
    return mask;
}

/* Shifts m to the right. right may have any value where m is 0. */
static int32_t moved_right(int32_t m, int32_t right)
{
    return !m || right > 31 ? 0 : m >> right;
}

/* Corrects column j of U with its exponent, and P phi of the columns before it. */
static void correct_column(ud_cell_t *u, size_t j, int32_t *scale, scaled_t *g, struct growing *b,
                           scaled_t lambda, scaled_t own)
{
    int32_t wide = *scale & ((1 << WIDTH_BITS) - 1), exponent = *scale >> WIDTH_BITS;
    int32_t e = exponent + wide - COLUMN_BITS;
    uint32_t mask = (uint32_t)wide;
    int32_t top = exponent + own.e + wide + 30;
    int32_t gain_right = mask && b->mask ? room_wanted(b, top) : 0;
    if (mask && !b->mask)
        b->e = top + 1 - GAIN_BITS;
    int32_t move = b->e + lambda.e, gain_wide = width(b->mask);
    if (!mask || (lambda.m && b->mask && move + gain_wide + 30 - COLUMN_BITS > e))
        e = move + gain_wide + 30 - COLUMN_BITS;
    e = e > exponent || !mask ? e : exponent; /* the old mantissas keep their bits */
    struct moves m = {.old_right = mask ? e - exponent : 0,
                      .column_left = 30 - wide,
                      .gain_left = 30 - gain_wide,
                      .gain_right = gain_right > 30 ? 30 : gain_right};
    m.old_right = m.old_right > 30 ? 30 : m.old_right;
    m.lambda = b->mask ? moved_right(lambda.m, e - move + m.gain_left - 32) : 0;
    b->e += gain_right;
    m.own = mask ? moved_right(own.m, b->e - (exponent + own.e) + m.column_left - 32) : 0;
    b->mask = correct_mantissas(u, j, g, &m, &mask);
    *scale = mask ? scale_of(e, width(mask)) : scale_of(-COLUMN_BITS, 0);
}

scaled_t ud_scaled_correct(ud_cell_t *ud, size_t n, const scaled_t *f, scaled_t *g, scaled_t r,
                           scaled_t growth)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX);
    scaled_t alpha = r, inverse = inline_inverse(r);
    struct growing b = {0, 0};
    ud_cell_t *column = ud;
    for (size_t j = 0; j < n; j++, column += j) {
        scaled_t own = g[j], lambda = inline_mul(scaled_neg(f[j]), inverse);
        scaled_t share = inline_mul(alpha, growth);
        alpha = inline_add(alpha, inline_mul(f[j], own));
        inverse = inline_inverse(alpha);
        if (j)
            correct_column(column, j, column_scale(ud, n, j), g, &b, lambda, own);
        set_d(ud, n, j, inline_mul(get_d(ud, n, j), inline_mul(share, inverse)));
        make_ud_room(&b, g, j, own.e + (own.m ? 30 : 0));
        g[j].m = moved_right(own.m, b.e - own.e);
        b.mask |= (uint32_t)(g[j].m ^ (g[j].m >> 31));
    }
    for (size_t j = 0; j < n; j++)
        g[j].e = b.e;
    return alpha;
}

void ud_scaled_add(ud_cell_t *ud, size_t n, scaled_t c, scaled_t *v)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX);
    scaled_t column[UD_SCALED_MAX];
    for (size_t j = n; j-- > 0;) {
        scaled_t d = get_d(ud, n, j), moved = scaled_mul(c, v[j]);
        scaled_t sum = scaled_add(d, scaled_mul(moved, v[j])), share = scaled_div(moved, sum);
        for (size_t i = 0; i < j; i++) {
            scaled_t u = get_u(ud, n, i, j);
            v[i] = scaled_sub(v[i], scaled_mul(v[j], u));
            column[i] = scaled_add(u, scaled_mul(share, v[i]));
        }
        set_column(ud, n, j, column);
        set_d(ud, n, j, sum);
        c = scaled_div(scaled_mul(c, d), sum);
    }
}

void ud_scaled_scale(ud_cell_t *ud, size_t n, scaled_t factor)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX);
    for (size_t j = 0; j < n; j++)
        set_d(ud, n, j, scaled_mul(get_d(ud, n, j), factor));
}

void ud_scaled_multiply(const ud_cell_t *ud, size_t n, const scaled_t *x, scaled_t *y)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX);
    for (size_t j = n; j-- > 0;) {
        scaled_t sum = x[j];
        for (size_t i = 0; i < j; i++)
            sum = scaled_add(sum, scaled_mul(get_u(ud, n, i, j), x[i]));
        y[j] = scaled_mul(get_d(ud, n, j), sum);
    }
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < j; i++)
            y[i] = scaled_add(y[i], scaled_mul(get_u(ud, n, i, j), y[j]));
}

void ud_scaled_solve(const ud_cell_t *ud, size_t n, const scaled_t *x, scaled_t *y)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX);
    for (size_t j = 0; j < n; j++)
        y[j] = x[j];
    for (size_t j = n; j-- > 0;)
        for (size_t i = 0; i < j; i++)
            y[i] = scaled_sub(y[i], scaled_mul(get_u(ud, n, i, j), y[j]));
    for (size_t j = 0; j < n; j++)
        y[j] = scaled_div(y[j], get_d(ud, n, j));
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < j; i++)
            y[j] = scaled_sub(y[j], scaled_mul(get_u(ud, n, i, j), y[i]));
}

scaled_t ud_scaled_element(const ud_cell_t *ud, size_t n, size_t i, size_t j)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX && i < n && j < n);
    scaled_t sum = {0, 0}, one = scaled_from_num(num_one());
    for (size_t k = i > j ? i : j; k < n; k++)
        sum = scaled_add(sum, scaled_mul(scaled_mul(i == k ? one : get_u(ud, n, i, k),
                                                    j == k ? one : get_u(ud, n, j, k)),
                                         get_d(ud, n, k)));
    return sum;
}

scaled_t ud_scaled_trace(const ud_cell_t *ud, size_t n)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX);
    scaled_t trace = {0, 0};
    for (size_t j = 0; j < n; j++) {
        int64_t squares = 0; /* below 2^54 each */
        for (size_t i = 0; i < j; i++)
            squares += (int64_t)ud[ud_place(j) + i] * ud[ud_place(j) + i];
        scaled_t sum =
            scaled_add(scaled_from_num(num_one()),
                       scaled_from_product(squares, 2 * (ud[ud_place(n) + j] >> WIDTH_BITS)));
        trace = scaled_add(trace, scaled_mul(get_d(ud, n, j), sum));
    }
    return trace;
}

void ud_scaled_extremes(const ud_cell_t *ud, size_t n, scaled_t *least, scaled_t *most)
{
    REFLUX_ASSERT(n >= 1 && n <= UD_SCALED_MAX);
    *least = *most = get_d(ud, n, 0);
    for (size_t j = 1; j < n; j++) {
        scaled_t d = get_d(ud, n, j);
        *least = scaled_lt(d, *least) ? d : *least;
        *most = scaled_lt(*most, d) ? d : *most;
    }
}

bool ud_scaled_clamp(ud_cell_t *ud, size_t n, size_t j, scaled_t lo, scaled_t hi)
{
    REFLUX_ASSERT(n <= UD_SCALED_MAX && j < n);
    scaled_t d = get_d(ud, n, j);
    if (!scaled_lt(d, lo) && !scaled_lt(hi, d))
        return false;
    set_d(ud, n, j, scaled_lt(hi, d) ? hi : lo);
    return true;
}

#endif
