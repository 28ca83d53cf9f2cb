#include "identify/fit_line.h"

#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"

static real_t row_weight(const struct fit_line *l, uint32_t i)
{
    return l->weight ? l->weight[i] : ONE;
}

void fit_line_prepare(struct fit_line *l)
{
    REFLUX_ASSERT(l->points <= RECORD_POINTS);
    real_t count = ZERO, times = ZERO;
    for (uint32_t i = 0; i < l->points; i++) {
        count += row_weight(l, i);
        times += row_weight(l, i) * fit_line_time(l, i);
    }
    l->row_0 = l->offset ? l->row_0 : ZERO;
    l->row_1 = l->slope ? l->row_1 : ZERO;
    l->norm_0 = count + l->row_0 * l->row_0;
    l->middle = l->offset && l->norm_0 > ZERO ? times / l->norm_0 : ZERO;
    l->norm_1 = l->row_1 * l->row_1 + l->middle * l->middle * l->row_0 * l->row_0;
    for (uint32_t i = 0; i < l->points; i++) {
        real_t t = fit_line_time(l, i) - l->middle;
        l->norm_1 += row_weight(l, i) * t * t;
    }
    l->offset = l->offset && l->norm_0 > ZERO;
    l->slope = l->slope && l->norm_1 > REAL_C(1e-6);
}

void fit_line_remove(const struct fit_line *l, real_t *column, real_t *offset, real_t *slope)
{
    real_t c = ZERO, d = ZERO;
    real_t *rows = column + l->points;
    if (l->offset) {
        for (uint32_t i = 0; i < l->points; i++)
            c += row_weight(l, i) * column[i];
        c = (c + l->row_0 * rows[0]) / l->norm_0;
        for (uint32_t i = 0; i < l->points; i++)
            column[i] -= c;
        rows[0] -= c * l->row_0;
    }
    if (l->slope) {
        for (uint32_t i = 0; i < l->points; i++)
            d += row_weight(l, i) * (fit_line_time(l, i) - l->middle) * column[i];
        d = (d - l->middle * l->row_0 * rows[0] + l->row_1 * rows[1]) / l->norm_1;
        for (uint32_t i = 0; i < l->points; i++)
            column[i] -= d * (fit_line_time(l, i) - l->middle);
        rows[0] += d * l->middle * l->row_0;
        rows[1] -= d * l->row_1;
    }
    if (offset)
        *offset = c - d * l->middle;
    if (slope)
        *slope = d;
}

real_t fit_line_dot(const struct fit_line *l, const real_t *a, const real_t *b)
{
    real_t sum = ZERO;
    for (uint32_t i = 0; i < l->points; i++)
        sum += row_weight(l, i) * a[i] * b[i];
    return sum + a[l->points] * b[l->points] + a[l->points + 1] * b[l->points + 1];
}
