#include "commission/progress.h"

#include "base/assertion.h"
#include "commission/experiment_state.h"
#include "commission/limits.h"

#define GROWTH_MOST REAL_C(4.0) /* largest growth of the amplitude in one step */
#define GROWTH_DRIFTING                                                                            \
    REAL_C(6.0) /* the same under a drift, which hides a small response for ever */
#define GROWTH_MOVING REAL_C(3.0) /* the same where an output moves that no model knows yet */
#define GROWTH_LEAST  REAL_C(1.5) /* smallest growth of a step whose response no model knows */
#define GOES_ON_SDS   REAL_C(2.0) /* standard deviations of the noise that are still to come */
#define ENOUGH_SHARE  REAL_C(0.1) /* of a limit: least response that is large enough without noise */
#define MOTION_SDS    REAL_C(3.0) /* standard deviations from which it moves */
#define LIMIT_SHARE   REAL_C(0.7) /* share of a limit at which a larger amplitude may aim */
#define HOPELESS      4u /* shortest halves without a known response before the step turns */
#define MOTION_SHARE  REAL_C(0.5) /* the same without a model */
/* Share of a limit that the wanted response uses where noise is high. */
#define NOISY_SHARE REAL_C(0.25)
#define SMALL       REAL_C(5.0) /* standard deviations of the noise below which a duration is unknown */
/* Factor for the time where a response is still too small to be known. */
#define UNKNOWN_WAITS REAL_C(1.5)

/* Noise hides responses that are small beside a limit. Then another test is better than the end of this one, which drift
 * spoils. By the measurements before the step; until then by the rest that is watched. */
bool progress_is_noisy(const struct experiment *e)
{
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++)
        if (experiment_before(e, j)->noise_sd * experiment_settings(e)->noise_multiple >
            NOISY_SHARE * experiment_settings(e)->limit[j])
            return true;
    return false;
}

/* Noise by which a response of output j counts as large enough: its own, or what makes a small share of the limit enough, because
 * resolution, friction and disturbances do not show at rest. */
static real_t least_noise(const struct experiment *e, uint8_t j)
{
    real_t noise = experiment_before(e, j)->noise_sd;
    real_t least =
        ENOUGH_SHARE * experiment_settings(e)->limit[j] / experiment_settings(e)->noise_multiple;
    return noise > least ? noise : least;
}

/* Verdict of the models on the step. */
struct progress {
    bool seen;  /* a response at all */
    bool known; /* every output that responds is */
    bool any_known;
    real_t over_s;    /* since the last edge: when every response is over but for a twentieth */
    real_t stand_out; /* largest response to the amplitude, in least_noise() */
    /* Factor by which the amplitude may grow before an output comes near its limit */
    real_t growth;
};

/* Limits the growth so that output j, which reaches `most` with the present amplitude, stays away from its limit. */
static void leave_room(const struct experiment *e, uint8_t j, real_t most, struct progress *p)
{
    if (most * p->growth > LIMIT_SHARE * limits_room(e, j))
        p->growth = LIMIT_SHARE * limits_room(e, j) / most;
}

static void look_at_models(const struct experiment *e, const real_t *y, struct progress *p)
{
    const struct experiment_config *c = experiment_settings(e);
    *p = (struct progress){.known = true, .growth = GROWTH_MOST};
    for (uint8_t j = 0; j < c->outputs; j++) {
        const struct identified *f = experiment_found(e, j);
        /* Known or not, the response will repeat, and at the reversal it is twice as large. */
        leave_room(e, j,
                   limits_reach(e, j, limits_away(e, j, y) / experiment_amplitude(e)) *
                       experiment_amplitude(e),
                   p);
        if (f->flags & IDENTIFIED_NO_GAIN)
            continue;
        p->seen = true;
        real_t ends = real_abs(f->gain) * experiment_amplitude(e);
        real_t reach = limits_reach(e, j, f->gain) + REAL_C(2.0) * f->gain_sd;
        if (!interim_fit_is_known(f) || !interim_fit_is_timed(f, experiment_drifts(e)) ||
            ends < SMALL * experiment_before(e, j)->noise_sd) {
            p->known = false;
            continue;
        }
        p->any_known = true;
        real_t over_s = identified_over_s(f);
        if (over_s > p->over_s)
            p->over_s = over_s;
        if (ends > p->stand_out * least_noise(e, j))
            p->stand_out = ends / least_noise(e, j);
        leave_room(e, j, reach * experiment_amplitude(e) + experiment_before(e, j)->noise_sd, p);
    }
}

