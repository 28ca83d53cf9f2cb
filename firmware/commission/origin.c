#include "commission/origin.h"

#include "base/assertion.h"
#include "commission/origin_state.h"

#define SURE_SDS   REAL_C(2.0) /* of a slope, and of a level */
#define DRIFT_SDS  REAL_C(3.0) /* of the slope before the first test */
#define DRIFT_MORE REAL_C(1.25)
/* Largest share of a limit that may be left before a test or a trial. */
#define LEFT_MOST REAL_C(0.5)

/* Notes the fastest drift either way, because it may have turned more than once; a slope that is not significant counts only
 * as it is. */
static void see_drift(struct origin_channel *c, const struct steady_result *rest)
{
    real_t slope = real_abs(rest->slope_per_s), sure = SURE_SDS * rest->slope_sd_per_s;
    slope += slope > sure ? sure : REAL_C(0.0);
    slope = slope > c->slope_most ? c->slope_most : slope;
    c->drift_per_s = slope > c->drift_per_s ? slope : c->drift_per_s;
}

static void follow(struct origin_channel *c, const struct steady_result *rest, real_t level,
                   real_t dt_s)
{
    real_t change = level - c->level;
    see_drift(c, rest);
    real_t explained = c->drift_per_s * dt_s + SURE_SDS * rest->mean_sd;
    c->moved += change;
    if (real_abs(change) > explained)
        c->left += change > REAL_C(0.0) ? change - explained : change + explained;
}

/* From now on the tests are not blamed for a drift of this speed, either way. */
static void allow(struct origin_channel *c, const struct steady_result *rest, real_t sds)
{
    real_t most = DRIFT_MORE * (real_abs(rest->slope_per_s) + sds * rest->slope_sd_per_s);
    c->slope_most = most > c->slope_most ? most : c->slope_most;
}

void origin_look(struct origin *o, uint32_t j, const struct steady_result *rest)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    if (real_abs(rest->slope_per_s) > DRIFT_SDS * rest->slope_sd_per_s)
        allow(&o->channel[j], rest, REAL_C(0.0));
    see_drift(&o->channel[j], rest);
}

void origin_take(struct origin *o, uint32_t j, const struct steady_result *rest, real_t level)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    struct origin_channel *c = &o->channel[j];
    if (o->fixed) {
        follow(c, rest, level, o->since_s);
    } else {
        allow(c, rest, DRIFT_SDS);
        see_drift(c, rest);
        c->left = c->moved = REAL_C(0.0);
    }
    if (!o->fixed && real_abs(rest->slope_per_s) > SURE_SDS * rest->slope_sd_per_s)
        o->drifted = true;
    c->level = level;
}

real_t origin_spent(const struct origin *o, uint32_t j, real_t limit)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return real_abs(o->channel[j].left) / (LEFT_MOST * limit);
}

real_t origin_drift(const struct origin *o, uint32_t j, real_t slope_per_s)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    real_t most = o->channel[j].slope_most;
    return real_clamp(slope_per_s, -most, most);
}

real_t origin_fastest(const struct origin *o, uint32_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return o->channel[j].drift_per_s;
}

real_t origin_away(const struct origin *o, uint32_t j, real_t y, real_t limit)
{
    return steady_beyond(y - o->channel[j].level, origin_fastest(o, j) * o->since_s, limit);
}

void origin_taken(struct origin *o)
{
    o->fixed = true;
    o->since_s = REAL_C(0.0);
}

void origin_grow_older(struct origin *o, real_t seconds)
{
    o->since_s += seconds;
}

bool origin_is_fixed(const struct origin *o)
{
    return o->fixed;
}

real_t origin_left(const struct origin *o, uint32_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return o->channel[j].left;
}

real_t origin_moved(const struct origin *o, uint32_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    return o->channel[j].moved;
}

bool origin_drifts(const struct origin *o)
{
    return o->drifted;
}
