#include "identify/triangle.h"

#include <string.h>

#include "base/assertion.h"
#include "identify/common.h"

void triangle_begin(struct triangle *t, size_t columns, size_t right, real_t *memory)
{
    REFLUX_ASSERT(columns >= 1 && columns + right <= TRIANGLE_MOST);
    t->columns = (uint8_t)columns;
    t->right = (uint8_t)right;
    t->cells = memory;
    memset(memory, 0, triangle_count(columns, right) * sizeof memory[0]);
}

/* Root of the sum of squares, without the squares' overflow. */
static real_t length_of_two(real_t a, real_t b)
{
    real_t large = real_abs(a), small = real_abs(b);
    if (large < small) {
        real_t other = large;
        large = small;
        small = other;
    }
    if (large <= ZERO)
        return ZERO;
    real_t ratio = small / large;
    return large * real_sqrt(ONE + ratio * ratio);
}

void triangle_row(struct triangle *t, real_t *row)
{
    REFLUX_ASSERT(t->columns + t->right <= TRIANGLE_MOST);
    size_t width = (size_t)t->columns + t->right;
    for (size_t i = 0; i < t->columns; i++) {
        real_t *r = triangle_at(t, i);
        real_t length = length_of_two(r[0], row[i]);
        if (real_abs(row[i]) <= ZERO || length <= ZERO)
            continue;
        real_t cosine = r[0] / length, sine = row[i] / length;
        r[0] = length;
        row[i] = ZERO;
        for (size_t j = i + 1; j < width; j++) {
            real_t above = r[j - i];
            r[j - i] = cosine * above + sine * row[j];
            row[j] = cosine * row[j] - sine * above;
        }
    }
}

void triangle_select(const struct triangle *from, const uint8_t *column, size_t n,
                     struct triangle *to, real_t *memory)
{
    REFLUX_ASSERT(n <= TRIANGLE_MOST);
    triangle_begin(to, n, 0, memory);
    for (size_t i = 0; i < from->columns; i++) {
        real_t row[TRIANGLE_MOST];
        const real_t *r = triangle_at(from, i);
        for (size_t k = 0; k < n; k++)
            row[k] = column[k] >= i ? r[column[k] - i] : ZERO;
        triangle_row(to, row);
    }
}

static real_t norm_of_column(const struct triangle *t, size_t j)
{
    real_t norm = ZERO;
    for (size_t i = 0; i <= j; i++)
        norm = length_of_two(norm, triangle_at(t, i)[j - i]);
    return norm;
}

enum err triangle_solve(const struct triangle *t, real_t *theta)
{
    REFLUX_ASSERT(t->columns >= 1);
    size_t n = t->columns - 1u;
    for (size_t i = 0; i < n; i++) {
        real_t least = REAL_C(8.0) * (real_t)t->columns * REAL_EPSILON * norm_of_column(t, i);
        if (!(triangle_at(t, i)[0] > least))
            return ERR_SINGULAR;
    }
    for (size_t i = n; i-- > 0;) {
        const real_t *r = triangle_at(t, i);
        real_t sum = r[n - i];
        for (size_t j = i + 1; j < n; j++)
            sum -= r[j - i] * theta[j];
        theta[i] = sum / r[0];
    }
    return ERR_OK;
}

real_t triangle_rest(const struct triangle *t)
{
    REFLUX_ASSERT(t->columns >= 1);
    real_t corner = triangle_at(t, t->columns - 1u)[0];
    return corner * corner;
}

void triangle_spread(const struct triangle *t, real_t *spread)
{
    REFLUX_ASSERT(t->columns >= 1 && t->columns <= TRIANGLE_MOST);
    size_t n = t->columns - 1u;
    for (size_t i = 0; i < n; i++)
        spread[i] = ZERO;
    for (size_t k = 0; k < n; k++) { /* columns of the inverse of R, one after the other */
        real_t x[TRIANGLE_MOST];
        for (size_t i = k + 1; i-- > 0;) {
            const real_t *r = triangle_at(t, i);
            real_t sum = i == k ? ONE : ZERO;
            for (size_t j = i + 1; j <= k; j++)
                sum -= r[j - i] * x[j];
            x[i] = sum / r[0];
            spread[i] = length_of_two(spread[i], x[i]);
        }
    }
}
