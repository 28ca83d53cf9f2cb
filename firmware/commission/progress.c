#include "commission/progress.h"

#include "commission/experiment_state.h"
#include "commission/limits.h"

#define OVER         REAL_C(3.0) /* time constants after which a twentieth is left */
#define GROWTH_MOST  REAL_C(4.0) /* largest growth of the amplitude in one step */
#define LIMIT_SHARE  REAL_C(0.7) /* share of a limit at which a larger amplitude may aim */
#define HOPELESS     4u /* shortest halves without a known response before the step turns */
#define MOTION_SHARE REAL_C(0.5) /* the same without a model */
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

/* Verdict of the models on the step. */
struct progress {
    bool seen;  /* a response at all */
    bool known; /* every output that responds is */
    bool any_known;
    real_t over_s;    /* since the last edge: when every response is over but for a twentieth */
    real_t stand_out; /* largest response to the amplitude, in noise standard deviations */
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
        bool timed = f->time_constant_sd_s < REAL_C(0.5) * f->time_constant_s;
        if (!interim_fit_is_known(f) || !timed ||
            ends < SMALL * experiment_before(e, j)->noise_sd) {
            p->known = false;
            continue;
        }
        p->any_known = true;
        real_t over_s = f->dead_time_s + OVER * f->time_constant_s;
        if (over_s > p->over_s)
            p->over_s = over_s;
        if (ends > p->stand_out * experiment_before(e, j)->noise_sd)
            p->stand_out = ends / experiment_before(e, j)->noise_sd;
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

/* Returns a larger amplitude by the largest motion so far, because no response is known after a long time. */
static real_t larger_by_motion(const struct experiment *e, const real_t *y)
{
    const struct experiment_config *c = experiment_settings(e);
    real_t factor = GROWTH_MOST;
    for (uint8_t j = 0; j < c->outputs; j++) {
        real_t noise = experiment_before(e, j)->noise_sd;
        real_t reach = limits_reach(e, j, limits_away(e, j, y) / experiment_amplitude(e));
        real_t most = reach * experiment_amplitude(e) + REAL_C(3.0) * noise;
        real_t wanted = REAL_C(1.2) * c->noise_multiple * noise;
        if (wanted > MOTION_SHARE * limits_room(e, j))
            wanted = MOTION_SHARE * limits_room(e, j);
        if (most * factor > wanted)
            factor = wanted / most;
    }
    real_t a = experiment_amplitude(e) * factor;
    if (a > c->amplitude_max)
        a = c->amplitude_max;
    return a > REAL_C(1.1) * experiment_amplitude(e) ? a : experiment_amplitude(e);
}

static bool has_moved(const struct experiment *e, const real_t *y)
{
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++)
        if (real_abs(limits_away(e, j, y)) > SMALL * experiment_before(e, j)->noise_sd)
            return true;
    return false;
}

static bool drifts(const struct experiment *e)
{
    for (uint8_t j = 0; j < experiment_settings(e)->outputs; j++)
        if (real_abs(experiment_slope(e, j)) > REAL_C(0.0))
            return true;
    return false;
}

/* Advice to wait or to turn with the present amplitude. */
static struct progress_advice advise(const struct experiment *e, enum progress_verdict verdict,
                                     bool small)
{
    return (struct progress_advice){verdict, experiment_amplitude(e), small};
}

/* Advice without a visible response: a larger amplitude in time. */
static struct progress_advice nothing_seen(const struct experiment *e, const real_t *y, bool found)
{
    const struct experiment_config *c = experiment_settings(e);
    bool noisy = progress_is_noisy(e);
    /* With little noise a missing response may be dead time. */
    uint32_t quiet = noisy ? 0 : 3u * c->window;
    if (experiment_half(e) < c->half_least + quiet)
        return advise(e, PROGRESS_WAIT, experiment_is_small(e));
    real_t a = found ? experiment_amplitude(e) : larger_by_motion(e, y);
    if (a > experiment_amplitude(e))
        return (struct progress_advice){PROGRESS_GROW, a, false};
    bool still = experiment_half(e) < c->half_least + 6u * c->window || (!noisy && has_moved(e, y));
    return advise(e, still ? PROGRESS_WAIT : PROGRESS_TURN, true);
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
        real_t a = p.any_known ? larger(e, &p) : larger_by_motion(e, y);
        small = a <= experiment_amplitude(e);
        /* Grows as soon as it is certain; a response that is still uncertain may just be small. */
        if (!small && experiment_half(e) >= c->window / 2u &&
            (p.any_known || experiment_half(e) >= c->window))
            return (struct progress_advice){PROGRESS_GROW, a, false};
        if (!small)
            return advise(e, PROGRESS_WAIT, false);
    }
    /* A gain that is not known within a third is small beside the others, or slower: it gets half as long again. */
    real_t over_s = p.known ? p.over_s : UNKNOWN_WAITS * p.over_s;
    bool over = p.any_known && (real_t)experiment_half(e) * c->h_s >= over_s &&
                experiment_half(e) >= c->half_least;
    /* With a bent drift or noise the negative half contributes as well. */
    bool hopeless = drifts(e) && !p.any_known && experiment_half(e) >= HOPELESS * c->half_least;
    return advise(e, over || hopeless ? PROGRESS_TURN : PROGRESS_WAIT, small);
}
