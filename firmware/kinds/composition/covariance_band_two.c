#define SMALL_BLOCKS_M 2
#include "kinds/composition/covariance_band_stage.h"

void covariance_band_sweep_two(struct band_view *c, const struct covariance_step *step,
                               size_t count)
{
    sweep_stages(2, c, step, count);
}

void covariance_band_spread_two(const struct band_view *c, const struct band_seen *seen,
                                real_t *gain)
{
    spread_stages(2, c, seen, gain);
}
