/* Two shadows on the same data: the loop without its feedforward, and with the candidate in its place. So a candidate is tested before it acts, and
 * one that acts is compared with feedback alone without being switched off. */
#include "kinds/ff_tune/feedforward_tune_block.h"

#include <string.h>

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define PARTS_BETTER 6u /* of TUNE_PARTS, at the least */
#define QUIET_PART                                                                                 \
    REAL_C(0.1)       /* of the mean square of d while it was learnt; below, a part tells nothing */
#define TEST_MOST  4u /* times `check`, then it is untested */
#define WORSE_THAN REAL_C(1.1) /* times the squares without it */
/* An element need do nothing where there is less than this part of the squares that were tested. */
#define LITTLE     REAL_C(0.25)
#define WATCH_PART REAL_C(0.25) /* of `check`: memory of the watch */

/* ---- shadows ---- */

static void begin_shadow(const struct tune *t, struct loop_shadow *s)
{
    shadow_begin(s, &t->model.is, t->s.gain, t->s.ti_s, t->h_s);
}

void tune_shadows_begin(struct tune *t)
{
    begin_shadow(t, &t->without);
    t->integral = ZERO;
    t->warm = 0;
}

static void begin_candidate(struct tune *t)
{
    real_t d = num_to_float(t->now[SIGNAL_D]);
    begin_shadow(t, &t->with);
    for (unsigned k = 0; k < SHADOW_REACH; k++)
        t->delayed[k] = d;
    t->lead_lag = t->last_d = d;
    t->test_warm = 0;
}

/* What the candidate would add. Its own steps are those of the samples here. */
static real_t candidate_adds(struct tune *t)
{
    const struct feedforward_shape *f = &t->candidate;
    real_t dead = f->dead / t->h_s;
    unsigned most = SHADOW_REACH - 2u;
    unsigned whole = dead < (real_t)most ? (unsigned)dead : most;
    real_t part = dead < (real_t)most ? dead - (real_t)whole : ZERO;
    memmove(t->delayed + 1, t->delayed, (SHADOW_REACH - 1u) * sizeof t->delayed[0]);
    t->delayed[0] = num_to_float(t->now[SIGNAL_D]);
    real_t d = t->delayed[whole] + part * (t->delayed[whole + 1u] - t->delayed[whole]);
    t->lead_lag += (t->h_s * (d - t->lead_lag) + f->lead * (d - t->last_d)) / (f->lag + t->h_s);
    t->last_d = d;
    return f->k * t->lead_lag;
}

/* Returns the samples in which the closed loop forgets. It is faster than the process by 1 + K gain, so one that integrates forgets, too. */
static uint32_t forgets_in(const struct tune *t)
{
    real_t of_loop = t->model.is.gain * t->s.gain;
    real_t lag = t->model.is.time_constant_s / (ONE + (of_loop > ZERO ? of_loop : ZERO));
    real_t s = REAL_C(5.0) * lag + REAL_C(4.0) * t->model.is.dead_time_s + REAL_C(2.0) * t->s.ti_s;
    real_t n = s / t->h_s;
    return n < REAL_C(60000.0) ? (uint32_t)n : 60000u;
}

/* What took effect beside what the controller would have given from the same measurements, were it linear: the feedforward, but
 * also what limits have made of it and of the integral. */
static real_t beside_controller(struct tune *t, real_t error)
{
    real_t r = num_to_float(t->now[SIGNAL_R]), y = num_to_float(t->now[SIGNAL_Y]);
    real_t given = t->s.gain * (t->s.b * r - y) + t->integral;
    if (t->s.ti_s > 0)
        t->integral += t->s.gain * t->h_s / t->s.ti_s * error;
    return num_to_float(t->now[SIGNAL_U]) - given;
}

static uint16_t one_more(uint16_t n)
{
    return (uint16_t)(n < 65535u ? n + 1u : n);
}

void tune_shadows_step(struct tune *t)
{
    struct tune_errors *e = &t->errors;
    uint32_t rest = forgets_in(t);
    e->now = num_to_float(num_sub(t->now[SIGNAL_R], t->now[SIGNAL_Y]));
    e->without = e->now + shadow_step(&t->without, beside_controller(t, e->now));
    t->warm = one_more(t->warm);
    e->count = t->warm > rest && t->setpoint_rests > rest && t->is_good;
    e->then = e->without;
    if (t->stage != TUNE_TESTS)
        return;
    e->then -= shadow_step(&t->with, candidate_adds(t));
    t->test_warm = one_more(t->test_warm);
}

/* ---- the test ---- */

static void begin_test_part(struct tune *t)
{
    t->part_at = 0;
    t->part_now = t->part_then = t->part_without = t->part_d = ZERO;
}

