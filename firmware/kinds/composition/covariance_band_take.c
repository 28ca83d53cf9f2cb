/* Measurements of the banded form. One of fractions of stage s with the slopes h is, given the extras, one of S alone. With
 * a = h S_ss h' + variance and g = S h' on every stage,
 *
 *     S <- S - g g'/a,   M <- M - g f'/a,   T by ud_correct as after that,   f = M'h' + the extra's own slope
 *
 * and g goes from stage to stage through the blocks that are kept. This is the whole measurement of the whole P. */
#include "kinds/composition/covariance_band_inside.h"
#include "num/ud.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define Q_MAX COVARIANCE_EXTRAS_MAX

static bool see_stage(const struct covariance_band *c, const struct covariance_measurement *z,
                      struct band_seen *seen)
{
    size_t m = c->m, stage = z->first / m, first = z->first % m;
    const real_t *own = &c->blocks[stage * covariance_band_stride(m, c->extras)];
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
        ud_project(c->ud, c->extras, seen.by_extra, f, seen.extra_gain);
        seen.bound = seen.spread + z->variance;
        alpha = seen.bound + ud_variance(f, seen.extra_gain, c->extras);
    }
    if (!(z->variance > ZERO && alpha > ZERO && isfinite(alpha))) {
        for (size_t i = 0; i < n + c->extras; i++)
            gain[i] = ZERO;
        return ZERO;
    }
    seen.per_bound = ONE / seen.bound;
    seen.per_alpha = ONE / alpha;
    seen.left = z->variance * seen.per_bound;
    (void)ud_correct(c->ud, c->extras, f, seen.extra_gain, seen.bound, ONE);
    if (c->m == 2)
        covariance_band_spread_two(c, &seen, gain);
    else
        covariance_band_spread_any(c, &seen, gain);
    for (size_t e = 0; e < c->extras; e++)
        gain[n + e] = seen.extra_gain[e] * seen.per_alpha;
    return alpha;
}

/* Returns the variance that the extras give a fraction which depends on them by said[0], said[m], ... */
static real_t variance_by_extras(const struct covariance_band *c, const real_t *said, size_t m)
{
    const real_t *column = c->ud;
    real_t sum = ZERO;

    for (size_t k = 0; k < c->extras; column += ++k) {
        real_t f = said[k * m];
        for (size_t i = 0; i < k; i++)
            f = real_fma(column[i], said[i * m], f);
        sum = real_fma(column[k] * f, f, sum);
    }
    return sum;
}

static real_t extra_variance(const struct covariance_band *c, size_t e)
{
    const real_t *column = c->ud + ud_count(e);
    real_t sum = ZERO;

    for (size_t k = e; k < c->extras; column += ++k) {
        real_t f = k == e ? ONE : column[e];
        sum = real_fma(column[k] * f, f, sum);
    }
    return sum;
}

void covariance_band_extremes(const struct covariance_band *c, real_t *least, real_t *most)
{
    size_t m = c->m, stride = covariance_band_stride(m, c->extras);
    real_t lo = c->blocks[0], hi = ZERO;

    for (size_t s = 0; s <= c->stages; s++) { /* behind the stages the extras themselves */
        const real_t *own = &c->blocks[s * stride], *said = own + 2 * m * m;
        size_t count = s < c->stages ? m : c->extras;
        for (size_t i = 0; i < count; i++) {
            real_t v = s < c->stages ? variance_by_extras(c, said + i, m) + own[i * (m + 1)]
                                     : extra_variance(c, i);
            lo = s + i == 0 || v < lo ? v : lo;
            hi = s + i == 0 || v > hi ? v : hi;
        }
    }
    *least = lo;
    *most = hi;
}
