#include "identify/identified.h"

#include "identify/common.h"
#include "lti/fopdt.h" /* real_is_finite */

enum err baseline_validate(const struct baseline *b)
{
    enum err err = check_real(b->offset, -VALUE_MAX, VALUE_MAX);
    if (!err)
        err = check_real(b->slope_per_s, -VALUE_MAX, VALUE_MAX);
    if (!err)
        err = check_real(b->offset_sd, ZERO, VALUE_MAX);
    if (!err)
        err = check_real(b->slope_sd_per_s, ZERO, VALUE_MAX);
    return err ? err : check_real(b->noise_sd, ZERO, VALUE_MAX);
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
    if (!err && (sd_0 < ZERO || sd_1 < ZERO))
        err = ERR_RANGE;
    if (!err)
        *result = b;
    return err;
}
