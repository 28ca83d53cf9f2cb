#include "commission/trial_step.h"

#include "base/assertion.h"
#include "commission/swing.h"
#include "commission/trial_line.h"
#include "commission/trial_step_state.h"

#include <string.h>

#define NOISE_MULTIPLE REAL_C(4.0)
#define REST_SHARE     REAL_C(0.15) /* of the step: error left at the end of it */
/* ... of the way back with a raised gain, which may still oscillate then: a quarter may hold little more than a half cycle. */
#define RAISED_REST_SHARE REAL_C(0.5)
#define BLOCKED_SHARE     REAL_C(0.25) /* of a step's time that an output may stand at a limit */
#define AT_LIMIT          REAL_C(1e-5) /* of span */

void trial_step_watch_output(struct trial_step *t, const struct supervisor *s, uint8_t k,
                             uint8_t output)
{
    REFLUX_ASSERT(k < CONFIG_LOOPS && output < CHANNEL_MAX);
    const struct mv_config *o = &s->plan->config.mv[output];
    real_t u = num_to_float(s->mv[output].constrained), span = o->hi - o->lo;
    real_t lo = (o->min - o->lo) / span, hi = (o->max - o->lo) / span;
    if (u <= lo + AT_LIMIT || u >= hi - AT_LIMIT)
        t->blocked[k]++;
}

/* Distance from the setpoint because of a drift that the line may not have foreseen. The controller has to climb as fast as the
 * drift, for which the error is the drift times the integral of the error after a unit step: both are Ti / (K Kc). The other
 * loops drift, too. */
static real_t lag_behind_drift(const struct adoption_loop *loop,
                               const struct adoption_channel *channel)
{
    real_t unforeseen = trial_line_unforeseen(&channel->line);
    return REAL_C(2.0) * unforeseen * loop->predicted.iae / real_abs(loop->size);
}

void trial_step_swing(struct trial_step *t, const struct adoption_loop *loop,
                      const struct adoption_channel *channel, real_t error,
                      const struct swing_rule *rule, bool last)
{
    real_t lag = lag_behind_drift(loop, channel);
    swing_step(&t->swing, error, rule, channel->noise_sd, lag);
    if (last)
        swing_end(&t->swing, rule, channel->noise_sd, lag);
}

void trial_step_rest(struct trial_step *t, real_t error, bool ends)
{
    if (!ends)
        return;
    t->error_sum += error;
    t->error_n++;
}

/* The mean error of the last quarter is too large. direction: of the step, 1 or -1; foreseen: that part of it by the prediction. */
static bool is_apart(const struct trial_step *t, const struct adoption_loop *loop,
                     const struct adoption_channel *channel, real_t direction, real_t foreseen,
                     real_t share)
{
    real_t left = t->error_n ? t->error_sum / (real_t)t->error_n : REAL_C(0.0);
    left *= direction;
    /* Nearer to the setpoint than predicted is no failure: between the two the loop was only faster. */
    real_t low = foreseen < REAL_C(0.0) ? foreseen : REAL_C(0.0), high = foreseen - low;
    real_t apart = left > high ? left - high : left < low ? low - left : REAL_C(0.0);
    return apart >
           share * real_abs(loop->step) + channel->noise_sd + lag_behind_drift(loop, channel);
}

bool trial_step_is_restless(const struct trial_step *t, const struct adoption_loop *loop,
                            const struct adoption_channel *channel, real_t step, real_t left)
{
    if (real_abs(loop->left) > REST_SHARE * real_abs(loop->size))
        return false; /* the way back begins before the way there is over */
    real_t direction = step > REAL_C(0.0) ? REAL_C(1.0) : REAL_C(-1.0);
    return is_apart(t, loop, channel, direction, left * real_abs(loop->step), RAISED_REST_SHARE);
}

void trial_step_sample(struct trial_step *t, struct adoption_loop *loop, real_t error, real_t h_s,
                       bool ends)
{
    loop->iae += real_abs(error) * h_s;
    real_t past = -error / loop->step; /* in units of the step, above 0 beyond the setpoint */
    if (past > loop->peak)
        loop->peak = past;
    trial_step_rest(t, error, ends);
}

enum adoption_result trial_step_verdict(const struct trial_step *t,
                                        const struct adoption_loop *loop,
                                        const struct adoption_channel *channel, uint8_t loops,
                                        uint32_t ticks, real_t h_s)
{
    real_t scale = real_abs(loop->step / loop->size), step = real_abs(loop->step);
    real_t noise_sd = channel->noise_sd, ran_s = (real_t)ticks * h_s;
    /* The integral by noise alone: its mean magnitude is 0.8 of its standard deviation. */
    real_t lag = lag_behind_drift(loop, channel);
    real_t iae_most =
        ADOPTION_IAE * loop->predicted.iae * scale + (REAL_C(1.5) * noise_sd + lag) * ran_s;
    real_t peak_most =
        loop->predicted.peak + ADOPTION_PEAK + (NOISE_MULTIPLE * noise_sd + lag) / step;
    real_t away = loop->step > REAL_C(0.0) ? REAL_C(1.0) : REAL_C(-1.0);
    for (uint8_t k = 0; k < loops; k++)
        if ((real_t)t->blocked[k] > BLOCKED_SHARE * (real_t)ticks)
            return ADOPTION_BLOCKED;
    if (loop->peak > peak_most)
        return ADOPTION_OVERSHOOT;
    if (swing_grows(&t->swing))
        return ADOPTION_SWINGS;
    if (is_apart(t, loop, channel, away, loop->left * scale, REST_SHARE))
        return ADOPTION_RESTLESS;
    if (loop->iae > iae_most)
        return ADOPTION_SLOW;
    return ADOPTION_RUNNING;
}
