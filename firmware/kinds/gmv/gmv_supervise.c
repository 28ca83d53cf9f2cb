#include "kinds/gmv/gmv_supervise.h"

#include <string.h>

#include "kinds/gmv/gmv_supervise_state.h"
#include "num/real.h"

/* Smaller prediction errors (mean square: 0.1 % of span r.m.s.) decide nothing: at rest a standstill predicts perfectly, and a
 * model with such errors does no harm. */
#define SMALL_SQUARE 1e-6f
/* A model in use is given up when its squares are this multiple of those of a standstill: twice the errors. */
#define WORSE 4.0f
/* An upset grows above this decay; the trial is no more precise. */
#define GROWTH 1.001f

static void begin_window(struct gmv_supervise *s)
{
    s->steps_left = s->config.check_steps;
    s->overtime = 0;
    s->has_outcome = false;
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        s->samples[i] = 0;
        s->model_squares[i] = s->standstill_squares[i] = 0;
    }
}

static void enter_state(struct gmv_supervise *s, enum gmv_state state)
{
    s->status.state = (uint8_t)state;
    s->elapsed = 0;
    s->status.testing = s->adopt_asked = false;
    begin_window(s);
    gmv_monitors_begin(&s->monitors);
}

void gmv_supervise_begin(struct gmv_supervise *s)
{
    s->tested_loops = 0;
    gmv_gate_begin(&s->gate);
    enter_state(s, GMV_TUNING);
}

void gmv_supervise_init(struct gmv_supervise *s, const struct gmv_supervise_config *c)
{
    memset(s, 0, sizeof *s);
    s->config = *c;
    s->status.outcome = (struct gmv_outcome){.times = 1, .ratio = 1};
    gmv_supervise_begin(s);
}

void gmv_supervise_retune(struct gmv_supervise *s, const struct gmv_supervise_config *c)
{
    s->config = *c;
    if (s->steps_left > c->check_steps)
        s->steps_left = c->check_steps;
}

uint8_t gmv_supervise_look(struct gmv_supervise *s, const struct gmv_observation *seen)
{
    return gmv_gate_look(&s->gate, &s->config, seen, s->status.rest);
}

/* ---- results of a step ---- */

static void sum_up(struct gmv_supervise *s, const struct gmv_result *result)
{
    for (unsigned i = 0; i < s->config.loops; i++) {
        if (!(result->complete & (1u << i)) || gmv_gate_spoilt(&s->gate, i))
            continue;
        s->samples[i]++;
        s->model_squares[i] += result->error[i] * result->error[i];
        s->standstill_squares[i] += result->standstill[i] * result->standstill[i];
    }
    if (result->trial_done) {
        s->has_outcome = true;
        s->status.outcome = result->outcome;
    }
    s->steps_left -= s->steps_left > 0;
}

/* Returns whether the model predicts at least as well as a standstill, whose squares count `times` times. */
static bool predicts(const struct gmv_supervise *s, uint8_t acting, float times)
{
    for (unsigned i = 0; i < s->config.loops; i++) {
        float floor = SMALL_SQUARE * (float)s->samples[i];
        if ((acting & (1u << i)) &&
            !(s->model_squares[i] <= times * s->standstill_squares[i] + floor))
            return false;
    }
    return true;
}

static enum gmv_refusal refusal_of(const struct gmv_supervise *s, const struct gmv_result *result,
                                   uint8_t acting)
{
    if (!gmv_monitors_gains(&s->config, result, acting))
        return GMV_REFUSED_GAIN;
    if (!predicts(s, acting, 1))
        return GMV_REFUSED_PREDICTION;
    if (!(s->status.outcome.decay <= GMV_SLOWEST_DECAY))
        return GMV_REFUSED_POLES;
    return gmv_outcome_passes(&s->status.outcome, s->config.better) ? GMV_ADOPTED : GMV_REFUSED_PI;
}

/* ---- tuning ---- */

static uint8_t take_over(struct gmv_supervise *s, uint8_t acting)
{
    s->tested_loops = acting;
    s->status.alarms = 0;
    enter_state(s, GMV_SELF_TUNING);
    return GMV_WISH_LAW;
}

static uint8_t judge_test(struct gmv_supervise *s, const struct gmv_result *result, uint8_t acting)
{
    s->status.refusal = (uint8_t)refusal_of(s, result, acting);
    s->status.testing = false;
    if (s->status.refusal != GMV_ADOPTED)
        return GMV_WISH_REFUSED;
    if (!s->config.ask)
        return take_over(s, acting) | GMV_WISH_PROPOSE;
    s->tested_loops = acting;
    enter_state(s, GMV_WAITING);
    return GMV_WISH_PROPOSE;
}

/* Returns whether the setpoints have settled, because the law must not take over half-way through an answer. Waits no longer than
 * a test lasts. */
static bool setpoints_rest(struct gmv_supervise *s, uint8_t acting)
{
    if (gmv_monitors_setpoints_rest(&s->monitors, &s->config, acting) ||
        s->overtime >= s->config.check_steps)
        return true;
    s->overtime++;
    return false;
}