/* Returns an amplitude for which the response exceeds the noise; the present one where there is no room. */
static real_t larger(const struct experiment *e, const struct progress *p)
{
    const struct experiment_config *c = experiment_settings(e);
    real_t want = GROWTH_MOST;
    if (p->stand_out * GROWTH_MOST > REAL_C(1.2) * c->noise_multiple)
        want = REAL_C(1.2) * c->noise_multiple / p->stand_out;
    if (want > p->growth)
        want = p->growth;
    real_t a = experiment_amplitude(e) * want;
    if (a > c->amplitude_max)
        a = c->amplitude_max;
    return a > REAL_C(1.1) * experiment_amplitude(e) ? a : experiment_amplitude(e);
}

/* Mean of output j over the points from..to of the record, deviation from the line of its drift. */
static real_t mean_of_level(const struct experiment *e, uint8_t j, uint32_t from, uint32_t to)
{
    const struct record *r = experiment_record(e);
    REFLUX_ASSERT(j < CHANNEL_MAX && from < to && to <= r->points);
    real_t sum = REAL_C(0.0);
    for (uint32_t i = from; i < to; i++) /* RECORD_POINTS at most */
        sum += r->y[j][i] - experiment_slope(e, j) * record_time(r, i);
    return sum / (real_t)(to - from);
}

/* Predicts how far output j goes while the step lasts once more as long as until now, from the means of both halves of the present level;
 * *sd: of it by the noise alone. Magnitude; a limit where there are too few points. */
static real_t motion_ahead(const struct experiment *e, uint8_t j, real_t *sd)
{
    const struct record *r = experiment_record(e);
    uint32_t edges = r->input.edges;
    uint32_t from = edges > 0 ? r->input.edge[edges - 1u].sample / r->block + 1u : 0u;
    *sd = REAL_C(0.0);
    if (r->points < from + 4u)
        return experiment_settings(e)->limit[j];
    uint32_t middle = (from + r->points) / 2u;
    real_t first = mean_of_level(e, j, from, middle),
           second = mean_of_level(e, j, middle, r->points);
    real_t samples = (real_t)(middle - from) * (real_t)r->block;
    *sd = REAL_C(4.5) * experiment_before(e, j)->noise_sd / real_sqrt(samples);
    return real_abs(second) + REAL_C(3.0) * real_abs(second - first);
}

/* Returns a larger amplitude by the largest motion so far, because no response is known after a long time. A motion counts as far
 * as it would go on for as long as the step has lasted; once there is one, the steps grow more carefully. */
static real_t larger_by_motion(const struct experiment *e)
{
    const struct experiment_config *c = experiment_settings(e);
    real_t factor = experiment_drifts(e) ? GROWTH_DRIFTING : GROWTH_MOST;
    for (uint8_t j = 0; j < c->outputs; j++) {
        real_t sd, most = motion_ahead(e, j, &sd);
        if (factor > GROWTH_MOVING && most > MOTION_SDS * sd)
            factor = GROWTH_MOVING;
        most += sd;
        real_t wanted = REAL_C(1.2) * c->noise_multiple * least_noise(e, j);
        if (wanted > MOTION_SHARE * limits_room(e, j))
            wanted = MOTION_SHARE * limits_room(e, j);
        if (most * factor > wanted)
            factor = wanted / most;
    }
    real_t a = experiment_amplitude(e) * factor;
    if (a > c->amplitude_max)
        a = c->amplitude_max;
    return a > GROWTH_LEAST * experiment_amplitude(e) ? a : experiment_amplitude(e);
}

static bool has_moved(const struct experiment *e, const real_t *y)
{
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++)
        if (real_abs(limits_away(e, j, y)) > SMALL * experiment_before(e, j)->noise_sd)
            return true;
    return false;
}

/* Advice to wait or to turn with the present amplitude. */
static struct progress_advice advise(const struct experiment *e, enum progress_verdict verdict,
                                     bool small)
{
    return (struct progress_advice){verdict, experiment_amplitude(e), small};
}

/* Samples, and `more`, before a step may grow although no model is known: twice as many once it has grown, so that dead time does not hide two
 * growths. Under a drift a longer wait would only gather more of it. */
