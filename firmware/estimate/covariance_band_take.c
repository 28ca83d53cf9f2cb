/* Measurements of the banded form. One of fractions of stage s with the slopes h is, given the extras, one of S alone. With
 * a = h S_ss h' + variance and g = S h' on every stage,
 *
 *     S <- S - g g'/a,   M <- M - g f'/a,   T by ud_correct as after that,   f = M'h' + the extra's own slope
 *
 * and g goes from stage to stage through the blocks that are kept. This is the whole measurement of the whole P. */
#include "estimate/covariance_band_inside.h"
#include "num/ud.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define Q_MAX COVARIANCE_EXTRAS_MAX

static bool see_stage(const struct covariance_band *c, const struct covariance_measurement *z,
                      struct band_seen *seen)
{
    size_t m = c->m, stage = z->at / m, first = z->at % m;
    const real_t *own = &c->of[stage * covariance_band_stride(m, c->extras)];
    const real_t *said = own + 2 * m * m;

    if (z->count < 1 || first + z->count > m || stage >= c->stages)
        return false;
    seen->stage = stage;
    for (size_t i = 0; i < m; i++)
        seen->slope[i] = i < first || i - first >= z->count ? ZERO : z->slope[i - first];
    seen->spread = ZERO;
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            seen->spread += seen->slope[i] * own[i * m + j] * seen->slope[j];
    if (seen->spread < ZERO) /* rounding */
        seen->spread = ZERO;
    for (size_t e = 0; e < c->extras; e++) {
        seen->by_extra[e] = e == z->extra ? z->extra_slope : ZERO;
        for (size_t i = 0; i < m; i++)
            seen->by_extra[e] += said[e * m + i] * seen->slope[i];
    }
    return true;
}

real_t covariance_band_of(const struct covariance_band *c, const struct covariance_measurement *z)
{
    real_t f[Q_MAX] = {ZERO}, g[Q_MAX] = {ZERO};
    struct band_seen seen;

    if (!see_stage(c, z, &seen))
        return ZERO;
    ud_project(c->ud, c->extras, seen.by_extra, f, g);
    return seen.spread + ud_variance(f, g, c->extras);
}

real_t covariance_band_take(struct covariance_band *c, const struct covariance_measurement *z,
                            real_t *gain)
{
    size_t n = c->stages * c->m;
    real_t f[Q_MAX] = {ZERO}, alpha = ZERO;
    struct band_seen seen = {.bound = ONE};

    if (see_stage(c, z, &seen)) {
        ud_project(c->ud, c->extras, seen.by_extra, f, seen.told);
        seen.bound = seen.spread + z->variance;
        alpha = seen.bound + ud_variance(f, seen.told, c->extras);
    }
    if (!(z->variance > ZERO && alpha > ZERO && isfinite(alpha))) {
        for (size_t i = 0; i < n + c->extras; i++)
            gain[i] = ZERO;
        return ZERO;
    }
    seen.per_bound = ONE / seen.bound;
    seen.per_alpha = ONE / alpha;
    seen.left = z->variance * seen.per_bound;
    (void)ud_correct(c->ud, c->extras, f, seen.told, seen.bound, ONE);
    if (c->m == 2)
        covariance_band_spread_two(c, &seen, gain);
    else
        covariance_band_spread_any(c, &seen, gain);
    for (size_t e = 0; e < c->extras; e++)
        gain[n + e] = seen.told[e] * seen.per_alpha;
    return alpha;
}

void covariance_band_extremes(const struct covariance_band *c, real_t *least, real_t *most)
{
    size_t m = c->m, stride = covariance_band_stride(m, c->extras);
    real_t by_extra[Q_MAX], f[Q_MAX] = {ZERO}, g[Q_MAX] = {ZERO};

    for (size_t i = 0; i < c->stages * m + c->extras; i++) {
        bool fraction = i < c->stages * m;
        const real_t *own = &c->of[i / m * stride];
        for (size_t e = 0; e < c->extras; e++)
            by_extra[e] = fraction                 ? own[2 * m * m + e * m + i % m]
                          : i - c->stages * m == e ? ONE
                                                   : ZERO;
        ud_project(c->ud, c->extras, by_extra, f, g);
        real_t v = ud_variance(f, g, c->extras) + (fraction ? own[i % m * (m + 1)] : ZERO);
        *least = i == 0 || v < *least ? v : *least;
        *most = i == 0 || v > *most ? v : *most;
    }
}
