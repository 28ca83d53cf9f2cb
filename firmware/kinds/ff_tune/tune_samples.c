/* The samples: means over `period` of what is measured, of the setpoint and of what took effect of the MV, all passed through the same
 * high-pass, and the models that learn from them. */
#include "kinds/ff_tune/feedforward_tune_block.h"

#include <string.h>

#include "base/channel.h"

/* Signals stay within these of a span, so that a model of 35 parameters in fixed point has room. */
#define SIGNAL_MOST 2.0f
/* A setpoint that moves by less has not moved. */
#define SETPOINT_MOVED REAL_C(1e-5)
/* A disturbance that moves by more than this part of its mean square in a sample has moved. */
#define MUCH REAL_C(0.02)

void tune_samples_begin(struct tune *t)
{
    memset(&t->sum, 0, sizeof t->sum);
    t->last.there = false;
    t->begun = false;
    t->setpoint_rests = t->bad_rests = 0;
    high_order_interrupt(tune_model(t));
}

/* ---- a step ---- */

static void add_to_sample(struct tune *t, const struct block_io *io)
{
    real_t u = num_to_float(applied_ticks_ago(io->member_applied[0], 1));
    t->sum.y += num_to_float(t->last.y);
    t->sum.r += num_to_float(t->last.r);
    t->sum.d += num_to_float(t->last.d);
    t->sum.u += u;
    t->sum.added += u - num_to_float(t->last.u_fb);
    t->sum.good = (t->sum.ticks == 0 || t->sum.good) && t->last.good;
    t->sum.ticks++;
}

/* What was measured in this step belongs with the u that is known in the next. */
static void keep_step(struct tune *t, const struct block_io *io)
{
    bool good = true;
    for (unsigned k = 0; k < 2; k++)
        good = good && io->quality[k] == QUALITY_GOOD;
    if (io->quality[0] == QUALITY_GOOD)
        t->held_y = io->input[0];
    if (io->quality[1] == QUALITY_GOOD)
        t->held_d = io->input[1];
    t->last.y = t->held_y;
    t->last.d = t->held_d;
    t->last.r = io->setpoint[0];
    t->last.u_fb = io->in[0];
    t->last.good = good;
    t->last.there = true;
}

/* Noise of a sensor is made white by A in the equation error only as far as A is long enough; a low-pass on all signals, which no response
 * notices, takes most of it away before (tests/unit/test_high_order_confidence.c counts what that does). */
static void smooth_signal(struct tune *t, unsigned k)
{
    real_t share = REAL_C(1.0) / ((real_t)t->s.smooth + REAL_C(1.0));
    real_t *lag = t->smooth[k];
    if (!t->begun)
        lag[0] = lag[1] = num_to_float(t->now[k]);
    lag[0] += share * (num_to_float(t->now[k]) - lag[0]);
    lag[1] += share * (lag[0] - lag[1]);
}

static void high_pass_sample(struct tune *t)
{
    real_t part = REAL_C(1.0) / (real_t)t->sum.ticks;
    const real_t mean[TUNE_SIGNALS] = {[SIGNAL_Y] = t->sum.y * part,
                                       [SIGNAL_R] = t->sum.r * part,
                                       [SIGNAL_D] = t->sum.d * part,
                                       [SIGNAL_U] = t->sum.u * part,
                                       [SIGNAL_ADDED] = t->sum.added * part};
    num_t most = num_from_float(SIGNAL_MOST);
    for (unsigned k = 0; k < TUNE_SIGNALS; k++) {
        num_t x = num_from_float((float)mean[k]);
        if (!t->begun)
            washout_reset(&t->high_pass[k], x);
        t->now[k] = num_clamp(washout_step(&t->high_pass[k], x), num_neg(most), most);
        smooth_signal(t, k);
    }
    real_t moved = mean[SIGNAL_R] - t->last_r;
    bool moves = t->begun && (moved > SETPOINT_MOVED || moved < -SETPOINT_MOVED);
    t->setpoint_rests = (uint16_t)(moves ? 0 : t->setpoint_rests + (t->setpoint_rests < 65535u));
    t->bad_rests = (uint16_t)(!t->sum.good ? 0 : t->bad_rests + (t->bad_rests < 65535u));
    real_t step = mean[SIGNAL_D] - t->last_mean_d;
    bool much = step * step > MUCH * t->move_square;
    t->d_rests = (uint16_t)(much ? 0 : t->d_rests + (t->d_rests < 65535u));
    t->last_mean_d = mean[SIGNAL_D];
    t->last_r = mean[SIGNAL_R];
    t->is_good = t->sum.good;
    t->begun = true;
}

