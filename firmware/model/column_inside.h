/* Functions that the files of the column share: column_evaluate.c (a column and its outputs), column_wanted.c (flows as inputs ask for
 * them), column_levels.c (holdups that move), column_flows.c (all flows), column_balances.c (rates). */
#ifndef REFLUX_MODEL_COLUMN_INSIDE_H
#define REFLUX_MODEL_COLUMN_INSIDE_H

#include "model/column.h"

/* Holdups that move count as this part of the nominal one at least, where something is divided by them. */
#define COLUMN_HOLDUP_LEAST REAL_C(1e-4)

/* All mole fractions full[C] of a stage. */
void column_full_composition(const struct column *column, const real_t *x, size_t s, real_t *full);

static inline bool column_holdups_move(const struct column *column)
{
    return COLUMN_HOLDUPS_MOVE && column->n_states > column->n_fractions;
}

/* Nominal holdup of a stage, mol or m3. */
static inline real_t column_nominal_holdup(const struct column_config *config, size_t s)
{
    return s == 0                    ? config->holdup_reboiler
           : s == config->stages - 1 ? config->holdup_condenser
                                     : config->holdup_tray;
}

/* A mole fraction, where the others leave room for it; 0 where it is no number. */
static inline real_t column_within(real_t fraction, real_t room)
{
    if (!(fraction > REAL_C(0.0)) || !(room > REAL_C(0.0)))
        return REAL_C(0.0);
    return fraction < room ? fraction : room;
}

/* Murphree efficiency of a stage at the flows as they are. */
static inline real_t column_efficiency_of(const struct column *column, size_t s)
{
    const struct column_config *config = column->config;
    if (s == 0 || s == config->stages - 1)
        return REAL_C(1.0);
    return s + 1 == config->feed_stage ? column->feed_efficiency : config->efficiency;
}

/* A liquid's flow as far as it goes down. */
static inline real_t column_downward(real_t flow)
{
    return flow > REAL_C(0.0) ? flow : REAL_C(0.0);
}

/* The lesser of value and limit (both 0 or more), rounded off where they are within the relative width. */
real_t column_soft_limit(real_t value, real_t limit, real_t width);

/* Moles in a unit of flow (mol, kg, m3) of composition x[C] at a temperature. */
real_t column_moles_per_unit(const struct column_config *config, enum column_basis basis,
                             const real_t *x, real_t temperature);

/* From inputs, compositions and temperatures: feed, reflux_wanted, boilup_wanted; condensed_by_feed before its limits.
 * Returns the internal reflux for each mole of reflux, 1 + dV_R / R. */
real_t column_wanted_flows(struct column *column, const real_t *x);

/* The feed condenses at most the vapour that meets it and flashes at most itself. */
void column_limit_feed(struct column *column, real_t vapour);

/* column->flows of drum and reboiler that rise and fall. */
void column_level_flows(struct column *column, const real_t *x);

/* liquid[] of trays whose holdup moves. */
void column_tray_flows(struct column *column, const real_t *x);

/* All flows, at temperatures and compositions that are known, and what they change of the vapours. */
void column_flows_at(struct column *column, const real_t *x);

/* The same again with perfect levels and constant holdups, but with `part` of the feed. */
void column_flows_with_feed(struct column *column, const real_t *x, real_t part);

/* Rates of all states, at flows that are known. */
void column_balances(struct column *column, const real_t *x, real_t *rates);

/* Rates of the holdups that move. */
void column_holdup_rates(const struct column *column, real_t *rates);

#endif