static uint32_t growth_waits(const struct experiment *e, uint32_t more)
{
    const struct experiment_config *c = experiment_settings(e);
    bool longer = experiment_record(e)->input.edges > 1u && !experiment_drifts(e);
    uint32_t wait = (longer ? c->window : c->window / 2u) + more;
    uint32_t most = c->half_most / 4u * 3u; /* before the half ends */
    return wait < most ? wait : most;
}

/* The half has lasted so long that only a known response is worth more. */
static bool has_plenty(const struct experiment *e)
{
    const struct experiment_config *c = experiment_settings(e);
    return c->half_plenty > 0 && experiment_half(e) >= c->half_plenty &&
           experiment_half(e) >= c->half_least;
}

/* Advice without a visible response: a larger amplitude in time. */
static struct progress_advice nothing_seen(const struct experiment *e, const real_t *y, bool found)
{
    const struct experiment_config *c = experiment_settings(e);
    bool noisy = progress_is_noisy(e);
    /* With little noise a missing response may be dead time. */
    uint32_t quiet = noisy ? 0 : 3u * c->window;
    uint32_t least = found ? c->half_least + quiet : growth_waits(e, quiet / 2u);
    if (experiment_half(e) < least)
        return advise(e, PROGRESS_WAIT, experiment_is_small(e));
    real_t a = found ? experiment_amplitude(e) : larger_by_motion(e);
    if (a > experiment_amplitude(e))
        return (struct progress_advice){PROGRESS_GROW, a, false};
    bool still = experiment_half(e) < c->half_least + 6u * c->window || (!noisy && has_moved(e, y));
    still = still && !has_plenty(e);
    return advise(e, still ? PROGRESS_WAIT : PROGRESS_TURN, true);
}

/* A response is known to go on: by its fit more than a twentieth of it is still to come, beyond the noise. */
static bool response_goes_on(const struct experiment *e)
{
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++) {
        const struct identified *f = experiment_found(e, j);
        real_t gone_s = experiment_half_s(e) - f->dead_time_s;
        if ((f->flags & IDENTIFIED_NO_GAIN) || !(IDENTIFIED_OVER * f->time_constant_s > gone_s))
            continue;
        real_t share = gone_s > REAL_C(0.0) ? real_exp(-gone_s / f->time_constant_s) : REAL_C(1.0);
        real_t to_come = real_abs(f->gain) * experiment_amplitude(e) * share;
        if (to_come > GOES_ON_SDS * experiment_before(e, j)->noise_sd)
            return true;
    }
    return false;
}

struct progress_advice progress_judge(const struct experiment *e, const real_t *y)
{
    const struct experiment_config *c = experiment_settings(e);
    struct progress p;
    look_at_models(e, y, &p);
    bool small = experiment_is_small(e);
    bool found = c->amplitude > REAL_C(0.0) || p.stand_out >= c->noise_multiple ||
                 experiment_record(e)->input.edges + 3u > EXCITATION_EDGES_MAX;
    if (!p.seen)
        return nothing_seen(e, y, found);
    if (!found) {
        real_t a = p.any_known ? larger(e, &p) : larger_by_motion(e);
        small = a <= experiment_amplitude(e);
        /* Grows as soon as it is certain; a response that is still uncertain may just be small. */
        if (!small && experiment_half(e) >= c->window / 2u &&
            (p.any_known || experiment_half(e) >= growth_waits(e, 0)))
            return (struct progress_advice){PROGRESS_GROW, a, false};
        if (!small)
            return advise(e, PROGRESS_WAIT, false);
    }
    /* A gain that is not known within a third is small beside the others, or slower: it gets half as long again. */
    real_t over_s = p.known ? p.over_s : UNKNOWN_WAITS * p.over_s;
    bool over = p.any_known && (real_t)experiment_half(e) * c->h_s >= over_s &&
                experiment_half(e) >= c->half_least &&
                (experiment_drifts(e) || !response_goes_on(e));
    /* With a bent drift or noise the negative half contributes as well. */
    bool hopeless =
        experiment_drifts(e) && !p.any_known && experiment_half(e) >= HOPELESS * c->half_least;
    bool enough = has_plenty(e) && !response_goes_on(e);
    return advise(e, over || hopeless || enough ? PROGRESS_TURN : PROGRESS_WAIT, small);
}
