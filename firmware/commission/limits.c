#include "commission/limits.h"

#include "base/assertion.h"
#include "commission/experiment_state.h"
#include "commission/origin.h"

#define GUARD_NOISE REAL_C(0.05)
#define TURN_SHARE  REAL_C(0.8) /* of the room at which a half ends early */
#define DRIFT_SHARE REAL_C(1.0) /* of a limit that a drift may carry the line of rest at most */
/* Standard deviations of the noise that two samples in a row rarely exceed. */
#define TWO_SAMPLES REAL_C(2.0)
#define WATCH_SDS   REAL_C(3.0) /* the same in whole tests, of extremes that count twice */
#define HARD_NOISE  REAL_C(4.0) /* standard deviations of the noise past a limit */
#define NOISE_SHARE REAL_C(0.1) /* share of the limit that is subtracted from them */
#define AHEAD       REAL_C(2.0) /* samples until a passed limit is detected, or a move shows */
#define LINE_SDS    REAL_C(3.0) /* standard deviations of a slope that are noise */
/* Time constants after which a response has shown its wrong-way reach and its end but for a tenth. */
#define SEEN_LAGS  REAL_C(2.3)
#define ENDS_SHARE REAL_C(0.9) /* of the room, where nothing can restore the output */
#define RUNS_SHARE REAL_C(0.5) /* of the room */

static real_t left_by_tests(const struct experiment *e, uint8_t j)
{
    const struct origin *o = experiment_settings(e)->origin;
    return o ? real_abs(origin_left(o, j)) : REAL_C(0.0);
}

real_t limits_room(const struct experiment *e, uint8_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    real_t room = experiment_settings(e)->limit[j] - left_by_tests(e, j);
    return room > REAL_C(0.0) ? room : REAL_C(0.0);
}

/* Time since the rest before the step, s. */
static real_t rest_age_s(const struct experiment *e)
{
    return experiment_settings(e)->h_s * (real_t)experiment_samples(e);
}

real_t limits_away(const struct experiment *e, uint8_t j, const real_t *y)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    const struct origin *o = experiment_settings(e)->origin;
    real_t slope = o ? origin_drift(o, j, experiment_slope(e, j)) : experiment_slope(e, j);
    return steady_away(y[j] - experiment_rest(e, j), slope * rest_age_s(e),
                       DRIFT_SHARE * experiment_settings(e)->limit[j]);
}

/* Distance of output j from where drifts may have carried it since rest, however often they have turned. */
static real_t away_at_least(const struct experiment *e, uint8_t j, const real_t *y)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    const struct origin *o = experiment_settings(e)->origin;
    real_t fastest = o ? origin_fastest(o, j) : experiment_slope(e, j);
    return steady_beyond(y[j] - experiment_rest(e, j), fastest * rest_age_s(e),
                         DRIFT_SHARE * experiment_settings(e)->limit[j]);
}

int limits_spent(const struct experiment *e)
{
    int worst = -1;
    real_t most = REAL_C(1.0);
    for (uint8_t j = 0; experiment_settings(e)->origin && j < experiment_settings(e)->outputs;
         j++) {
        real_t share =
            origin_spent(experiment_settings(e)->origin, j, experiment_settings(e)->limit[j]);
        if (share > most) {
            most = share;
            worst = j;
        }
    }
    return worst;
}

enum err limits_arm(struct experiment *e, const real_t *y)
{
    const struct experiment_config *c = experiment_settings(e);
    struct guard_config g = {
        .outputs = c->outputs, .h_s = c->h_s, .blanking_s = c->blank_s, .noise_share = GUARD_NOISE};
    for (uint8_t j = 0; j < c->outputs; j++) {
        bool first = experiment_samples(e) == 0;
        real_t spent = first ? REAL_C(0.0) : real_abs(y[j] - experiment_rest(e, j));
        real_t room = limits_room(e, j) - spent, least = c->limit[j] * REAL_C(0.1);
        g.output[j].initial = first ? experiment_rest(e, j) : y[j];
        g.output[j].limit = room > least ? room : least;
        g.output[j].noise_sd = experiment_before(e, j)->noise_sd;
        g.output[j].dead_time_s = c->dead_time_s[j];
    }
    return guard_init(&experiment_guards(e)->guard, &g);
}