void tune_test_begin(struct tune *t)
{
    begin_candidate(t);
    t->part_samples = tune_samples(t, t->s.check_s / (float)TUNE_PARTS);
    t->parts = t->better_parts = 0;
    t->all_now = t->all_then = t->all_without = t->all_d = ZERO;
    begin_test_part(t);
}

static enum tune_verdict judge_candidate(struct tune *t)
{
    real_t most = ONE - t->s.better / 100;
    /* Where it is to cancel the disturbance it leaves what the model of the process is off by. */
    real_t then = t->all_then + t->model.off * t->model.off * t->all_without;
    bool better = t->better_parts >= PARTS_BETTER && then <= most * t->all_now &&
                  then <= most * t->all_without;
    t->promised = t->all_without > ZERO ? ONE - then / t->all_without : ZERO;
    t->alone = t->all_d > ZERO ? t->all_without / t->all_d : ZERO;
    t->tested = t->all_without / (real_t)(t->parts * t->part_samples);
    return better ? TUNE_ADOPTED : TUNE_NO_BETTER;
}

static void count_in_test(struct tune *t, const struct tune_errors *e)
{
    real_t d = num_to_float(t->now[SIGNAL_D]);
    t->part_now += e->now * e->now;
    t->part_then += e->then * e->then;
    t->part_without += e->without * e->without;
    t->part_d += d * d;
    if (++t->part_at < t->part_samples)
        return;
    if (t->part_d > QUIET_PART * t->move_square * (real_t)t->part_at) {
        t->parts++;
        t->better_parts = (uint8_t)(t->better_parts + (t->part_then < t->part_now ? 1u : 0u));
        t->all_now += t->part_now;
        t->all_then += t->part_then;
        t->all_without += t->part_without;
        t->all_d += t->part_d;
    }
    begin_test_part(t);
}

enum tune_verdict tune_test_step(struct tune *t)
{
    if (t->without.lost || t->with.lost)
        return TUNE_NO_MODEL;
    if (t->errors.count && t->test_warm > forgets_in(t))
        count_in_test(t, &t->errors);
    if (t->parts >= TUNE_PARTS)
        return judge_candidate(t);
    uint32_t most = TEST_MOST * (TUNE_PARTS * t->part_samples) + 4u * forgets_in(t);
    return t->stage_samples > most ? TUNE_UNTESTED : TUNE_NONE;
}

/* ---- the watch ---- */

void tune_watch_begin(struct tune *t)
{
    t->watch_with = t->watch_without = t->watch_d = t->watch_weight = ZERO;
    t->since_change = t->worse_for = 0;
    t->as_alone = false;
}

static real_t memory_of_watch(const struct tune *t)
{
    return WATCH_PART * t->s.check_s / t->h_s;
}

float tune_improvement(const struct tune *t)
{
    bool whole = t->running && t->watch_weight > REAL_C(0.1) * memory_of_watch(t);
    return whole && t->watch_without > ZERO ? 100 * (float)(ONE - t->watch_with / t->watch_without)
                                            : 0;
}

enum tune_verdict tune_watch_step(struct tune *t)
{
    const struct tune_errors e = t->errors;
    real_t memory = memory_of_watch(t), keep = ONE - ONE / memory;
    real_t d = num_to_float(t->now[SIGNAL_D]);
    if (t->without.lost) {
        tune_shadows_begin(t);
        tune_watch_begin(t);
        return TUNE_NO_MODEL;
    }
    if (!e.count)
        return TUNE_NONE;
    t->watch_with = keep * t->watch_with + e.now * e.now;
    t->watch_without = keep * t->watch_without + e.without * e.without;
    t->watch_d = keep * t->watch_d + d * d;
    t->watch_weight = keep * t->watch_weight + ONE;
    bool whole = t->watch_weight > REAL_C(0.5) * memory;
    /* The shadow has the model of then. Where the process is another one now it may find good what is no better than feedback alone was. */
    t->as_alone = t->alone > ZERO && t->watch_with > t->alone * t->watch_d;
    bool less = whole && (t->as_alone ||
                          t->watch_with > (ONE - REAL_C(0.5) * t->promised) * t->watch_without);
    /* While the disturbance rests, or does little, there is nothing that it could do. */
    real_t little = LITTLE * t->tested * t->watch_weight;
    bool there = !t->d_still && (t->watch_with > little || t->watch_without > little);
    t->since_change = less && there ? t->since_change + 1u : 0;
    t->changes = whole && !less && there ? 0 : t->changes;
    /* For as long as the loop takes to forget: a feedforward may act before the disturbance does, and loses for that while. */
    bool worse = whole && t->watch_with > WORSE_THAN * t->watch_without;
    t->worse_for = worse ? t->worse_for + 1u : 0;
    return t->worse_for > forgets_in(t) && !t->off_waits ? TUNE_WORSE : TUNE_NONE;
}