static uint8_t judge_tuning(struct gmv_supervise *s, const struct gmv_result *result,
                            uint8_t acting)
{
    bool whole = (result->complete & acting) == acting;
    if (s->adopt_asked && whole)
        return take_over(s, acting) | GMV_WISH_CANDIDATE | GMV_WISH_PROPOSE;
    if (!s->config.on && whole && s->elapsed >= s->config.tune_steps)
        return take_over(s, acting) | GMV_WISH_CANDIDATE;
    if (!s->config.on)
        return 0;
    if (!s->status.testing) {
        if (s->elapsed < s->config.tune_steps || !whole || (result->excited & acting) != acting)
            return 0;
        s->status.testing = true;
        s->tested_loops = acting;
        begin_window(s);
        return GMV_WISH_CANDIDATE | GMV_WISH_TRIAL;
    }
    if (s->tested_loops != acting) { /* other loops act: the test starts again */
        s->status.testing = false;
        return 0;
    }
    bool over = s->steps_left == 0 && s->has_outcome && setpoints_rest(s, acting);
    return over ? judge_test(s, result, acting) : 0;
}

uint8_t gmv_supervise_accepted(struct gmv_supervise *s, bool accepted)
{
    if (s->status.state != GMV_WAITING)
        return 0;
    if (accepted)
        return take_over(s, s->tested_loops);
    s->status.refusal = GMV_REFUSED_BY_HAND;
    enter_state(s, GMV_TUNING);
    return GMV_WISH_REFUSED;
}

/* ---- self-tuning ---- */

/* Counts a return to the PI. True: the day's last one that is allowed. */
static bool too_often(struct gmv_supervise *s)
{
    uint8_t recent = 0;
    memmove(&s->return_step[1], &s->return_step[0],
            sizeof s->return_step - sizeof s->return_step[0]);
    s->return_step[0] = s->steps;
    s->returns = (uint8_t)(s->returns + (s->returns < GMV_TRIES_MOST));
    while (recent < s->returns && s->steps - s->return_step[recent] < s->config.day_steps)
        recent++;
    return s->config.tries && recent >= s->config.tries;
}

static uint8_t give_up(struct gmv_supervise *s, enum gmv_alarm why, float value)
{
    uint8_t wish = GMV_WISH_PI | GMV_WISH_FORGET;
    s->status.alarms = (uint8_t)why;
    s->status.alarm_value = value;
    s->tested_loops = 0;
    enter_state(s, GMV_TUNING);
    return too_often(s) ? (uint8_t)(wish | GMV_WISH_GIVE_UP) : wish;
}

/* Returns the largest prediction error of this window, r.m.s. */
static float worst_error(const struct gmv_supervise *s)
{
    float most = 0;
    for (unsigned i = 0; i < s->config.loops; i++)
        if (s->samples[i] && s->model_squares[i] > most * (float)s->samples[i])
            most = s->model_squares[i] / (float)s->samples[i];
    return real_sqrt(most);
}

static uint8_t judge_self_tuning(struct gmv_supervise *s, const struct gmv_observation *seen,
                                 const struct gmv_result *result)
{
    if (!s->config.on)
        return 0;
    uint8_t untested = seen->acting & (uint8_t)~s->tested_loops;
    if (untested) {
        enter_state(s, GMV_TUNING);
        return GMV_WISH_PI;
    }
    float value = 0;
    enum gmv_alarm alarm = gmv_monitors_step(&s->monitors, &s->config, seen, result, &value);
    if (alarm)
        return give_up(s, alarm, value);
    if (s->elapsed == 1)
        return GMV_WISH_TRIAL;
    if (s->steps_left || !s->has_outcome)
        return 0;
    if (!(s->status.outcome.decay <= GROWTH))
        return give_up(s, GMV_ALARM_POLES, s->status.outcome.decay);
    if (!predicts(s, seen->acting, WORSE))
        return give_up(s, GMV_ALARM_WORSE, worst_error(s));
    begin_window(s);
    return GMV_WISH_TRIAL;
}

uint8_t gmv_supervise_judge(struct gmv_supervise *s, const struct gmv_observation *seen,
                            const struct gmv_result *result)
{
    s->steps++;
    s->elapsed += s->elapsed < UINT32_MAX;
    for (unsigned i = 0; i < s->config.loops; i++)
        if ((result->complete & (1u << i)) &&
            (s->status.rest[i] == GMV_LEARNS || s->status.rest[i] == GMV_RESTS_QUIET))
            gmv_gate_weigh(&s->gate, &s->config, result, i);
    sum_up(s, result);
    if (s->status.state != GMV_SELF_TUNING)
        gmv_monitors_keep_record(&s->monitors, &s->config, seen);
    switch (s->status.state) {
    case GMV_TUNING:
        return judge_tuning(s, result, seen->acting);
    case GMV_SELF_TUNING:
        return judge_self_tuning(s, seen, result);
    default: /* waiting; a loop acts whose model has not been tested */
        if (seen->acting & (uint8_t)~s->tested_loops)
            enter_state(s, GMV_TUNING);
        return 0;
    }
}

void gmv_supervise_adopt(struct gmv_supervise *s)
{
    if (s->status.state == GMV_WAITING)
        gmv_supervise_begin(s);
    s->adopt_asked = true;
}
