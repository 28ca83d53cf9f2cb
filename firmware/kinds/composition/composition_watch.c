#include "kinds/composition/composition_watch.h"

#include "base/assertion.h"
#include "kinds/composition/composition_watch_state.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* Steps of the mean about which innovations swing by the readings' noise, since noise is faster than the column. */
#define SLOW_STEPS REAL_C(20.0)
/* Innovations that are off to one side for long, as far as docs/methods/consistency.md has it: a model that is trusted has none. */
#define MEAN_MOST REAL_C(0.3)

void composition_watch_set(struct composition_watch *w, const struct block_setup *setup)
{
    const struct composition_settings *s = setup->settings;
    real_t h = setup->interval_s;
    w->weight = h < s->watch_s ? h / s->watch_s : REAL_C(1.0);
}

void composition_watch_begin(struct composition_watch *w, const struct composition_sensors *all)
{
    w->steps = 0;
    for (unsigned k = 0; k < composition_sensors_count(all); k++) {
        struct composition_means *s = &w->sensor[k];
        s->pull = s->square = s->product = s->last = ZERO;
    }
}

void composition_watch_restart(struct composition_watch *w)
{
    w->steps = 0;
}

uint32_t composition_watch_steps(const struct composition_watch *w)
{
    return w->steps;
}

/* ---- means ---- */

static real_t swing_of_noise(struct composition_means *s, real_t e, real_t weight)
{
    real_t off = e - s->slow;
    s->slow += off / SLOW_STEPS;
    s->swing += weight * (off * off - s->swing);
    return s->swing;
}

void composition_watch_step(struct composition_watch *w, struct composition_sensors *all)
{
    if (w->steps < UINT32_MAX)
        w->steps++;
    real_t first = ONE / (real_t)w->steps;
    real_t weight = first > w->weight ? first : w->weight;
    for (unsigned k = 0; k < composition_sensors_count(all); k++) {
        struct composition_means *s = &w->sensor[k];
        struct composition_innovation i;
        if (!composition_sensors_innovation(all, k, &i))
            continue;
        if (w->steps == 1)
            s->slow = i.e;
        composition_sensors_find_noise(all, k, swing_of_noise(s, i.e, weight));
        s->mean += weight * (i.e / real_sqrt(i.expected) - s->mean);
        s->pull += weight * (i.correction * REAL_C(3600.0) - s->pull);
        s->square += weight * (i.e * i.e / i.expected - s->square);
        s->product += weight * (i.e * s->last / i.expected - s->product);
        s->last = i.e;
    }
}

/* ---- numbers of inputs ---- */

unsigned composition_watch_pulling(const struct composition_watch *w,
                                   const struct composition_sensors *all, real_t most)
{
    for (unsigned k = 0; k < composition_sensors_count(all); k++)
        if (most > ZERO && real_abs(w->sensor[k].pull) > most)
            return composition_sensors_input(all, k);
    return 0;
}

unsigned composition_watch_surprising(const struct composition_watch *w,
                                      const struct composition_sensors *all, real_t most,
                                      bool to_one_side)
{
    for (unsigned k = 0; k < composition_sensors_count(all); k++)
        if (most > ZERO && (w->sensor[k].square > most ||
                            (to_one_side && real_abs(w->sensor[k].mean) > MEAN_MOST)))
            return composition_sensors_input(all, k);
    return 0;
}

/* A section: number of its sensors, the least and the largest correction. */
struct section {
    unsigned n;
    real_t least, largest;
};

static struct section section_of(const struct composition_watch *w,
                                 const struct composition_sensors *all, size_t feed_stage,
                                 bool above)
{
    struct section found = {0, ZERO, ZERO};
    for (unsigned k = 0; k < composition_sensors_count(all); k++) {
        real_t pull = w->sensor[k].pull;
        if (!composition_sensors_draws_in(all, k, feed_stage, above))
            continue;
        found.least = found.n == 0 || pull < found.least ? pull : found.least;
        found.largest = found.n == 0 || pull > found.largest ? pull : found.largest;
        found.n++;
    }
    return found;
}

/* The farthest from the mean of the others is also the farthest from the mean of all. */
static unsigned farthest(const struct composition_watch *w, const struct composition_sensors *all,
                         size_t feed_stage, bool above, unsigned n)
{
    real_t mean = ZERO, far = -ONE;
    unsigned input = 0;
    for (unsigned k = 0; k < composition_sensors_count(all); k++)
        if (composition_sensors_draws_in(all, k, feed_stage, above))
            mean += w->sensor[k].pull / (real_t)n;
    for (unsigned k = 0; k < composition_sensors_count(all); k++) {
        real_t away = real_abs(w->sensor[k].pull - mean);
        if (composition_sensors_draws_in(all, k, feed_stage, above) && away > far) {
            far = away;
            input = composition_sensors_input(all, k);
        }
    }
    return input;
}

unsigned composition_watch_odd(const struct composition_watch *w,
                               const struct composition_sensors *all, size_t feed_stage,
                               real_t most)
{
    for (unsigned above = 0; above < 2; above++) {
        struct section found = section_of(w, all, feed_stage, above != 0);
        if (found.n > 1 && found.largest - found.least > most)
            return farthest(w, all, feed_stage, above != 0, found.n);
    }
    return 0;
}

real_t composition_watch_factor(const struct composition_watch *w,
                                const struct composition_sensors *all)
{
    real_t most = REAL_C(1.0);
    for (unsigned k = 0; k < composition_sensors_count(all); k++)
        if (composition_sensors_draws(all, k) && w->sensor[k].square > most)
            most = w->sensor[k].square;
    return real_sqrt(most);
}

/* ---- for the console ---- */

real_t composition_watch_pull(const struct composition_watch *w, unsigned k)
{
    REFLUX_ASSERT(k < SENSORS_MAX);
    return w->sensor[k].pull;
}

real_t composition_watch_square(const struct composition_watch *w, unsigned k)
{
    REFLUX_ASSERT(k < SENSORS_MAX);
    return w->sensor[k].square;
}

real_t composition_watch_correlation(const struct composition_watch *w, unsigned k)
{
    REFLUX_ASSERT(k < SENSORS_MAX);
    const struct composition_means *s = &w->sensor[k];
    return s->square > 0 ? s->product / s->square : 0;
}