bool tune_take(struct tune *t, const struct block_io *io)
{
    bool whole = false;
    if (t->last.there) {
        add_to_sample(t, io);
        whole = t->sum.ticks >= t->ticks;
    }
    if (whole) {
        high_pass_sample(t);
        memset(&t->sum, 0, sizeof t->sum);
    }
    keep_step(t, io);
    return whole;
}

/* ---- learning ---- */

static const struct high_order_shape *shape_now(const struct tune *t)
{
    return &t->shape[t->stage == TUNE_LOOP ? 0 : 1];
}

void tune_learn_anew(struct tune *t)
{
    struct high_order_settings rules = tune_rules(&t->s);
    high_order_init(tune_model(t), shape_now(t), &rules);
    t->settled_looks = 0;
    t->change = REAL_C(1.0);
    t->since_look = 0;
    t->move_square = t->loop_square = REAL_C(0.0);
    t->squared = 0;
}

static unsigned reach_of_shape(const struct high_order_shape *s)
{
    unsigned most = s->na;
    for (unsigned j = 0; j < s->inputs; j++)
        most =
            (unsigned)(s->delay[j] + s->nb[j]) > most ? (unsigned)(s->delay[j] + s->nb[j]) : most;
    return most;
}

/* The past of a reading that was held is as long as what the model looks back at. */
static bool may_learn(const struct tune *t)
{
    const struct high_order_shape *s = shape_now(t);
    if (t->reading || t->bad_rests <= reach_of_shape(s) + 4u * t->s.smooth)
        return false;
    /* A setpoint that moves is noise where y or u is explained by d alone. */
    return !tune_is_staged(t) || t->stage == TUNE_LOOP ||
           t->setpoint_rests > 4u * reach_of_shape(s);
}

/* The mean since the stage began, then over as many samples as a stage takes. */
static real_t onto_square(const struct tune *t, real_t square, num_t x)
{
    real_t value = num_to_float(x);
    return square + (value * value - square) / (real_t)t->squared;
}

static num_t learnt(const struct tune *t, enum tune_signal k)
{
    return num_from_float((float)t->smooth[k][1]);
}

void tune_learn(struct tune *t)
{
    bool staged = tune_is_staged(t), of_loop = t->stage == TUNE_LOOP;
    bool by_u = t->s.method == TUNE_JOINT || t->s.method == TUNE_SENSITIVITY;
    enum tune_signal mover = by_u ? SIGNAL_U : SIGNAL_R;
    num_t moves = t->now[mover];
    num_t u[HIGH_ORDER_INPUTS] = {learnt(t, mover), learnt(t, SIGNAL_D)}, y = learnt(t, SIGNAL_Y);
    if (staged && !of_loop) {
        u[0] = learnt(t, SIGNAL_D);
        if (t->s.method == TUNE_INPUT) /* what the controller gives */
            y = num_sub(learnt(t, SIGNAL_U), learnt(t, SIGNAL_ADDED));
    }
    t->learns = may_learn(t);
    t->squared += t->squared < tune_samples(t, t->s.learn_s) ? 1u : 0u;
    t->move_square = onto_square(t, t->move_square, t->now[SIGNAL_D]);
    t->loop_square = onto_square(t, t->loop_square, moves);
    (void)high_order_step(tune_model(t), y, u, t->learns);
    t->since_look++;
}

