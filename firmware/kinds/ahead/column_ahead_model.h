/* The column as the kind `ahead` sees it: where it is, and where it will be an interval later. SI units, stages from 0. For this folder alone. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_MODEL_H
#define REFLUX_AHEAD_COLUMN_AHEAD_MODEL_H

#include "kinds/ahead/column_ahead.h"
#include "kinds/column/column.h"
#include "model/column_drive.h"

#if CONFIG_BLOCKS

/* A measured or estimated value on a stage. */
struct ahead_reading {
    uint8_t stage;
    uint8_t component; /* that it moves */
    bool is_fraction;  /* mole fraction of the component; else K */
    real_t value;
};

#define AHEAD_READINGS_MOST (BLOCK_INPUTS_MAX + AHEAD_LOOPS)

struct ahead_model;

/* Returns the number of numbers that the model of a column needs besides. */
size_t ahead_model_numbers(size_t stages, size_t components);

/* Begins with the profile of the table, which has no truncated stages. The record must stay. numbers: ahead_model_numbers(). Errors as
 * column_record_read. */
MUST_CHECK enum err ahead_model_begin(struct ahead_model *m, const struct column_record *record,
                                      real_t *numbers);

/* Begins anew, with the profile. */
void ahead_model_rest(struct ahead_model *m);

/* Sets pointers anew, since the model or its numbers may have been moved since the last call. */
void ahead_model_relocate(struct ahead_model *m, real_t *numbers);

/* Sets the interval, and the number of parts in which it is carried on. */
void ahead_model_set(struct ahead_model *m, uint16_t parts, real_t interval_s);

/* States [mole fractions]: present ones, and those of the last prediction. */
const real_t *ahead_model_x(const struct ahead_model *m);
const real_t *ahead_model_later(const struct ahead_model *m);
/* Returns the present inputs. */
struct column_inputs *ahead_model_inputs(struct ahead_model *m);

/* Puts a mole fraction of the feed, kept within 0 and 1. */
void ahead_model_take_fraction(struct column_inputs *inputs, size_t components, size_t j,
                               real_t value);
/* Puts component j of the feed, or another input, in SI units. */
void ahead_model_take_feed(const struct ahead_model *m, struct column_inputs *inputs, size_t j,
                           real_t value);
void ahead_model_take_drive(const struct ahead_model *m, struct column_inputs *inputs,
                            enum column_drive drive, real_t value);

/* Finds the states an interval later under these inputs, ahead_model_later(). ERR_RANGE, ERR_NOT_FINITE: the equations have no
 * solution. */
MUST_CHECK enum err ahead_model_predict(struct ahead_model *m, const struct column_inputs *inputs);

/* Moves the present states to an interval later. */
MUST_CHECK enum err ahead_model_carry(struct ahead_model *m, const struct column_inputs *inputs);

/* Finds the temperatures at the states x under the present inputs. */
MUST_CHECK enum err ahead_model_look(struct ahead_model *m, const real_t *x);

/* Returns of a stage that has just been looked at: K, or the mole fraction of a component from 0. */
real_t ahead_model_value(const struct ahead_model *m, const real_t *x, size_t stage,
                         bool is_fraction, size_t component);

/* Corrects the present states by the part `trust` of what readings have more than it: there, and in proportion to the stages that lie between, of
 * ln(x/(1 - x)), so that what is nearly pure stays so. Looks at the column before and after. reading[n] in ascending order of stages. */
MUST_CHECK enum err ahead_model_correct(struct ahead_model *m, const struct ahead_reading *reading,
                                        size_t n, real_t trust);

/* Returns the mole fraction of component j on a stage from its mass fraction there, the others sharing the rest as in the model. */
real_t ahead_model_mole_fraction(const struct ahead_model *m, size_t stage, size_t j, real_t mass);

#endif
#endif
