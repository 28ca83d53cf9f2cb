#include "exchange/config.h"

#include "commission/limits.h"

#define GUARD_NOISE REAL_C(0.05)
#define TURN_SHARE  REAL_C(0.8) /* of the room at which a half ends early */
#define DRIFT_SHARE REAL_C(1.0) /* of a limit that a drift may carry the line of rest at most */
/* Standard deviations of the noise that two samples in a row rarely exceed. */
#define TWO_SAMPLES REAL_C(2.0)
#define HARD_NOISE  REAL_C(4.0) /* noise standard deviations past a limit ... */
#define NOISE_SHARE REAL_C(0.1) /* ... of which this share of it is not noise's */
#define AHEAD       REAL_C(2.0) /* samples that go by before a limit is known to be passed */
#define ENDS_SHARE  REAL_C(0.9) /* of the room, where nothing is left to be restored */
#define RUNS_SHARE  REAL_C(0.5) /* of the room */

static real_t left_by_tests(const struct experiment *e, uint8_t j)
{
    const struct origin *o = e->config.origin;
    return o ? real_abs(origin_left(o, j)) : REAL_C(0.0);
}

real_t limits_room(const struct experiment *e, uint8_t j)
{
    real_t room = e->config.limit[j] - left_by_tests(e, j);
    return room > REAL_C(0.0) ? room : REAL_C(0.0);
}

/* Distance of output j from the line of its drift; `way` -1: from the line of a drift that has reversed. */
static real_t away_along(const struct experiment *e, uint8_t j, const real_t *y, real_t way)
{
    real_t slope = e->drift_per_s[j];
    if (e->config.origin)
        slope = origin_drift(e->config.origin, j, slope);
    real_t carried = way * slope * e->config.h_s * (real_t)e->samples;
    return steady_away(y[j] - e->rest[j], carried, DRIFT_SHARE * e->config.limit[j]);
}

real_t limits_away(const struct experiment *e, uint8_t j, const real_t *y)
{
    return away_along(e, j, y, REAL_C(1.0));
}

int limits_spent(const struct experiment *e)
{
    int worst = -1;
    real_t most = REAL_C(1.0);
    for (uint8_t j = 0; e->config.origin && j < e->config.outputs; j++) {
        real_t share = origin_spent(e->config.origin, j, e->config.limit[j]);
        if (share > most) {
            most = share;
            worst = j;
        }
    }
    return worst;
}

enum err limits_arm(struct experiment *e, const real_t *y)
{
    const struct experiment_config *c = &e->config;
    struct guard_config g = {
        .outputs = c->outputs, .h_s = c->h_s, .blanking_s = c->blank_s, .noise_share = GUARD_NOISE};
    for (uint8_t j = 0; j < c->outputs; j++) {
        bool first = e->samples == 0;
        real_t spent = first ? REAL_C(0.0) : real_abs(y[j] - e->rest[j]);
        real_t room = limits_room(e, j) - spent, least = c->limit[j] * REAL_C(0.1);
        g.output[j].initial = first ? e->rest[j] : y[j];
        g.output[j].limit = room > least ? room : least;
        g.output[j].noise_sd = e->before[j].noise_sd;
        g.output[j].dead_time_s = c->dead_time_s[j];
    }
    return guard_init(&e->guard, &g);
}

void limits_watch(struct experiment *e, const real_t *y)
{
    for (uint8_t j = 0; j < e->config.outputs; j++) {
        real_t now = limits_away(e, j, y), was = limits_away(e, j, e->last);
        real_t noise = TWO_SAMPLES * e->before[j].noise_sd;
        real_t high = (now < was ? now : was) - noise, low = (now > was ? now : was) + noise;
        if (high > e->high[j] * e->amplitude)
            e->high[j] = high / e->amplitude;
        if (low < e->low[j] * e->amplitude)
            e->low[j] = low / e->amplitude;
    }
}

/* Largest deviation of output j, signed, after a step of twice the amplitude the other way from `away`. */
static real_t reversed(const struct experiment *e, uint8_t j, real_t away)
{
    real_t up = away - REAL_C(2.0) * e->amplitude * e->low[j];
    real_t down = away - REAL_C(2.0) * e->amplitude * e->high[j];
    return real_abs(up) > real_abs(down) ? up : down;
}

real_t limits_reach(const struct experiment *e, uint8_t j, real_t gain)
{
    real_t low = gain < e->low[j] ? gain : e->low[j], high = gain > e->high[j] ? gain : e->high[j];
    real_t up = real_abs(gain - REAL_C(2.0) * low), down = real_abs(gain - REAL_C(2.0) * high);
    return up > down ? up : down;
}

/* The guard of Johansson (1994): a straight line. */
static bool line_trips(struct experiment *e, const real_t *y, enum err *err)
{
    struct guard_prediction peak;
    int trip = -1;
    *err = guard_step(&e->guard, y, &trip);
    if (*err || trip < 0 || !e->config.line_guard ||
        guard_predict(&e->guard, (uint32_t)trip, &peak) != ERR_OK)
        return false;
    e->culprit = (uint8_t)trip;
    e->predicted = peak.predicted + e->guard.config.output[trip].initial - e->rest[trip];
    return true;
}

/* The guard by the model: deviation when the response that dead time still hides has arrived. Whatever the model says, no
 * output may use most of its limit. */
