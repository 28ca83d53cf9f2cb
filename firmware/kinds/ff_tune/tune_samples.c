#include "kinds/ff_tune/tune_samples.h"

#include <string.h>

#include "base/assertion.h"
#include "base/channel.h"
#include "kinds/ff_tune/tune_samples_state.h"

/* Signals stay within these of a span, so that a model of 35 parameters in fixed point has room. */
#define SIGNAL_MOST 2.0f
/* A setpoint that moves by less has not moved. */
#define SETPOINT_MOVED REAL_C(1e-5)
/* A disturbance that moves by more than this part of its mean square in a sample has moved. */
#define MUCH REAL_C(0.02)

void tune_samples_configure(struct tune_samples *s, const struct tune_context *c)
{
    float bias = c->s.bias_s > 0 ? c->s.bias_s : 0.25f * c->s.learn_s;
    for (unsigned k = 0; k < TUNE_SIGNALS; k++) {
        enum err none = washout_init(&s->high_pass[k], 1, bias, bias, (float)c->h_s); /* checked */
        (void)none;
    }
}

void tune_samples_begin(struct tune_samples *s)
{
    memset(&s->sum, 0, sizeof s->sum);
    s->last.kept = false;
    s->begun = false;
    s->setpoint_rests = s->bad_rests = 0;
}

/* ---- a step ---- */

static void add_to_sample(struct tune_samples *s, const struct block_io *io)
{
    real_t u = num_to_float(applied_ticks_ago(io->members.applied[0], 1));
    s->sum.y += num_to_float(s->last.y);
    s->sum.r += num_to_float(s->last.r);
    s->sum.d += num_to_float(s->last.d);
    s->sum.u += u;
    s->sum.added += u - num_to_float(s->last.u_fb);
    s->sum.good = (s->sum.ticks == 0 || s->sum.good) && s->last.good;
    s->sum.ticks++;
}

/* The measurements of this step belong to the u that is known in the next. */
static void keep_step(struct tune_samples *s, const struct block_io *io)
{
    bool good = true;
    for (unsigned k = 0; k < 2; k++)
        good = good && io->inputs.quality[k] == QUALITY_GOOD;
    if (io->inputs.quality[0] == QUALITY_GOOD)
        s->held_y = io->inputs.value[0];
    if (io->inputs.quality[1] == QUALITY_GOOD)
        s->held_d = io->inputs.value[1];
    s->last.y = s->held_y;
    s->last.d = s->held_d;
    s->last.r = io->members.setpoint[0];
    s->last.u_fb = io->members.in[0];
    s->last.good = good;
    s->last.kept = true;
}

/* A makes the noise of a sensor white in the equation error only as far as A is long enough. A low-pass on all signals, which changes no
 * response, takes most of the noise away before (tests/unit/test_high_order_confidence.c counts how much). */
static void smooth_signal(struct tune_samples *s, const struct tune_context *c, unsigned k)
{
    real_t share = REAL_C(1.0) / ((real_t)c->s.smooth + REAL_C(1.0));
    real_t *lag = s->smooth[k];
    if (!s->begun)
        lag[0] = lag[1] = num_to_float(s->passed[k]);
    lag[0] += share * (num_to_float(s->passed[k]) - lag[0]);
    lag[1] += share * (lag[0] - lag[1]);
}

static uint16_t rests_after(uint16_t rests, bool moved)
{
    return (uint16_t)(moved ? 0 : rests + (rests < 65535u));
}

static void high_pass_sample(struct tune_samples *s, const struct tune_context *c,
                             real_t move_square)
{
    REFLUX_ASSERT(s->sum.ticks > 0);
    real_t part = REAL_C(1.0) / (real_t)s->sum.ticks;
    const real_t mean[TUNE_SIGNALS] = {[SIGNAL_Y] = s->sum.y * part,
                                       [SIGNAL_R] = s->sum.r * part,
                                       [SIGNAL_D] = s->sum.d * part,
                                       [SIGNAL_U] = s->sum.u * part,
                                       [SIGNAL_ADDED] = s->sum.added * part};
    num_t most = num_from_float(SIGNAL_MOST);
    for (unsigned k = 0; k < TUNE_SIGNALS; k++) {
        num_t x = num_from_float((float)mean[k]);
        if (!s->begun)
            washout_reset(&s->high_pass[k], x);
        s->passed[k] = num_clamp(washout_step(&s->high_pass[k], x), num_neg(most), most);
        smooth_signal(s, c, k);
    }
    real_t moved = mean[SIGNAL_R] - s->last_r;
    bool moves = s->begun && (moved > SETPOINT_MOVED || moved < -SETPOINT_MOVED);
    s->setpoint_rests = rests_after(s->setpoint_rests, moves);
    s->bad_rests = rests_after(s->bad_rests, !s->sum.good);
    real_t step = mean[SIGNAL_D] - s->last_d;
    s->disturbance_rests = rests_after(s->disturbance_rests, step * step > MUCH * move_square);
    s->last_d = mean[SIGNAL_D];
    s->last_r = mean[SIGNAL_R];
    s->good = s->sum.good;
    s->begun = true;
}

bool tune_samples_take(struct tune_samples *s, const struct tune_context *c,
                       const struct block_io *io, real_t move_square)
{
    bool whole = false;
    if (s->last.kept) {
        add_to_sample(s, io);
        whole = s->sum.ticks >= c->ticks;
    }
    if (whole) {
        high_pass_sample(s, c, move_square);
        memset(&s->sum, 0, sizeof s->sum);
    }
    keep_step(s, io);
    return whole;
}

/* ---- the last sample ---- */

real_t tune_sample(const struct tune_samples *s, enum tune_signal k)
{
    REFLUX_ASSERT(k < TUNE_SIGNALS);
    return num_to_float(s->passed[k]);
}

real_t tune_sample_error(const struct tune_samples *s)
{
    return num_to_float(num_sub(s->passed[SIGNAL_R], s->passed[SIGNAL_Y]));
}

num_t tune_sample_smooth(const struct tune_samples *s, enum tune_signal k)
{
    REFLUX_ASSERT(k < TUNE_SIGNALS);
    return num_from_float((float)s->smooth[k][1]);
}

bool tune_sample_is_good(const struct tune_samples *s)
{
    return s->good;
}

uint16_t tune_since_setpoint(const struct tune_samples *s)
{
    return s->setpoint_rests;
}

uint16_t tune_since_disturbance(const struct tune_samples *s)
{
    return s->disturbance_rests;
}

uint16_t tune_since_bad(const struct tune_samples *s)
{
    return s->bad_rests;
}
