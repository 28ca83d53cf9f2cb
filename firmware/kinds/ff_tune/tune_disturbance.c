#include "kinds/ff_tune/tune_disturbance.h"

#include "kinds/ff_tune/tune_disturbance_state.h"

/* A disturbance rests when less than this part of its squares is left. */
#define AT_REST REAL_C(0.1)
/* Parts of `learn`: the time over which the disturbance is averaged; the time for which larger moves are remembered. */
#define AVERAGED   0.125f
#define REMEMBERED 4.0f
/* r.m.s. of a signal that stands still: fraction of span. */
#define STILL REAL_C(5e-4)

bool tune_stands_still(real_t square)
{
    return !(square > STILL * STILL);
}

void tune_disturbance_begin(struct tune_disturbance *d)
{
    d->square = d->most = d->learnt = d->noise = REAL_C(0.0);
    d->still = 1;
}

static real_t larger_square(real_t a, real_t b)
{
    return a > b ? a : b;
}

void tune_disturbance_look(struct tune_disturbance *d, const struct tune_context *c, real_t x)
{
    d->square += (x * x - d->square) / (real_t)tune_samples_in(c, AVERAGED * c->s.learn_s);
    d->most -= d->most / (real_t)tune_samples_in(c, REMEMBERED * c->s.learn_s);
    d->most = larger_square(d->most, d->square);
    bool rests =
        tune_stands_still(d->square) || d->square < AT_REST * larger_square(d->learnt, d->most);
    d->still = rests ? d->still + (d->still < UINT32_MAX) : 0;
    /* After so long the filters have forgotten what moved before. */
    if (d->still > tune_samples_in(c, c->s.learn_s))
        d->noise = d->square * (real_t)c->ticks;
}

void tune_disturbance_learnt(struct tune_disturbance *d, real_t square)
{
    d->learnt = square;
}

uint32_t tune_disturbance_still(const struct tune_disturbance *d)
{
    return d->still;
}

real_t tune_disturbance_square(const struct tune_disturbance *d)
{
    return d->square;
}

real_t tune_disturbance_noise(const struct tune_disturbance *d)
{
    return d->noise;
}
