#include "identify/steady.h"

#include "base/assertion.h"
#include "identify/common.h"

#define SIGNIFICANT_SDS REAL_C(3.0)

enum err steady_init(struct steady *s, const struct steady_config *config)
{
    enum err err = check_real(config->h_s, REAL_C(1e-3), REAL_C(1e5));
    if (!err)
        err = check_real(config->noise_floor, REAL_C(1e-30), REAL_C(1e6));
    if (!err)
        err = check_real(config->motion_limit, REAL_C(0.1), REAL_C(1e3));
    if (!err)
        err = check_real(config->variance_limit, ONE, REAL_C(1e3));
    if (err)
        return err;
    if (config->outputs == 0 || config->outputs > CHANNEL_MAX || config->block == 0 ||
        config->block > (1u << 24))
        return ERR_RANGE;
    s->config = *config;
    steady_reset(s);
    return ERR_OK;
}

void steady_reset(struct steady *s)
{
    s->blocks = 0;
    s->waiting = 0;
    s->started = false;
}

enum err steady_step(struct steady *s, const real_t *y)
{
    REFLUX_ASSERT(s->config.outputs <= CHANNEL_MAX && s->blocks < 2 * STEADY_BLOCKS &&
                  s->waiting < s->config.block);
    real_t d[CHANNEL_MAX] = {ZERO};
    for (uint32_t o = 0; o < s->config.outputs; o++) {
        d[o] = y[o] - (s->started ? s->output[o].reference : ZERO);
        enum err err = check_real(d[o], -VALUE_MAX, VALUE_MAX);
        if (err)
            return err;
    }
    if (!s->started) {
        for (uint32_t o = 0; o < s->config.outputs; o++) {
            s->output[o].reference = y[o];
            s->output[o].last = d[o] = ZERO;
            s->output[o].sum = s->output[o].square = ZERO;
        }
        s->started = true;
    }
    s->waiting++;
    uint32_t slot = s->blocks % STEADY_BLOCKS;
    for (uint32_t o = 0; o < s->config.outputs; o++) {
        real_t step = d[o] - s->output[o].last;
        s->output[o].last = d[o];
        s->output[o].sum += d[o];
        s->output[o].square += step * step;
        if (s->waiting == s->config.block) {
            s->output[o].mean[slot] = s->output[o].sum / (real_t)s->config.block;
            s->output[o].difference[slot] = s->output[o].square;
            s->output[o].sum = s->output[o].square = ZERO;
        }
    }
    if (s->waiting == s->config.block) {
        s->waiting = 0;
        s->blocks++;
        if (s->blocks == 2 * STEADY_BLOCKS) /* only its remainder matters from here on */
            s->blocks = STEADY_BLOCKS;
    }
    return ERR_OK;
}

enum err steady_look(const struct steady *s, uint32_t output, struct steady_result *result)
{
    if (output >= s->config.outputs)
        return ERR_RANGE;
    const real_t *mean = s->output[output].mean, *difference = s->output[output].difference;
    uint32_t full = s->blocks < STEADY_BLOCKS ? s->blocks : STEADY_BLOCKS;
    real_t block = (real_t)s->config.block, n = (real_t)STEADY_BLOCKS;
    real_t squares = ZERO, sum = ZERO;
    for (uint32_t i = 0; i < full; i++) {
        squares += difference[i];
        sum += mean[i];
    }
    *result = (struct steady_result){.state = STEADY_NOT_ENOUGH};
    /* The very first sample has no difference; one in so many does not matter. */
    real_t noise = full > 0 ? real_sqrt(squares / (REAL_C(2.0) * block * (real_t)full)) : ZERO;
    result->noise_sd = noise > s->config.noise_floor ? noise : s->config.noise_floor;
    if (full < STEADY_BLOCKS)
        return ERR_OK;

    real_t middle = REAL_C(0.5) * (n - ONE), centre = sum / n, cross = ZERO;
    for (uint32_t i = 0; i < STEADY_BLOCKS; i++)
        cross += ((real_t)i - middle) * (mean[(s->blocks + i) % STEADY_BLOCKS] - centre);
    real_t spread = n * (n * n - ONE) / REAL_C(12.0);
    real_t climb = cross / spread; /* per block */
    real_t left = ZERO;
    for (uint32_t i = 0; i < STEADY_BLOCKS; i++) {
        real_t off = mean[(s->blocks + i) % STEADY_BLOCKS] - centre - climb * ((real_t)i - middle);
        left += off * off;
    }
    /* The climb of a straight line is in the differences too; it is no noise. */
    real_t step = climb / block;
    real_t pure = noise * noise - REAL_C(0.5) * step * step;
    noise = pure > s->config.noise_floor * s->config.noise_floor ? real_sqrt(pure)
                                                                 : s->config.noise_floor;
    real_t expected = noise * noise / block, seen = left / (n - REAL_C(2.0));
    real_t one = seen > expected ? seen : expected; /* variance of a block mean */
    real_t slope_sd = real_sqrt(one / spread);

    result->noise_sd = noise;
    result->mean = s->output[output].reference + centre;
    result->mean_sd = real_sqrt(one / n);
    result->level = result->mean + climb * (middle + REAL_C(0.5) * (block - ONE) / block);
    result->slope_per_s = climb / (block * s->config.h_s);
    result->slope_sd_per_s = slope_sd / (block * s->config.h_s);
    result->variance_ratio = seen / expected;
    result->age_s = (REAL_C(0.5) * (n * block - ONE) + (real_t)s->waiting) * s->config.h_s;
    real_t motion = real_abs(climb) * n;
    if (result->variance_ratio > s->config.variance_limit)
        result->state = STEADY_RESTLESS;
    else if (motion > s->config.motion_limit * noise &&
             real_abs(climb) > SIGNIFICANT_SDS * slope_sd)
        result->state = STEADY_MOVING;
    else
        result->state = STEADY_SETTLED;
    return ERR_OK;
}

real_t steady_away(real_t away, real_t carried, real_t most)
{
    carried = real_clamp(carried, -most, most);
    return real_abs(away - carried) < real_abs(away) ? away - carried : away;
}

real_t steady_beyond(real_t away, real_t carried, real_t most)
{
    carried = real_abs(real_clamp(carried, -most, most));
    return away - real_clamp(away, -carried, carried);
}
