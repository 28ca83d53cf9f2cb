#include "kinds/composition/covariance_band_stage.h"

void covariance_band_sweep_any(struct band_view *c, const struct covariance_step *step,
                               size_t count)
{
    sweep_stages(c->m, c, step, count);
}

void covariance_band_spread_any(const struct band_view *c, const struct band_seen *seen,
                                real_t *gain)
{
    spread_stages(c->m, c, seen, gain);
}
