/* A column as an estimator runs it: with stages whose temperatures are interpolated, and one step of fixed cost that is
 * stable however stiff the column, drawn towards measured temperatures.
 *
 * Step (linearly implicit Euler) from x over h, flows, holdups and activity coefficients held:
 *
 *     (I - h J) d = h (f + p),   x <- x + d
 *
 * f, J: rates of the column and their derivatives; p: what draws it. J is full below its diagonal where the efficiency is below 1,
 * since a vapour remembers all stages under it. With the vapours' changes w_s = (1 - E) w_(s-1) + E Y_s d_s as unknowns beside d_s
 * each stage has to do with its neighbours alone, and blocks are eliminated from the reboiler up: time and memory are linear
 * in the number of stages. */
#ifndef REFLUX_MODEL_COLUMN_IMPLICIT_H
#define REFLUX_MODEL_COLUMN_IMPLICIT_H

#include "model/column.h"

/* A pull on the column at one stage: the rate of one mole fraction there gets
 *
 *     (gain (e - sum_j b_j d_j) + rate) / b_component,   b_j = dT/dx_j
 *
 * which moves the bubble point by that rate, K/s; the sum is what the step itself takes off the deviation. Frau (7.1a). */
struct column_pull {
    /* from 0; a stage that is not truncated, a component that is not the closing one */
    size_t stage, component;
    real_t deviation; /* e, K: temperature measured less temperature[stage] */
    real_t gain;      /* 1/s */
    real_t rate;      /* K/s */
};

/* Numbers of a step for its way back down. */
struct column_blocks {
    real_t ratio[COLUMN_STAGES_MAX * (COLUMN_COMPONENTS_MAX - 1) * (COLUMN_COMPONENTS_MAX - 1)];
    real_t change[COLUMN_STATES_MAX];
};

/* Temperature of a truncated stage from those of the two nearest stages that are not. */
enum column_between {
    COLUMN_BETWEEN_LINE, /* on the straight line between them */
    COLUMN_BETWEEN_MEAN  /* their mean, Frau (6.3): vapour pressures once a region */
};

/* Outputs and rates[n_fractions] at the states x, as column_rates (column.h), where truncated[s] is set for stages whose temperature
 * is interpolated. Their last but one mole fraction follows from the bubble point (6.4), kept within what the others leave, and is
 * written to x. Neither the reboiler nor the condenser is truncated, nor the feed stage.
 * The config has constant holdups, perfect levels, and with truncated stages an ideal liquid. Errors as column_evaluate. */
MUST_CHECK enum err column_truncated_rates(struct column *column, const bool *truncated,
                                           enum column_between between, real_t *x, real_t *rates);

/* One step of h > 0, s, from the very x and rates of the last column_truncated_rates. change[n_fractions] of *blocks is d; x stays.
 * pull[pulls], at most one at a stage. ERR_RANGE where the equations have no solution, ERR_NOT_FINITE where it is none. */
MUST_CHECK enum err column_implicit_step(const struct column *column, const bool *truncated,
                                         const real_t *x, const real_t *rates, real_t h,
                                         const struct column_pull *pull, size_t pulls,
                                         struct column_blocks *blocks);

/* x + d, each mole fraction within what the others leave. Returns how many were not: their d becomes what they moved. */
size_t column_move(const struct column *column, real_t *x, real_t *change);

#endif
