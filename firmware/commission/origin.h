/* The operating point from which limits count: the measurements before anything was moved. Tick.
 *
 * Every test starts from its own rest. It may differ from the one before because the plant drifts, or because a test has left a
 * deviation (an integrator, a plant that runs away, a response that is not over). The tests do not cause drift, so the distance that
 * the fastest drift seen at a rest explains, either way, is taken off; but no drift counts as faster than the one before the first
 * test, because a plant that runs away shows a slope, too. The rest of the deviation is kept as `left` and reduces the limit. */
#ifndef REFLUX_COMMISSION_ORIGIN_H
#define REFLUX_COMMISSION_ORIGIN_H

#include "identify/steady.h"

struct origin;

/* Looks at measurement j before the first rest: a drift that is significant there may turn until then. */
void origin_look(struct origin *o, uint32_t j, const struct steady_result *rest);
/* Takes the next rest of measurement j (below CHANNEL_MAX): the line that was fitted to it, and its level at this moment,
 * fraction of span. The first one is the operating point. */
void origin_take(struct origin *o, uint32_t j, const struct steady_result *rest, real_t level);
/* The rests of all measurements have been taken. */
void origin_taken(struct origin *o);
/* The latest rest becomes so much older; whoever sees the samples calls it. */
void origin_grow_older(struct origin *o, real_t seconds);

/* The operating point is known. */
bool origin_is_fixed(const struct origin *o);
/* Deviation of measurement j from the operating point at its latest rest, fraction of span: without what drifts explain, and
 * with it. */
real_t origin_left(const struct origin *o, uint32_t j);
real_t origin_moved(const struct origin *o, uint32_t j);
/* Above 1: more than half of the limit of measurement j is left, too much for another test or a trial. */
real_t origin_spent(const struct origin *o, uint32_t j, real_t limit);
/* The part of a slope that may be a drift, span per second: no more than the rest before the first test has shown. */
real_t origin_drift(const struct origin *o, uint32_t j, real_t slope_per_s);
/* The fastest drift of measurement j that a rest has shown, magnitude, span per second. */
real_t origin_fastest(const struct origin *o, uint32_t j);
/* Distance of y from where that drift, turning at any time, may have carried it since the latest rest (by `limit` at most), fraction of
 * span, signed; 0 within. */
real_t origin_away(const struct origin *o, uint32_t j, real_t y, real_t limit);

/* An output drifted before the first test, beyond its noise; later slopes may be the ends of slow responses. */
bool origin_drifts(const struct origin *o);

#endif