void limits_watch(struct experiment *e, const real_t *y)
{
    struct limits *l = experiment_guards(e);
    real_t step = experiment_amplitude(e) - l->step_from;
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++) {
        real_t now = limits_away(e, j, y) - l->from[j],
               was = limits_away(e, j, experiment_last(e)) - l->from[j];
        real_t noise = WATCH_SDS * experiment_before(e, j)->noise_sd;
        real_t high = (now < was ? now : was) - noise, low = (now > was ? now : was) + noise;
        if (high > l->high[j] * step)
            l->high[j] = high / step;
        if (low < l->low[j] * step)
            l->low[j] = low / step;
    }
}

real_t limits_first_step(const struct experiment *e)
{
    real_t a = experiment_settings(e)->amplitude_first;
    for (uint8_t j = 0;
         experiment_settings(e)->gains_unknown && j < experiment_settings(e)->outputs; j++)
        if (a > FIRST_OF_LIMIT * limits_room(e, j))
            a = FIRST_OF_LIMIT * limits_room(e, j);
    return a > experiment_settings(e)->noise_floor ? a : experiment_settings(e)->noise_floor;
}

void limits_step_grows(struct experiment *e, const real_t *y, real_t larger)
{
    struct limits *l = experiment_guards(e);
    if (!experiment_drifts(e)) {
        l->step_from = experiment_amplitude(e);
        for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++)
            l->from[j] = limits_away(e, j, y);
        return;
    }
    real_t share = experiment_amplitude(e) / larger;
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++) {
        l->high[j] *= share;
        l->low[j] *= share;
    }
}

/* Largest deviation of output j, signed, after a step of twice the amplitude the other way from `away`. */
static real_t reversed(const struct experiment *e, uint8_t j, real_t away)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    real_t up = away - REAL_C(2.0) * experiment_amplitude(e) * experiment_limits(e)->low[j];
    real_t down = away - REAL_C(2.0) * experiment_amplitude(e) * experiment_limits(e)->high[j];
    return real_abs(up) > real_abs(down) ? up : down;
}

real_t limits_reach(const struct experiment *e, uint8_t j, real_t gain)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    const struct limits *l = experiment_limits(e);
    real_t low = gain < l->low[j] ? gain : l->low[j], high = gain > l->high[j] ? gain : l->high[j];
    real_t up = real_abs(gain - REAL_C(2.0) * low), down = real_abs(gain - REAL_C(2.0) * high);
    return up > down ? up : down;
}

/* The guard of Johansson (1994): a straight line. */
static bool line_trips(struct experiment *e, const real_t *y, struct limits_peak *peak,
                       enum err *err)
{
    struct guard_prediction line;
    int trip = -1;
    *err = guard_step(&experiment_guards(e)->guard, y, &trip);
    if (*err || trip < 0 || !experiment_settings(e)->line_guard ||
        guard_predict(&experiment_guards(e)->guard, (uint32_t)trip, &line) != ERR_OK)
        return false;
    peak->output = (uint8_t)trip;
    peak->predicted = line.predicted + experiment_guards(e)->guard.config.output[trip].initial -
                      experiment_rest(e, (uint8_t)trip);
    return true;
}

/* The guard by the model: deviation when the response that dead time still hides has arrived. Whatever the model says, no
 * output may use most of its limit. */
