#include "commission/sensor_watch.h"

#define SENSOR_SAMPLES 60000u
#define COARSE         REAL_C(9e-4) /* of span: smallest step that is reported */
#define CHANGES_LEAST  8u           /* changes before anything is said */
/* Share of the samples that repeat the one before, in eighths, from which steps are larger than the noise. */
#define REPEATS_EIGHTHS 2u
/* A sensor is renewed rarely where its largest change exceeds this many times the smallest, because noise is no multiple of a step. */
#define NOT_STEPS REAL_C(3.0)
#define BEYOND_SHARE                                                                               \
    4u /* at most one run in four is longer than the shortest, because two values were equal */
/* A sensor reads in steps where at least EQUAL_LEAST changes, and one in EQUAL_SHARE of all, equal the smallest but for rounding. The
 * changes of a response that bends are not equal. */
#define EQUAL_LEAST   3u
#define EQUAL_SHARE   4u
#define SAME_STEP     REAL_C(0.02)
#define EQUAL_CHANGES REAL_C(0.1) /* of the smallest change: zero but for rounding */

void sensor_watch_step(struct sensor_watch *w, real_t y)
{
    real_t change = real_abs(y - w->last);
    bool first = !w->seen;
    w->last = y;
    w->seen = true;
    if (first || w->samples >= SENSOR_SAMPLES)
        return;
    w->samples++;
    if (!(change > EQUAL_CHANGES * REAL_C(1e-5))) {
        w->repeats++;
        w->run = w->run < UINT8_MAX ? (uint8_t)(w->run + 1u) : UINT8_MAX;
        return;
    }
    if (w->least > REAL_C(0.0)) { /* the first run began before the watch */
        uint8_t ticks = w->run < UINT8_MAX ? (uint8_t)(w->run + 1u) : UINT8_MAX;
        if (w->shortest == 0 || ticks < w->shortest) {
            w->shortest = ticks;
            w->runs_beyond = 0;
        } else if (ticks > w->shortest && w->runs_beyond < UINT8_MAX) {
            w->runs_beyond++;
        }
    }
    if (!(w->least > REAL_C(0.0)) || change < (REAL_C(1.0) - SAME_STEP) * w->least) {
        w->least = change;
        w->equal = 0;
    }
    if (change < (REAL_C(1.0) + SAME_STEP) * w->least)
        w->equal++;
    if (change > w->most)
        w->most = change;
    w->run = 0;
}

static uint32_t changes_of(const struct sensor_watch *w)
{
    return (uint32_t)w->samples - w->repeats;
}

real_t sensor_watch_coarse(const struct sensor_watch *w)
{
    bool repeats = 8u * (uint32_t)w->repeats >= REPEATS_EIGHTHS * w->samples;
    bool equal = w->equal >= EQUAL_LEAST && EQUAL_SHARE * w->equal >= changes_of(w);
    if (!equal || !repeats || sensor_watch_renewal(w) > 1u)
        return REAL_C(0.0);
    return w->least >= COARSE ? w->least : REAL_C(0.0);
}

unsigned sensor_watch_renewal(const struct sensor_watch *w)
{
    uint32_t changes = changes_of(w);
    if (changes < CHANGES_LEAST || w->shortest < 2u || !(w->most > NOT_STEPS * w->least) ||
        BEYOND_SHARE * w->runs_beyond > changes)
        return 1u;
    return w->shortest;
}

void sensor_watch_note(struct sensor_watch *w)
{
    unsigned renewal = sensor_watch_renewal(w); /* of uint8_t */
    if (renewal > w->noted)
        w->noted = (uint8_t)renewal;
}

unsigned sensor_watch_noted(const struct sensor_watch *w)
{
    unsigned renewal = sensor_watch_renewal(w);
    return renewal > w->noted ? renewal : w->noted;
}

void sensor_allow(struct steady_result *at, unsigned renewal, real_t coarse_sd,
                  real_t variance_limit)
{
    if (renewal > 1u) {
        real_t repeats = (real_t)renewal;
        at->noise_sd *= real_sqrt(repeats);
        at->variance_ratio /= repeats * repeats;
        if (at->state == STEADY_RESTLESS && at->variance_ratio <= variance_limit)
            at->state = STEADY_SETTLED;
    }
    if (at->noise_sd < coarse_sd)
        at->noise_sd = coarse_sd;
}
