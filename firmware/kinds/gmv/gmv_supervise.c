#include "kinds/gmv/gmv_supervise.h"

#include <string.h>

#include "kinds/gmv/gmv_supervise_state.h"
#include "num/real.h"

/* Least request of the law beyond a limit, and least control error, that count as pushing the wrong way; fractions of span. */
#define PUSHED   0.0004f
#define FAR_AWAY 0.01f
/* Smaller prediction errors (mean square: 0.1 % of span r.m.s.) decide nothing: at rest a standstill predicts perfectly, and a
 * model with such errors does no harm. */
#define SMALL_SQUARE 1e-6f
/* A model in use is given up when its squares are this multiple of those of a standstill: twice the errors. */
#define WORSE 4.0f
/* An upset grows above this decay; the trial is no more precise. */
#define GROWTH 1.001f
/* Time for an estimate of the wrong sign to turn back, as a multiple of the regressors' length. */
#define WRONG_REACHES 4u
/* Steps over which the information of samples is averaged. */
#define INFORMATION_MEMORY 50.0f

static void begin_window(struct gmv_supervise *s)
{
    s->left = s->config.check_steps;
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
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        gmv_burst_begin(&s->burst[i]);
        gmv_cycle_begin(&s->cycle[i]);
        gmv_record_begin(&s->record[i]);
        s->jammed[i] = 0;
    }
}

void gmv_supervise_begin(struct gmv_supervise *s)
{
    s->tested = 0;
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        s->still[i] = s->spoilt[i] = 0;
        s->status.information[i] = 1;
        s->is_quiet[i] = false;
    }
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
    if (s->left > c->check_steps)
        s->left = c->check_steps;
}

/* ---- who may learn ---- */

static enum gmv_rest reason_to_rest(struct gmv_supervise *s, const struct gmv_seen *seen,
                                    unsigned i)
{
    const struct gmv_supervise_config *c = &s->config;
    s->still[i] =
        real_abs(seen->moved[i]) >= GMV_STANDS_STILL ? 0 : s->still[i] + (s->still[i] < UINT32_MAX);
    if (!(seen->good & (1u << i)))
        s->spoilt[i] = c->reach + 1u;
    else if (s->spoilt[i])
        s->spoilt[i]--;
    if (!(seen->acting & (1u << i)))
        return GMV_RESTS_MANUAL;
    if (s->spoilt[i])
        return GMV_RESTS_READING;
    if (s->still[i] > c->reach)
        return GMV_RESTS_STILL;
    if (c->on && s->is_quiet[i])
        return GMV_RESTS_QUIET;
    return s->frozen ? GMV_RESTS_ASKED : GMV_LEARNS;
}

uint8_t gmv_supervise_look(struct gmv_supervise *s, const struct gmv_seen *seen)
{
    uint8_t learn = 0;
    for (unsigned i = 0; i < s->config.loops; i++) {
        s->status.rest[i] = (uint8_t)reason_to_rest(s, seen, i);
        if (s->status.rest[i] == GMV_LEARNS)
            learn = (uint8_t)(learn | (1u << i));
    }
    return learn;
}

/* ---- results of a step ---- */

/* With constant forgetting v a sample usually carries the information 1 - v for each parameter. */
static void watch_excitation(struct gmv_supervise *s, const struct gmv_result *result, unsigned i)
{
    float usual = (1.0f - result->forgetting[i]) * (float)result->parameters[i];
    float least = s->config.quiet * usual;
    if (s->is_quiet[i]) {
        s->is_quiet[i] = !(result->information[i] > 2 * least);
        if (!s->is_quiet[i])
            s->status.information[i] = result->information[i];
        return;
    }
    s->status.information[i] +=
        (result->information[i] - s->status.information[i]) / INFORMATION_MEMORY;
    s->is_quiet[i] = s->status.information[i] < least;
}

