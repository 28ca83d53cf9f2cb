/* Every move of the settings of a few PI loops tried at once, on one plant after the other: what the search of
 * design/robust.h looks at between two steps.
 *
 * At a frequency S = (I + G C)^-1 is found once. A move multiplies the controllers of one or two loops by 1 + r, which changes
 * I + G C by one or two columns; with T = I - S, and k the loop,
 *     S'_ii = S_ii - r T_ik S_ki/(1 + r T_kk)
 * (Sherman and Morrison, Ann. Math. Statist. 21 (1950) 124; for two loops with a 2 x 2 matrix). det(I + G C) changes by
 * 1 + r T_kk. Where that has a positive real part at all frequencies, loops that were stable stay so, because its curve
 * does not turn about the origin. Other moves are refused. */
#ifndef REFLUX_DESIGN_ROBUST_PASS_H
#define REFLUX_DESIGN_ROBUST_PASS_H

#include "design/loops.h"

/* Of up to four loops there are moves of single loops and of pairs, of more only of single ones. */
#define ROBUST_PAIRED_LOOPS 4
#define ROBUST_MOVES        80
#define ROBUST_DELAY        4000 /* samples, as NYQUIST_DELAY */

struct robust_limits {
    real_t s_most, t_most; /* largest |S_kk| and |T_kk| */
    real_t gain_least, ti_least_s, ti_most_s;
    const real_t *gain_most; /* of every loop */
};

/* The logarithms of gain and integral time of loop[0], and of loop[1] where that is not INTERACT_NONE, change by that many
 * steps. */
struct robust_move {
    uint8_t loop[2];
    int8_t gain[2], ti[2];
};

struct robust_pass {
    /* Results, over all plants since the beginning: the largest of |S_kk|/s_most and |T_kk|/t_most, squared. */
    real_t present;              /* with the settings as they are */
    real_t excess[ROBUST_MOVES]; /* after a move; infinite where it is refused */
    uint8_t moves;
    /* Largest row sum of |T_ij r_j|, r: what the controllers differ by from those of `before`. Below 1 these loops are stable where
     * those are, because det(I + G C) is 0 nowhere on the straight way from one to the other. */
    real_t away;

    /* Work: 7 KiB (float) */
    const struct loops *loops;
    const struct tuning *before; /* NULL: none */
    const uint8_t *place;
    const struct robust_limits *limits;
    real_t factor[5]; /* of -2 to 2 steps */
    real_t omega, ratio;
    struct loops_sampled sampled;
    struct cplx s[INTERACT_MAX][MATRIX_MAX]; /* G C, then S */
    uint8_t point, points;
    bool opened;
};

/* Move number 0 to robust_moves() - 1 of so many loops. */
uint8_t robust_moves(uint8_t loops);
struct robust_move robust_move(uint8_t loops, uint8_t number);
/* Makes a move of the given step, 0.01 to 1. Returns false, with the settings as they were, where one would leave its limits. */
bool robust_make_move(struct loops *loops, const struct robust_move *move, real_t step,
                      const struct robust_limits *limits);

/* loops, PI without derivative, and limits must live and stay as they are to the end of the pass; so must `before`,
 * other settings (loop k has before[place[k]]), or NULL. */
void robust_pass_begin(struct robust_pass *pass, const struct loops *loops,
                       const struct robust_limits *limits, real_t step, const struct tuning *before,
                       const uint8_t *place);
/* The next plant, checked as the loops are, at frequencies from omega_lo to omega_hi, rad/s, above 0. Then robust_pass_step
 * until it is not ERR_BUSY: half of a frequency a call, at most 2e5 instructions. */
void robust_pass_plant(struct robust_pass *pass, const struct interact_plant *plant,
                       real_t omega_lo, real_t omega_hi);
MUST_CHECK enum err robust_pass_step(struct robust_pass *pass);

#endif
