/* The column's model as the estimator moves it: mole fractions, what is found of the feed, and the linear model of METHOD_KALMAN. For
 * this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_MODEL_H
#define REFLUX_COMPOSITION_COMPOSITION_MODEL_H

#include "kinds/column/column.h"
#include "kinds/composition/composition_settings.h"
#include "model/column_drive.h"
#include "model/column_implicit.h"
#include "model/column_transition.h"

#if CONFIG_BLOCKS

struct composition_model;

/* ---- settings ---- */

/* Takes the column of a table. Pointers into the record stay good: block.h. */
MUST_CHECK enum err composition_model_open(struct composition_model *m,
                                           const struct column_record *record);
/* Takes everything but the column; the past stays. */
void composition_model_set(struct composition_model *m, const struct block_setup *setup);
/* Sets pointers into the state anew, since the state may have been moved. numbers: memory of the linear model. */
void composition_model_relocate(struct composition_model *m, real_t *numbers);
/* The same for a copy of the column. */
void composition_model_point_column(const struct composition_model *m, struct column *column);
/* Begins with the profile of the table. */
void composition_model_begin(struct composition_model *m);
/* Counts a restart because there was no solution. */
void composition_model_count_restart(struct composition_model *m);

/* ---- what it has ---- */

const struct column_table *composition_model_table(const struct composition_model *m);
const struct column *composition_model_column(const struct composition_model *m);
/* Returns x[mole fractions]. */
const real_t *composition_model_x(const struct composition_model *m);
real_t composition_model_fraction(const struct composition_model *m, size_t stage, size_t j);
/* s, of a step */
real_t composition_model_h(const struct composition_model *m);
/* Returns the number of mole fractions and extras. */
size_t composition_model_length(const struct composition_model *m);
/* Numbers of extras: of the feed; all. */
size_t composition_model_feed_extras(const struct composition_model *m);
size_t composition_model_extras(const struct composition_model *m);
/* True: extra k is the part by which the feed's flow is larger than given. */
bool composition_model_is_flow(const struct composition_model *m, size_t k);
/* True: the feed's mole fractions, its flow are among the extras. */
bool composition_model_has_feed(const struct composition_model *m);
bool composition_model_has_flow(const struct composition_model *m);
real_t composition_model_extra(const struct composition_model *m, size_t k);
/* Returns the extra that is the model's offset at the place of analysis i; NULL: there is none. */
real_t *composition_model_offset(struct composition_model *m, unsigned i);
/* False: an extra of the feed is too many standard deviations from the table's feed. */
bool composition_model_expects_feed(const struct composition_model *m, real_t sd_fraction,
                                    real_t sd_flow);
/* Value i of those for the console and its name; NULL: there are no more. */
#define COMPOSITION_MODEL_VALUES 5
const char *composition_model_describe(const struct composition_model *m, size_t i, float *value);

/* ---- inputs ---- */

/* An input of the column as it is measured, SI. */
void composition_model_drive(struct composition_model *m, enum column_drive drive, real_t value);
/* Returns the inputs with what has been found of the feed. */
void composition_model_inputs(const struct composition_model *m, struct column_inputs *inputs);
/* push[feed's extras][mole fractions]: rates by each extra of the feed, 1/s, at the state x and the inputs of the column, which
 * column_rates() has seen last. flow, work: [mole fractions], space. */
void composition_model_push(const struct composition_model *m, struct column *column,
                            const real_t *x, real_t *push, real_t *flow, real_t *work);

/* ---- temperatures ---- */

/* dT/dx and dy/dx of a stage as temperatures use them: at the estimate, or where the model is linear. */
void composition_model_slopes(const struct composition_model *m, size_t stage, real_t *dt,
                              real_t *dy);
/* Returns the temperature of a stage before the step, K. */
real_t composition_model_temperature_before(const struct composition_model *m, size_t stage);
/* Returns the temperature of a stage after the step, K. */
real_t composition_model_temperature(const struct composition_model *m, size_t stage);
/* Returns by how much the step moves the temperature of a stage that is not truncated, K. */
real_t composition_model_temperature_change(const struct composition_model *m, size_t stage,
                                            const real_t *dt);

/* ---- a step ---- */

/* Rates and temperatures at the estimate and the inputs. */
MUST_CHECK enum err composition_model_evaluate(struct composition_model *m);
/* Finds the step over h, drawn by pull[pulls]. */
MUST_CHECK enum err composition_model_solve(struct composition_model *m,
                                            const struct column_pull *pull, size_t pulls);
/* Takes the step, with what temperatures have added to it. */
void composition_model_move(struct composition_model *m);
/* Takes a step of the model alone. */
MUST_CHECK enum err composition_model_predict(struct composition_model *m);
/* The same over h; returns in *largest the largest change of a mole fraction. */
MUST_CHECK enum err composition_model_settle(struct composition_model *m, real_t h,
                                             real_t *largest);

/* Returns d(dx/dt)/dx of a mole fraction, with flows and the vapour from below held. */
real_t composition_model_own_rate(const struct composition_model *m, size_t stage, size_t component,
                                  const real_t *dy);
/* True: the step takes the mole fraction past its limits. */
bool composition_model_leaves_limits(const struct composition_model *m, size_t stage,
                                     size_t component);
/* Adds to the step of one mole fraction. */
void composition_model_add(struct composition_model *m, size_t stage, size_t component, real_t by);
/* Adds gain[mole fractions, extras] times e to the step and to the extras. Returns dt times the gain of the stage. */
real_t composition_model_innovate(struct composition_model *m, const real_t *gain, real_t e,
                                  size_t stage, const real_t *dt);
/* Moves mole fractions and extras by gain times e at once. */
void composition_model_correct(struct composition_model *m, const real_t *gain, real_t e);

#endif
#endif