static void sum_up(struct gmv_supervise *s, const struct gmv_result *result)
{
    for (unsigned i = 0; i < s->config.loops; i++) {
        if (!(result->whole & (1u << i)) || s->spoilt[i])
            continue;
        s->samples[i]++;
        s->model_squares[i] += result->error[i] * result->error[i];
        s->standstill_squares[i] += result->standstill[i] * result->standstill[i];
    }
    if (result->tried) {
        s->has_outcome = true;
        s->status.outcome = result->outcome;
    }
    s->left -= s->left > 0;
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

bool gmv_supervise_gain(const struct gmv_supervise *s, unsigned i, float gain)
{
    return (s->config.negative[i] ? -gain : gain) >= s->config.gain_least;
}

static bool has_its_gains(const struct gmv_supervise *s, const struct gmv_result *result,
                          uint8_t acting)
{
    for (unsigned i = 0; i < s->config.loops; i++)
        if ((acting & (1u << i)) && !gmv_supervise_gain(s, i, result->gain[i]))
            return false;
    return true;
}

/* Returns the loop whose estimated g_ii,0 has been wrong for too long, or `loops`. The g_ii,0 in use never follow such an estimate. */
static unsigned loop_of_wrong_sign(struct gmv_supervise *s, const struct gmv_result *result,
                                   uint8_t acting)
{
    unsigned wrong = s->config.loops;
    for (unsigned i = 0; i < s->config.loops; i++) {
        bool right = gmv_supervise_gain(s, i, result->estimated[i]);
        s->wrong[i] = right || !(acting & (1u << i)) ? 0 : s->wrong[i] + 1u;
        if (s->wrong[i] > WRONG_REACHES * s->config.reach)
            wrong = i;
    }
    return wrong;
}

static enum gmv_refusal refusal_of(const struct gmv_supervise *s, const struct gmv_result *result,
                                   uint8_t acting)
{
    if (!has_its_gains(s, result, acting))
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
    s->tested = acting;
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
    s->tested = acting;
    enter_state(s, GMV_WAITING);
    return GMV_WISH_PROPOSE;
}

/* Returns whether the setpoints have settled, because the law must not take over half-way through an answer. Waits no longer than
 * a test lasts. */
static bool setpoints_rest(struct gmv_supervise *s, uint8_t acting)
{
    for (unsigned i = 0; i < s->config.loops; i++)
        if ((acting & (1u << i)) && gmv_record_rests(&s->record[i]) < s->config.reach &&
            s->overtime < s->config.check_steps) {
            s->overtime++;
            return false;
        }
    return true;
}

static uint8_t judge_tuning(struct gmv_supervise *s, const struct gmv_result *result,
                            uint8_t acting)
{
    bool whole = (result->whole & acting) == acting;
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
        s->tested = acting;
        begin_window(s);
        return GMV_WISH_CANDIDATE | GMV_WISH_TRIAL;
    }
    if (s->tested != acting) { /* other loops act: the test starts again */
        s->status.testing = false;
        return 0;
    }
    bool over = s->left == 0 && s->has_outcome && setpoints_rest(s, acting);
    return over ? judge_test(s, result, acting) : 0;
}

uint8_t gmv_supervise_accepted(struct gmv_supervise *s, bool accepted)
{
    if (s->status.state != GMV_WAITING)
        return 0;
    if (accepted)
        return take_over(s, s->tested);
    s->status.refusal = GMV_REFUSED_BY_HAND;
    enter_state(s, GMV_TUNING);
    return GMV_WISH_REFUSED;
}

/* ---- self-tuning ---- */

/* Counts a return to the PI. True: the day's last one that is allowed. */
static bool too_often(struct gmv_supervise *s)
{
    uint8_t recent = 0;
    memmove(&s->given_up_step[1], &s->given_up_step[0],
            sizeof s->given_up_step - sizeof s->given_up_step[0]);
    s->given_up_step[0] = s->steps;
    s->given_up = (uint8_t)(s->given_up + (s->given_up < GMV_TRIES_MOST));
    while (recent < s->given_up && s->steps - s->given_up_step[recent] < s->config.day_steps)
        recent++;
    return s->config.tries && recent >= s->config.tries;
}

static uint8_t give_up(struct gmv_supervise *s, enum gmv_alarm why, float value)
{
    uint8_t wish = GMV_WISH_PI | GMV_WISH_FORGET;
    s->status.alarms = (uint8_t)why;
    s->status.alarm_value = value;
    s->tested = 0;
    enter_state(s, GMV_TUNING);
    return too_often(s) ? (uint8_t)(wish | GMV_WISH_GIVE_UP) : wish;
}

/* Returns the moves of an MV that swings, r.m.s.; 0: none does. */
static float swing(struct gmv_supervise *s, const struct gmv_seen *seen)
{
    float most = 0;
    uint32_t settled = 4u * s->config.reach + 32u;
    for (unsigned i = 0; i < s->config.loops; i++)
        if ((seen->acting & (1u << i)) && gmv_burst_step(&s->burst[i], seen->setpoint[i],
                                                         seen->moved[i], s->config.burst, settled))
            most = gmv_burst_size(&s->burst[i]);
    return most;
}

/* Returns the control error of a PV that keeps swinging at rest, r.m.s.; 0: none does. */
static float cycling(struct gmv_supervise *s, const struct gmv_seen *seen,
                     const struct gmv_result *result)
{
    float most = 0;
    for (unsigned i = 0; i < s->config.loops; i++)
        if ((seen->acting & result->whole & (1u << i)) &&
            gmv_cycle_step(&s->cycle[i], seen->setpoint[i], seen->away[i], result->error[i],
                           s->config.reach + 4u))
            most = gmv_cycle_size(&s->cycle[i]);
    return most;
}

/* Finds an MV that the law pushes against a limit although its own loop has a large error and needs it the other way: for a
 * while that may be best for both loops, not for long. Returns the control error, fraction of span; 0: none. */
