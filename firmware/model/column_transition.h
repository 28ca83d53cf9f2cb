/* Deviations of a column's mole fractions over one step of column_implicit.h: v <- Phi v with
 *
 *     Phi = (I - h J)^-1
 *
 * J as there: flows, holdups and activity coefficients held, the vapours' memory of all stages under them included. The matrix is
 * never made, only its factors, stage by stage. With w_s the change of the vapour leaving stage s, elimination from the condenser
 * down leaves two sweeps,
 *
 *     s = N-1 .. 0:   r_s = P_s (v_s + l_s r_(s+1))                                 r_N = 0
 *     s = 0 .. N-1:   d_s = r_s + T_s w_(s-1),   w_s = keep_s w_(s-1) + G_s d_s     w_(-1) = 0
 *
 * and d is Phi v: about 4 m^2 multiplications a stage, and a covariance can be carried through them as well (kinds/composition/). Ours. */
#ifndef REFLUX_MODEL_COLUMN_TRANSITION_H
#define REFLUX_MODEL_COLUMN_TRANSITION_H

#include "model/column.h"

/* The factors; numbers belong to the caller. */
struct column_transition {
    size_t stages, m; /* m: mole fractions of a stage, C - 1 */
    /* [stages * column_transition_stride(m)]: P, T, G of a stage (m x m, row by row), then l and keep */
    real_t *factors;
};

static inline size_t column_transition_stride(size_t m)
{
    return 3 * m * m + 2;
}

/* From the very x of the last column_rates or column_truncated_rates, no stage truncated, holdups constant. h > 0, s.
 * t->factors is given; the rest is written. ERR_RANGE where the equations have no solution, or none in numbers of this size. */
MUST_CHECK enum err column_transition_make(const struct column *column, const real_t *x, real_t h,
                                           struct column_transition *t);

/* v <- Phi v, in place, v[stages m]. Of v = h rates it makes what column_implicit_step does without pulls, to rounding. */
void column_transition_apply(const struct column_transition *t, real_t *v);

/* slope[n]: d(rates)/d(mole fraction j of the feed), j < m, the closing one giving way, at the molar flow that the feed has.
 * Where its flow is given by mass or volume, that changes as well: column_feed_moles_slope times column_feed_flow_slope comes on
 * top. x and column as for column_transition_make. */
void column_feed_slopes(const struct column *column, const real_t *x, size_t j, real_t *slope);

/* d ln(molar flow of the feed) / d(its mole fraction j), at the flow that is given. 0 where moles are given. */
real_t column_feed_moles_slope(const struct column *column, size_t j);

/* slope[n]: d(rates)/d ln(flow of the feed). By what moves: the feed itself, its quality's part of the vapour or what a cold feed
 * condenses, and the products. Half a difference over COLUMN_FLOW_PART up and down, with the limits of struct column_flows: where one
 * sets in within that, it is the mean over it. work[n]: space. The column is as it was afterwards. Twice the time of
 * column_rates_again and a third. */
#define COLUMN_FLOW_PART REAL_C(0.015625)
void column_feed_flow_slope(struct column *column, const real_t *x, real_t *slope, real_t *work);

#endif