static real_t peak_by_model(const struct experiment *e, uint8_t j, real_t away)
{
    const struct experiment_config *c = experiment_settings(e);
    const struct identified *f = experiment_found(e, j);
    if (!experiment_has_model(e) || !interim_fit_is_known(f) || !(f->time_constant_s > REAL_C(0.0)))
        return away;
    real_t sure = real_abs(f->gain) - f->gain_sd;
    real_t ends = (f->gain < REAL_C(0.0) ? -sure : sure) * experiment_amplitude(e);
    real_t waits = f->dead_time_s + AHEAD * c->h_s;
    return away + (ends - away) * (REAL_C(1.0) - real_exp(-waits / f->time_constant_s));
}

/* The latest interim fit knows gain and time constant of output j. */
static bool is_modelled(const struct experiment *e, uint8_t j)
{
    const struct identified *f = experiment_found(e, j);
    return experiment_has_model(e) && interim_fit_is_known(f) &&
           interim_fit_is_timed(f, experiment_drifts(e));
}

/* The guard where no model is known: the output goes on as fast as now for as long as the step has lasted, because dead time
 * and lags of higher order hide that much. For a first-order lag that is 1.14 times its end at most. */
static real_t peak_by_slope(const struct experiment *e, uint8_t j, real_t away)
{
    struct guard_prediction p;
    if (experiment_half_s(e) < experiment_settings(e)->blank_s ||
        guard_predict(&experiment_limits(e)->guard, j, &p) != ERR_OK)
        return away;
    real_t sure = real_abs(p.source) - LINE_SDS * p.sd;
    if (sure <= REAL_C(0.0))
        return away;
    return away + (p.source > REAL_C(0.0) ? sure : -sure);
}

bool limits_response_is_seen(const struct experiment *e)
{
    if (!experiment_has_model(e))
        return false;
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++) {
        const struct identified *f = experiment_found(e, j);
        if (f->flags & IDENTIFIED_NO_GAIN)
            continue;
        if (!is_modelled(e, j) ||
            experiment_half_s(e) < f->dead_time_s + SEEN_LAGS * f->time_constant_s)
            return false;
    }
    return true;
}

enum err limits_see(struct experiment *e, const real_t *y)
{
    int trip;
    return guard_step(&experiment_guards(e)->guard, y, &trip);
}

enum err limits_judge(struct experiment *e, const real_t *y, enum limits_verdict *verdict,
                      struct limits_peak *peak)
{
    enum err err;
    real_t share = experiment_settings(e)->line_guard ? REAL_C(1.0) : TURN_SHARE;
    *verdict = line_trips(e, y, peak, &err) ? LIMITS_TURN : LIMITS_FINE;
    if (err)
        return err;
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++) {
        real_t away = limits_away(e, j, y), room = limits_room(e, j),
               noise = experiment_before(e, j)->noise_sd;
        real_t ahead = is_modelled(e, j) ? peak_by_model(e, j, away) : peak_by_slope(e, j, away);
        real_t back = reversed(e, j, away);
        if (real_abs(back) > room + noise) {
            *peak = (struct limits_peak){.output = j, .predicted = back};
            *verdict = LIMITS_BACK;
            return ERR_OK;
        }
        if (real_abs(ahead) < real_abs(back))
            ahead = back;
        if (*verdict == LIMITS_TURN || real_abs(ahead) < share * room + noise)
            continue;
        *peak = (struct limits_peak){.output = j, .predicted = ahead};
        *verdict = LIMITS_TURN;
    }
    return ERR_OK;
}

/* Speed of output j away from its rest per sample, by the two latest points of the record; 0 where it comes nearer. */
static real_t leaving(const struct experiment *e, uint8_t j, real_t away)
{
    const struct record *r = experiment_record(e);
    if (r->points < 2u)
        return REAL_C(0.0);
    real_t way = (r->y[j][r->points - 1u] - r->y[j][r->points - 2u]) / (real_t)r->block;
    way = away > REAL_C(0.0) ? way : -way;
    real_t noise = TWO_SAMPLES * experiment_before(e, j)->noise_sd / (real_t)r->block;
    return way > noise ? way - noise : REAL_C(0.0);
}

