/* The column as the kind `ahead` sees it: where it is, and where it will be an interval later. SI units, stages from 0. For this folder alone. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_MODEL_H
#define REFLUX_AHEAD_COLUMN_AHEAD_MODEL_H

#include "kinds/ahead/column_ahead.h"
#include "kinds/column/column.h"
#include "model/column_drive.h"
#include "model/column_transition.h"

#if CONFIG_BLOCKS

/* Something that is told of a stage. */
struct ahead_said {
    uint8_t stage;
    uint8_t component; /* that it moves */
    bool is_fraction;  /* mole fraction of the component; else K */
    real_t value;
};

static inline real_t ahead_between(real_t x, real_t lo, real_t hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

#define AHEAD_SAID_MOST (BLOCK_INPUTS_MAX + AHEAD_LOOPS)

struct ahead_model {
    struct column_table table;
    struct column column;
    struct column_inputs inputs;         /* of now */
    real_t *x, *later, *rates;           /* [n_fractions] now, an interval later, 1/s */
    struct column_transition transition; /* of a part of an interval */
    real_t h;                            /* s, of a part of an interval */
    uint16_t parts;
};

/* How many numbers the model of a column of so many stages and components needs besides. */
size_t ahead_model_numbers(size_t stages, size_t components);

/* Begins with the profile of the table, which has no truncated stages. The record must stay. numbers: ahead_model_numbers(). Errors as
 * column_record_read. */
MUST_CHECK enum err ahead_model_begin(struct ahead_model *m, const struct column_record *record,
                                      real_t *numbers);

/* Begins anew, with the profile. */
void ahead_model_rest(struct ahead_model *m);

/* The model or its numbers may have been moved to another place since the last call. */
void ahead_model_stands_here(struct ahead_model *m, real_t *numbers);

/* A mole fraction of the feed, kept within 0 and 1. */
void ahead_model_take_fraction(struct column_inputs *inputs, size_t components, size_t j,
                               real_t value);

/* The states an interval later under these inputs, in m->later; `now` is m->x, or m->x itself is carried on. ERR_RANGE, ERR_NOT_FINITE: the
 * equations have no solution. */
MUST_CHECK enum err ahead_model_predict(struct ahead_model *m, const struct column_inputs *inputs);

/* Moves m->x to an interval later. */
MUST_CHECK enum err ahead_model_carry(struct ahead_model *m, const struct column_inputs *inputs);

/* Temperatures at the states x under the present inputs. */
MUST_CHECK enum err ahead_model_look(struct ahead_model *m, const real_t *x);

/* Of a stage that has just been looked at: K, or the mole fraction of a component from 0. */
real_t ahead_model_value(const struct ahead_model *m, const real_t *x, size_t stage,
                         bool is_fraction, size_t component);

/* Corrects m->x by the part `trust` of what is said more than it has: there, and in proportion to the stages that lie between, of
 * ln(x/(1 - x)), so that what is nearly pure stays so. Looks at the column before and after. said[n] in ascending order of stages. */
MUST_CHECK enum err ahead_model_correct(struct ahead_model *m, const struct ahead_said *said,
                                        size_t n, real_t trust);

/* Mole fraction of component j on a stage from its mass fraction there, the others sharing the rest as in the model. */
real_t ahead_model_mole_fraction(const struct ahead_model *m, size_t stage, size_t j, real_t mass);

#endif
#endif