static float jammed_away(struct gmv_supervise *s, const struct gmv_seen *seen)
{
    float most = 0;
    for (unsigned i = 0; i < s->config.loops; i++) {
        float away = real_abs(seen->away[i]);
        float needed = s->config.negative[i] ? -seen->away[i] : seen->away[i];
        bool jammed = (seen->acting & (1u << i)) && real_abs(seen->moved[i]) < GMV_STANDS_STILL &&
                      real_abs(seen->lacked[i]) > PUSHED && away > FAR_AWAY &&
                      needed * seen->lacked[i] < 0;
        s->jammed[i] = jammed ? s->jammed[i] + 1u : 0;
        if (s->jammed[i] > 4u * s->config.reach + 32u)
            most = away;
    }
    return most;
}

/* Returns the steps after which an answer to a setpoint is over. */
static uint32_t settled_steps(const struct gmv_supervise *s)
{
    return 2u * s->config.reach + 32u;
}

static void keep_record(struct gmv_supervise *s, const struct gmv_seen *seen)
{
    for (unsigned i = 0; i < s->config.loops; i++)
        if ((seen->acting & seen->good & (1u << i)))
            gmv_record_pi(&s->record[i], seen->setpoint[i], seen->away[i], seen->moved[i],
                          settled_steps(s));
}

/* Returns by which factor the law does worse than the PI's record; 0: it does not. */
static float worse_than_pi(struct gmv_supervise *s, const struct gmv_seen *seen)
{
    float most = 0;
    for (unsigned i = 0; i < s->config.loops; i++) {
        if (!(seen->acting & seen->good & (1u << i)))
            continue;
        float times = gmv_record_law(&s->record[i], seen->setpoint[i], seen->away[i],
                                     seen->moved[i], settled_steps(s));
        most = times > most ? times : most;
    }
    return most;
}

/* Returns the g_ii,0 nearest to the wrong sign, or farthest beyond it, signed. */
static float worst_gain(const struct gmv_supervise *s, const struct gmv_result *result)
{
    unsigned worst = 0;
    for (unsigned i = 1; i < s->config.loops; i++)
        if ((s->config.negative[i] ? -result->gain[i] : result->gain[i]) <
            (s->config.negative[worst] ? -result->gain[worst] : result->gain[worst]))
            worst = i;
    return result->gain[worst];
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

static uint8_t judge_self_tuning(struct gmv_supervise *s, const struct gmv_seen *seen,
                                 const struct gmv_result *result)
{
    if (!s->config.on)
        return 0;
    if (seen->acting & (uint8_t)~s->tested) { /* a loop acts whose model has not been tested */
        enter_state(s, GMV_TUNING);
        return GMV_WISH_PI;
    }
    if (!has_its_gains(s, result, seen->acting))
        return give_up(s, GMV_ALARM_SIGN, worst_gain(s, result));
    unsigned wrong = loop_of_wrong_sign(s, result, seen->acting);
    if (wrong < s->config.loops)
        return give_up(s, GMV_ALARM_SIGN, result->estimated[wrong]);
    float moves = swing(s, seen);
    if (moves > 0)
        return give_up(s, GMV_ALARM_BURST, moves);
    float swings = cycling(s, seen, result);
    if (swings > 0)
        return give_up(s, GMV_ALARM_BURST, swings);
    float times = worse_than_pi(s, seen);
    if (times > 0)
        return give_up(s, GMV_ALARM_RECORD, times);
    float jammed = jammed_away(s, seen);
    if (jammed > 0)
        return give_up(s, GMV_ALARM_WORSE, jammed);
    if (s->elapsed == 1)
        return GMV_WISH_TRIAL;
    if (s->left || !s->has_outcome)
        return 0;
    if (!(s->status.outcome.decay <= GROWTH))
        return give_up(s, GMV_ALARM_POLES, s->status.outcome.decay);
    if (!predicts(s, seen->acting, WORSE))
        return give_up(s, GMV_ALARM_WORSE, worst_error(s));
    begin_window(s);
    return GMV_WISH_TRIAL;
}

uint8_t gmv_supervise_judge(struct gmv_supervise *s, const struct gmv_seen *seen,
                            const struct gmv_result *result)
{
    s->steps++;
    s->elapsed += s->elapsed < UINT32_MAX;
    for (unsigned i = 0; i < s->config.loops; i++)
        if ((result->whole & (1u << i)) &&
            (s->status.rest[i] == GMV_LEARNS || s->status.rest[i] == GMV_RESTS_QUIET))
            watch_excitation(s, result, i);
    sum_up(s, result);
    if (s->status.state != GMV_SELF_TUNING)
        keep_record(s, seen);
    switch (s->status.state) {
    case GMV_TUNING:
        return judge_tuning(s, result, seen->acting);
    case GMV_SELF_TUNING:
        return judge_self_tuning(s, seen, result);
    default: /* waiting; a loop acts whose model has not been tested */
        if (seen->acting & (uint8_t)~s->tested)
            enter_state(s, GMV_TUNING);
        return 0;
    }
}

/* ---- verbs ---- */

void gmv_supervise_thaw(struct gmv_supervise *s)
{
    s->frozen = false;
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        s->is_quiet[i] = false;
        s->status.information[i] = 1;
    }
}

void gmv_supervise_adopt(struct gmv_supervise *s)
{
    if (s->status.state == GMV_WAITING)
        gmv_supervise_begin(s);
    s->adopt_asked = true;
}
