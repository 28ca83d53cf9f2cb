/* The operating point that limits count from: where the measurements were before anything was moved.
 *
 * Every test takes its own rest, and that may be another than the one before: the plant drifts, or a test has left
 * something behind (an integrator, a plant that runs away, a response that is not over). A drift is no doing of the tests:
 * what the fastest drift seen at a rest carries, either way, is taken off. But no more than a drift as fast as the one
 * before the first test can have done; a plant that runs away shows a slope, too. All else is kept as `left`, and comes
 * off the limit from there on. */
#ifndef REFLUX_COMMISSION_ORIGIN_H
#define REFLUX_COMMISSION_ORIGIN_H

#include "identify/steady.h"

struct origin_channel {
    real_t level;       /* at the latest rest */
    real_t slope_per_s; /* ... as far as it is a drift's */
    real_t slope_most;  /* of a drift, magnitude, by the rest before the first test */
    real_t drift_per_s; /* ... and the fastest that has been seen, magnitude */
    real_t left;        /* from the operating point, drifts apart, fraction of span, either sign */
    real_t moved;       /* ... drifts and all; for who reads it */
};

struct origin {
    bool fixed;     /* there has been a rest: the operating point */
    real_t since_s; /* from the latest rest; kept by whoever sees the samples */
    struct origin_channel channel[CHANNEL_MAX];
};

/* A look at measurement j before the first rest: a drift that is significant there may turn until then. */
void origin_look(struct origin *o, uint32_t j, const struct steady_result *rest);
/* The next rest of measurement j (below CHANNEL_MAX), since_s after the one before: the line that was fitted to it, and
 * where it is now, fraction of span. The first one is the operating point. */
void origin_take(struct origin *o, uint32_t j, const struct steady_result *rest, real_t level);
/* ... of every measurement has been taken. */
void origin_taken(struct origin *o);
/* Above 1: more than half of the limit of measurement j is left, too much for another test or a trial. */
real_t origin_spent(const struct origin *o, uint32_t j, real_t limit);
/* What of a slope is a drift's, span per second: no more than the rest before the first test has shown. */
real_t origin_drift(const struct origin *o, uint32_t j, real_t slope_per_s);
/* How far y is from the latest rest, or from the line of its drift, whichever is nearer, fraction of span. */
real_t origin_away(const struct origin *o, uint32_t j, real_t y, real_t limit);

#endif