bool limits_far_enough(const struct experiment *e, const real_t *y)
{
    const struct record *r = experiment_record(e);
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++) {
        /* The slope over half a dead time, because over a shorter time it is noise. */
        real_t apart_s = (real_t)r->block * experiment_settings(e)->h_s;
        uint32_t apart =
            (uint32_t)(experiment_settings(e)->dead_time_s[j] / (REAL_C(2.0) * apart_s)) + 1u;
        real_t slope = REAL_C(0.0);
        if (r->points > apart)
            slope = (r->y[j][r->points - 1u] - r->y[j][r->points - 1u - apart]) /
                    (apart_s * (real_t)apart);
        real_t to_come = slope * experiment_settings(e)->dead_time_s[j];
        real_t away = limits_away(e, j, y), room = limits_room(e, j);
        /* A move takes two samples to show. */
        real_t coasts = leaving(e, j, away) * AHEAD;
        /* An output that still returns from the other side comes nearer; but a drift may carry it on. */
        bool other_side = away * experiment_at_turn(e, j) > REAL_C(0.0) &&
                          experiment_waited(e) <= experiment_half(e) / 2u;
        real_t noise = REAL_C(2.0) * experiment_before(e, j)->noise_sd;
        if (other_side ? real_abs(away) > room + noise
                       : real_abs(away + to_come) + coasts > TURN_SHARE * room)
            return true;
    }
    return false;
}

/* Output j is far out although the input was reversed or released some time ago: the plant runs away. */
static bool runs(const struct experiment *e, uint8_t j, real_t away, real_t room)
{
    bool same_side =
        experiment_phase(e) == EXPERIMENT_DOWN && away * experiment_at_turn(e, j) > REAL_C(0.0);
    /* In a pause the peak of the positive half may still be to come. */
    uint32_t waits = experiment_is_pausing(e) ? 2u * experiment_half(e) : experiment_half(e) / 2u;
    return (same_side || experiment_phase(e) == EXPERIMENT_BACK) && experiment_waited(e) >= waits &&
           real_abs(away) > RUNS_SHARE * room;
}

/* Noise beyond a limit that is no excursion, where noise is large beside the room. */
static real_t noise_beyond(const struct experiment *e, uint8_t j, real_t room)
{
    real_t noise = HARD_NOISE * experiment_before(e, j)->noise_sd - NOISE_SHARE * room;
    return noise > REAL_C(0.0) ? noise : REAL_C(0.0);
}

/* This is the second sample in a row. */
static bool again(struct experiment *e, uint8_t j, bool over)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    experiment_guards(e)->over[j] = over ? (uint8_t)(experiment_guards(e)->over[j] + 1u) : 0;
    return experiment_guards(e)->over[j] >= 2;
}

int limits_strayed(struct experiment *e, const real_t *y)
{
    const struct origin *o = experiment_settings(e)->origin;
    for (uint8_t j = 0; o && origin_is_fixed(o) && j < experiment_settings(e)->outputs; j++) {
        real_t limit = experiment_settings(e)->limit[j],
               away = real_abs(origin_away(o, j, y[j], limit));
        if (again(e, j, away > ENDS_SHARE * limits_room(e, j)))
            return j;
    }
    return -1;
}

int limits_past(struct experiment *e, const real_t *y)
{
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++) {
        real_t limit = experiment_settings(e)->limit[j], room = limits_room(e, j);
        real_t from =
            experiment_phase(e) > EXPERIMENT_UP ? away_at_least(e, j, y) : limits_away(e, j, y);
        real_t away = real_abs(from);
        real_t used = (away + limit - room) / limit;
        if (used > experiment_guards(e)->worst) {
            experiment_guards(e)->worst = used;
            experiment_guards(e)->worst_output = j;
        }
        real_t most = room + noise_beyond(e, j, room);
        if (runs(e, j, from, room))
            most = ENDS_SHARE * room - AHEAD * leaving(e, j, from);
        if (again(e, j, away > most))
            return j;
    }
    return -1;
}
