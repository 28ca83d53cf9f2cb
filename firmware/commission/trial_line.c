#include "commission/trial_line.h"

#include "commission/trial_line_state.h"
#include "identify/steady.h"

#define DRIFT_SDS REAL_C(3.0) /* standard deviations of a slope from which it is a drift */
/* Share of a step that a drift may carry in its time without being relevant. */
#define DRIFT_SHARE    REAL_C(0.05)
#define BEND_SDS       REAL_C(4.0)
#define BEND_SHARE     REAL_C(0.1) /* of a step */
#define UNFORESEEN_SDS REAL_C(2.0)

static real_t hypotenuse(real_t x, real_t y)
{
    return real_sqrt(x * x + y * y);
}

void trial_line_take(struct trial_line *l, const struct steady_result *now, real_t longest_s,
                     real_t smallest_step)
{
    l->slope_per_s = now->slope_per_s;
    l->slope_sd_per_s = now->slope_sd_per_s;
    l->rest_sd = now->mean_sd;
    l->drifts = real_abs(now->slope_per_s) > DRIFT_SDS * now->slope_sd_per_s &&
                real_abs(now->slope_per_s) * longest_s > DRIFT_SHARE * smallest_step;
    l->rest = l->drifts ? now->mean + now->slope_per_s * now->age_s : now->mean;
}

bool trial_line_has_bent(const struct trial_line *l, const struct steady_result *now, real_t age_s,
                         real_t step, real_t lasts_s)
{
    real_t since_s = age_s - now->age_s, share = real_abs(step) * BEND_SHARE;
    real_t away = real_abs(now->mean - l->rest - l->slope_per_s * since_s);
    real_t steeper = real_abs(now->slope_per_s - l->slope_per_s) * lasts_s;
    real_t away_sd = hypotenuse(hypotenuse(now->mean_sd, l->rest_sd), l->slope_sd_per_s * since_s);
    real_t steeper_sd = hypotenuse(now->slope_sd_per_s, l->slope_sd_per_s) * lasts_s;
    return away > share + BEND_SDS * away_sd || steeper > share + BEND_SDS * steeper_sd;
}

real_t trial_line_carried(const struct trial_line *l, real_t age_s, real_t most)
{
    return l->drifts ? real_clamp(l->slope_per_s * age_s, -most, most) : REAL_C(0.0);
}

real_t trial_line_unforeseen(const struct trial_line *l)
{
    real_t unforeseen = UNFORESEEN_SDS * l->slope_sd_per_s;
    if (!l->drifts)
        unforeseen += real_abs(l->slope_per_s);
    return unforeseen;
}
