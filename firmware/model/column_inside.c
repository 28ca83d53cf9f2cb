#include "model/column_inside.h"

void column_full_composition(const struct column *column, const real_t *x, size_t s, real_t *full)
{
    size_t m = column->config->components - 1;

    full[m] = REAL_C(1.0);
    for (size_t j = 0; j < m; j++) {
        full[j] = x[s * m + j];
        full[m] -= full[j];
    }
}

real_t column_soft_limit(real_t value, real_t limit, real_t width)
{
    real_t w = width * limit;
    if (value <= limit - w)
        return value;
    if (value >= limit + w)
        return limit;
    real_t over = value - limit + w;
    return value - over * over / (REAL_C(4.0) * w);
}