/* ---- whether there is anything to learn ---- */

/* A disturbance rests when less than this part of its squares is left. */
#define AT_REST REAL_C(0.1)
/* Parts of `learn`: the time over which the disturbance is averaged; the time for which larger moves are remembered. */
#define OF_LATE    0.125f
#define REMEMBERED 4.0f

static real_t larger_square(real_t a, real_t b)
{
    return a > b ? a : b;
}

void tune_look_at_disturbance(struct tune *t)
{
    real_t d = num_to_float(t->now[SIGNAL_D]);
    t->d_square += (d * d - t->d_square) / (real_t)tune_samples(t, OF_LATE * t->s.learn_s);
    t->d_most -= t->d_most / (real_t)tune_samples(t, REMEMBERED * t->s.learn_s);
    t->d_most = larger_square(t->d_most, t->d_square);
    bool rests = tune_stands_still(t->d_square) ||
                 t->d_square < AT_REST * larger_square(t->d_learnt, t->d_most);
    t->d_still = rests ? t->d_still + (t->d_still < UINT32_MAX) : 0;
    t->d_moved = t->d_moved || !rests;
    if (t->d_still > tune_samples(t, t->s.learn_s)) /* what moved before is forgotten */
        t->d_noise = t->d_square * (real_t)t->ticks;
}

static bool moves_disturbance(const struct tune *t)
{
    return t->d_is_mv && t->s.disturb > 0 &&
           (t->stage == TUNE_DISTURBANCE || t->stage == TUNE_TESTS);
}

static bool moves_setpoint(const struct tune *t)
{
    return t->s.step > 0 &&
           (t->stage == TUNE_LOOP || (t->stage == TUNE_DISTURBANCE && !tune_is_staged(t)));
}

bool tune_waits(const struct tune *t)
{
    /* The loop is found best where the disturbance rests. But unasked, nothing is moved that rests. */
    bool of_setpoints = t->stage == TUNE_LOOP && !(t->by_itself && t->s.step > 0);
    bool moved_itself = t->d_is_mv && t->s.disturb > 0;
    return t->d_still && !of_setpoints && !moved_itself;
}

/* ---- test signals ---- */

static num_t square_wave(const struct tune *t, float size, float period_s)
{
    uint32_t half = tune_samples(t, 0.5f * period_s);
    bool up = (t->signal_samples / half & 1u) == 0;
    return num_from_float(up ? size : -size);
}

static float fraction_of(float size, const struct block_signal *s)
{
    return size / (s->hi - s->lo);
}

/* A signal may not become another one: a step without lies in between. One that an `apply` of its own proposal has ended may
 * begin again likewise. */
void tune_ask_signal(struct tune *t, struct block_io *io)
{
    bool loop = moves_setpoint(t) && !tune_waits(t);
    bool disturbance = moves_disturbance(t);
    uint8_t asks = (uint8_t)((loop ? 1u : 0u) | (disturbance ? 2u : 0u)), n = 0;
    bool other = t->asked_signal && t->asks != asks;
    t->asked_signal = false;
    t->asks = asks;
    if (t->let_pass || other) {
        t->let_pass = false;
        return;
    }
    if (loop) {
        float size = fraction_of(t->s.step, &t->y_signal);
        io->excite[n++] =
            (struct block_excitation){.what = EXCITE_SETPOINT,
                                      .which = 0,
                                      .value = square_wave(t, size, t->s.step_period_s),
                                      .amplitude = num_from_float(size),
                                      .lo = num_from_float(-1),
                                      .hi = num_from_float(2)};
    }
    if (disturbance) {
        float size = fraction_of(t->s.disturb, &t->d_signal);
        io->excite[n++] =
            (struct block_excitation){.what = EXCITE_INPUT,
                                      .which = 1,
                                      .value = square_wave(t, size, t->s.disturb_period_s),
                                      .amplitude = num_from_float(size),
                                      .lo = num_from_float(-1),
                                      .hi = num_from_float(2)};
    }
    t->asked_signal = n > 0;
}
