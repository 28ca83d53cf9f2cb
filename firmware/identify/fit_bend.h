/* A drift that turns once within a record: beside the straight line (fit_line.h) a second one that begins at an instant, and
 * a step there, which to first order is the instant's own error. So what is fitted beside them knows that neither the
 * slopes nor the instant are known.
 *
 * Columns as in fit_line.h. The instant is looked for by the caller, by what fit_bend_squares() leaves. */
#ifndef REFLUX_IDENTIFY_FIT_BEND_H
#define REFLUX_IDENTIFY_FIT_BEND_H

#include "identify/fit_line.h"

struct fit_bend {
    bool on; /* there is a bend: the fields below count */
    /* The bend takes place before this point. */
    uint32_t point;
    uint8_t used; /* 2; less where a record cannot tell the step, or the bend, from its line */
    real_t basis[2][FIT_LINE_SIZE]; /* of length 1, without the line, at right angles */
    /* ... from the second line and the step: what was taken off, and the length that was left */
    real_t offset[2], slope[2], length[2], shared;
};

/* A bend before point at; on afterwards, unless the line alone explains it. */
void fit_bend_place(struct fit_bend *b, const struct fit_line *l, uint32_t at);

/* Takes line and bend out of a column. */
void fit_bend_take_out(const struct fit_bend *b, const struct fit_line *l, real_t *column);

/* Takes the bend out of a column from which the line has been taken; part[2], or NULL: how much of each that was. */
void fit_bend_remove(const struct fit_bend *b, const struct fit_line *l, real_t *column,
                     real_t *part);

/* Turns part[] into a change of slope (*slope_change, per unit of fit_line_time()) and a step at the instant, and what
 * they add to offset and slope of the line. */
void fit_bend_explain(const struct fit_bend *b, const real_t *part, real_t *slope_change,
                      real_t *step, real_t *offset, real_t *slope);

/* Squares that are left of y with the best multiple of model and of a bend before point at, line taken out of both.
 * scratch: a column. Infinitely many where there can be no bend. */
real_t fit_bend_squares(const struct fit_line *l, uint32_t at, const real_t *y, const real_t *model,
                        real_t *scratch);

#endif
