#include "identify/identified.h"

enum err baseline_validate(const struct baseline *b)
{
    if (!real_is_finite(b->offset) || !real_is_finite(b->slope_per_s) ||
        !real_is_finite(b->offset_sd) || !real_is_finite(b->slope_sd_per_s) ||
        !real_is_finite(b->noise_sd))
        return ERR_NOT_FINITE;
    return b->offset_sd < REAL_C(0.0) || b->slope_sd_per_s < REAL_C(0.0) ||
                   b->noise_sd < REAL_C(0.0)
               ? ERR_RANGE
               : ERR_OK;
}

enum err baseline_from_means(real_t t0_s, real_t mean_0, real_t sd_0, real_t t1_s, real_t mean_1,
                             real_t sd_1, real_t noise_sd, struct baseline *result)
{
    if (!real_is_finite(t0_s) || !real_is_finite(t1_s))
        return ERR_NOT_FINITE;
    if (!(t1_s > t0_s))
        return ERR_RANGE;
    real_t span = t1_s - t0_s;
    real_t slope = (mean_1 - mean_0) / span;
    struct baseline b = {
        .offset = mean_0 - slope * t0_s,
        .slope_per_s = slope,
        .offset_sd = real_sqrt(sd_0 * sd_0 * t1_s * t1_s + sd_1 * sd_1 * t0_s * t0_s) / span,
        .slope_sd_per_s = real_sqrt(sd_0 * sd_0 + sd_1 * sd_1) / span,
        .noise_sd = noise_sd,
    };
    enum err err = baseline_validate(&b);
    if (!err && (sd_0 < REAL_C(0.0) || sd_1 < REAL_C(0.0)))
        err = ERR_RANGE;
    if (!err)
        *result = b;
    return err;
}
