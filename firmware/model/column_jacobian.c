#include "model/column.h"

#define ZERO REAL_C(0.0)

static size_t memory(const struct column_config *config)
{
    size_t deepest = config->stages - 1;
    size_t keep = config->efficiency < REAL_C(1.0) ? COLUMN_JACOBIAN_MEMORY : 1;
    return keep < deepest ? keep : deepest;
}

void column_jacobian_shape(const struct column_config *config, size_t *lower, size_t *upper)
{
    size_t m = config->components - 1;
    *lower = memory(config) * m + m - 1;
    *upper = m + m - 1;
}

/* dv/dc of the vapour leaving stage index s with respect to the liquid of stage r <= s is this weight
 * times dy_r/dc_r (Murphree recursion v_s = v_(s-1) + E (y_s - v_(s-1)), v_0 = y_0). */
static real_t murphree_weight(const struct column_config *config, size_t s, size_t r)
{
    if (s == config->stages - 1)
        return ZERO; /* total condenser */
    real_t weight = r == 0 ? REAL_C(1.0) : config->efficiency;
    for (size_t i = r; i < s; i++)
        weight *= REAL_C(1.0) - config->efficiency;
    return weight;
}

/* Liquid that a tray draws from the one below it (negative) carries nothing down; its own small entry is left out. */
static real_t downwards(real_t liquid)
{
    return liquid > ZERO ? liquid : ZERO;
}

void column_jacobian(const struct column *column, const real_t *x, real_t *band, size_t stride,
                     size_t diagonal)
{
    const struct column_config *config = column->config;
    size_t c = config->components, m = c - 1, n = column->n_fractions;
    size_t top = config->stages - 1, keep = memory(config), lower, upper;
    real_t full[COLUMN_COMPONENTS_MAX], dt[COLUMN_COMPONENTS_MAX];
    real_t dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];

    column_jacobian_shape(config, &lower, &upper);
    for (size_t col = 0; col < n; col++)
        for (size_t i = 0; i <= lower + upper; i++)
            band[col * stride + diagonal + i - upper] = ZERO;

    for (size_t r = 0; r <= top; r++) { /* r: the stage whose liquid changes */
        real_t vapour_in = r == 0 ? ZERO : column->vapour_flow[r - 1];
        real_t liquid_in = r == top ? ZERO : downwards(column->liquid[r + 1]);
        real_t feed_in = r + 1 == config->feed_stage ? column->flows.feed : ZERO;

        /* through the liquid itself, on this stage and the one below */
        for (size_t j = 0; j < m; j++) {
            real_t *entry = &band[(r * m + j) * stride + diagonal]; /* entry[row - col] */
            entry[0] +=
                (column->vapour_flow[r] - liquid_in - vapour_in - feed_in) / column->holdup[r];
            if (r > 0)
                *(entry - m) += downwards(column->liquid[r]) / column->holdup[r - 1];
        }
        if (r == top)
            continue;

        /* through the vapour in equilibrium with it, on this stage and those above */
        full[m] = REAL_C(1.0);
        for (size_t j = 0; j < m; j++) {
            full[j] = x[r * m + j];
            full[m] -= full[j];
        }
        vle_slopes(c, full, &column->k[r * c], &column->dk[r * c], dt, dy);
        for (size_t s = r; s <= top && s - r <= keep; s++) {
            real_t gain = -column->vapour_flow[s] * murphree_weight(config, s, r);
            if (s > r)
                gain += column->vapour_flow[s - 1] * murphree_weight(config, s - 1, r);
            gain /= column->holdup[s];
            for (size_t j = 0; j < m; j++) {
                real_t *entry = &band[(r * m + j) * stride + diagonal];
                for (size_t i = 0; i < m; i++)
                    *(entry + (s - r) * m + i - j) += gain * dy[i * m + j];
            }
        }
    }
}
