/* The straight line (offset and drift) under a record, taken out of columns of values before anything else is fitted.
 *
 * What is known of the two beforehand enters as two more rows: an offset known with standard deviation s is an
 * observation of weight sigma/s beside points of standard deviation sigma. s = 0: known exactly, nothing is fitted.
 * A column has points + FIT_LINE_ROWS values; those rows of a column that is no line are 0.
 */
#ifndef REFLUX_IDENTIFY_FIT_LINE_H
#define REFLUX_IDENTIFY_FIT_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "identify/record.h"
#include "num/real.h"

#define FIT_LINE_ROWS 2
#define FIT_LINE_SIZE (RECORD_POINTS + FIT_LINE_ROWS)

struct fit_line {
    uint32_t points;
    bool offset, slope;    /* which of the two are fitted */
    real_t row_0, row_1;   /* weights of what is known of them, 0: nothing */
    real_t norm_0, norm_1; /* squares */
    real_t middle;         /* of the time, as the offset sees it */
    const real_t *weight;  /* 0 or 1 per point, NULL: all 1. Not copied. */
};

/* Time of point i here: (i + 1/2)/points. */
static inline real_t fit_line_time(const struct fit_line *l, uint32_t i)
{
    return ((real_t)i + REAL_C(0.5)) / (real_t)l->points;
}

/* From points, offset, slope, row_0, row_1 and weight; the other fields are found. */
void fit_line_prepare(struct fit_line *l);

/* Takes the line out of column; *offset and *slope (per unit of that time), or NULL: what it was. */
void fit_line_remove(const struct fit_line *l, real_t *column, real_t *offset, real_t *slope);

/* Sum of a b over points (with their weights) and rows. */
real_t fit_line_dot(const struct fit_line *l, const real_t *a, const real_t *b);

#endif