static real_t peak_by_model(const struct experiment *e, uint8_t j, real_t away)
{
    const struct experiment_config *c = &e->config;
    const struct identified *f = &e->interim_fit.found[j];
    if (!e->interim_fitted || !interim_fit_is_known(f) || !(f->time_constant_s > REAL_C(0.0)))
        return away;
    real_t sure = real_abs(f->gain) - f->gain_sd;
    real_t ends = (f->gain < REAL_C(0.0) ? -sure : sure) * e->amplitude;
    real_t waits = f->dead_time_s + REAL_C(2.0) * c->h_s;
    return away + (ends - away) * (REAL_C(1.0) - real_exp(-waits / f->time_constant_s));
}

enum err limits_judge(struct experiment *e, const real_t *y, enum limits_verdict *verdict)
{
    enum err err;
    real_t share = e->config.line_guard ? REAL_C(1.0) : TURN_SHARE;
    *verdict = line_trips(e, y, &err) ? LIMITS_TURN : LIMITS_FINE;
    if (err)
        return err;
    for (uint8_t j = 0; j < e->config.outputs; j++) {
        real_t away = limits_away(e, j, y), room = limits_room(e, j), noise = e->before[j].noise_sd;
        real_t peak = peak_by_model(e, j, away), back = reversed(e, j, away);
        if (real_abs(back) > room + noise) {
            e->culprit = j;
            e->predicted = back;
            *verdict = LIMITS_BACK;
            return ERR_OK;
        }
        if (real_abs(peak) < real_abs(back))
            peak = back;
        if (*verdict == LIMITS_TURN || real_abs(peak) < share * room + noise)
            continue;
        e->culprit = j;
        e->predicted = peak;
        *verdict = LIMITS_TURN;
    }
    return ERR_OK;
}

bool limits_far_enough(const struct experiment *e, const real_t *y)
{
    const struct record *r = &e->record;
    for (uint8_t j = 0; j < e->config.outputs; j++) {
        /* The slope over half a dead time, because over a shorter time it is noise. */
        real_t apart_s = (real_t)r->block * e->config.h_s;
        uint32_t apart = (uint32_t)(e->config.dead_time_s[j] / (REAL_C(2.0) * apart_s)) + 1u;
        real_t slope = REAL_C(0.0);
        if (r->points > apart)
            slope = (r->y[j][r->points - 1u] - r->y[j][r->points - 1u - apart]) /
                    (apart_s * (real_t)apart);
        real_t to_come = slope * e->config.dead_time_s[j];
        real_t away = limits_away(e, j, y), room = limits_room(e, j);
        /* An output that still returns from the other side comes nearer; but a drift may carry it on. */
        bool other_side = away * e->at_turn[j] > REAL_C(0.0) && e->waited <= e->half / 2u;
        real_t noise = REAL_C(2.0) * e->before[j].noise_sd;
        if (other_side ? real_abs(away) > room + noise
                       : real_abs(away + to_come) > TURN_SHARE * room)
            return true;
    }
    return false;
}

/* Output j is far out although the input was reversed or released some time ago: the plant runs away. */
static bool runs(const struct experiment *e, uint8_t j, real_t away, real_t room)
{
    bool same_side = e->phase == EXPERIMENT_DOWN && away * e->at_turn[j] > REAL_C(0.0);
    return (same_side || e->phase == EXPERIMENT_BACK) && e->waited >= e->half / 2u &&
           real_abs(away) > RUNS_SHARE * room;
}

/* Speed of output j away from its rest per sample, by the two latest points of the record; 0 where it comes nearer. */
static real_t leaving(const struct experiment *e, uint8_t j, real_t away)
{
    const struct record *r = &e->record;
    if (r->points < 2u)
        return REAL_C(0.0);
    real_t way = (r->y[j][r->points - 1u] - r->y[j][r->points - 2u]) / (real_t)r->block;
    way = away > REAL_C(0.0) ? way : -way;
    real_t noise = TWO_SAMPLES * e->before[j].noise_sd / (real_t)r->block;
    return way > noise ? way - noise : REAL_C(0.0);
}

/* Noise beyond a limit that is no excursion, where noise is large beside the room. */
static real_t noise_beyond(const struct experiment *e, uint8_t j, real_t room)
{
    real_t noise = HARD_NOISE * e->before[j].noise_sd - NOISE_SHARE * room;
    return noise > REAL_C(0.0) ? noise : REAL_C(0.0);
}

/* This is the second sample in a row. */
static bool again(struct experiment *e, uint8_t j, bool over)
{
    e->over[j] = over ? (uint8_t)(e->over[j] + 1u) : 0;
    return e->over[j] >= 2;
}

int limits_strayed(struct experiment *e, const real_t *y)
{
    const struct origin *o = e->config.origin;
    for (uint8_t j = 0; o && origin_is_fixed(o) && j < e->config.outputs; j++) {
        real_t limit = e->config.limit[j], away = real_abs(origin_away(o, j, y[j], limit));
        if (again(e, j, away > ENDS_SHARE * limits_room(e, j)))
            return j;
    }
    return -1;
}

int limits_past(struct experiment *e, const real_t *y)
{
    for (uint8_t j = 0; j < e->config.outputs; j++) {
        real_t limit = e->config.limit[j], room = limits_room(e, j);
        real_t from = limits_away(e, j, y);
        if (e->phase > EXPERIMENT_UP) { /* meanwhile it may have turned */
            real_t turned = away_along(e, j, y, REAL_C(-1.0));
            from = real_abs(turned) < real_abs(from) ? turned : from;
        }
        real_t away = real_abs(from);
        real_t used = (away + limit - room) / limit;
        if (used > e->worst) {
            e->worst = used;
            e->worst_output = j;
        }
        real_t most = room + noise_beyond(e, j, room);
        if (runs(e, j, from, room))
            most = ENDS_SHARE * room - AHEAD * leaving(e, j, from);
        if (again(e, j, away > most))
            return j;
    }
    return -1;
}
