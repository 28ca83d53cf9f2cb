/* The kind `derived`: channels that are computed from other channels. Each point of the block is one channel, of one of these forms:
 *
 *     sum     y = zero + S/d                 difference, pressure drop, scaled or corrected reading, ratio, flooding
 *     mean    y = zero + S/W                 of the inputs that are usable; W is the sum of their weights
 *     rate    y = dS/dt                      rate of rise, or the flow of a counter
 *     total   y = integral of zero + S       volume drawn since the last `reset`; of a counter, what it has counted since
 *     boil    y = zero + S - dT(p)           temperature as it would be at the pressure `at`
 *
 * S is the sum of weight x input, in EU of the inputs. Inputs are measurements or MVs, from the link or from the board's pins alike.
 *
 *     d       1, or with `by`: (input `by` / at)^power, at least 0.1^power. A pressure drop by the square of the boil-up is the same
 *             at all loads until the column floods: Kister, Distillation Design, 1992, ch. 8 (unverified).
 *     ahead   y + ahead x (rate of rise of y, behind a lag), for a guard that looks ahead
 *     dT(p)   slope at L/(1 - bend L), L = ln(p/at), p being input `by`. It is exact for a pure substance by Antoine's equation,
 *             ln p = A - B/(C + T), where bend = 1/(A - ln at) and slope = B bend^2/at: T(p) - T(at) with C cancelled out. For mixtures
 *             tests/reference/derived_reference.py has what it misses. L is within +-0.41, two thirds to one and a half times the pressure.
 *
 * Quality: a point is never better than the worst input that it uses. A mean leaves out inputs that are not usable as long as `least` of
 * them are, and is uncertain then. A total is bad until its first reset, because a number that begins at an unknown moment is none. It is
 * uncertain from the first stretch of flow that it missed, and until the next reset: a stretch of more than 10 s, and of more than one and a
 * half base ticks, without a usable flow or without a sample, or an absence of the plant. A counter (`wrap`) counts on while readings are
 * lost, so that nothing is missed then. If it goes back by less than half of `wrap`, it has been put back, and what it counted is unknown.
 *
 * Computed in real_t, from fractions of span. Error of a sum: 2^-19 of the sum of the sizes of its terms, and one step of num_t.
 * A total has more bits than a float (struct derived_total), so that it does not lose small increments.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_DERIVED_DERIVED_H
#define REFLUX_DERIVED_DERIVED_H

#include "block/block.h"

#if CONFIG_BLOCKS

#define DERIVED_POINTS 6
#define DERIVED_INPUTS 8

enum derived_form { DERIVED_SUM, DERIVED_MEAN, DERIVED_RATE, DERIVED_TOTAL, DERIVED_BOIL };
enum derived_per { DERIVED_PER_S, DERIVED_PER_MIN, DERIVED_PER_H };

/* Row k of an array belongs to point k. */
struct derived_settings {
    float weight[DERIVED_POINTS][DERIVED_INPUTS];
    float zero[DERIVED_POINTS];      /* EU of the point */
    float reference[DERIVED_POINTS]; /* `at`, EU of the input `by`; above 0 where it is used */
    float ahead_s[DERIVED_POINTS];   /* s; 0: none */
    float lag_s[DERIVED_POINTS];     /* s, of a rate and of a rate of rise */
    float wrap[DERIVED_POINTS];      /* value at which the input, a counter, begins anew; 0: none */
    float cut[DERIVED_POINTS];       /* flows of a smaller size do not count in a total */
    float slope[DERIVED_POINTS];     /* K per EU of the pressure */
    float bend[DERIVED_POINTS];
    uint16_t by[DERIVED_POINTS]; /* number of the input; 0: none */
    uint16_t power[DERIVED_POINTS];
    uint16_t least[DERIVED_POINTS]; /* inputs of a mean that must be usable; 0: all */
    uint8_t form[DERIVED_POINTS];   /* enum derived_form */
    uint8_t per[DERIVED_POINTS];    /* enum derived_per */
};

extern const struct block_kind derived_kind;

#endif
#endif
