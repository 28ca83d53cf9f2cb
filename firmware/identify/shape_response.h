/* The response of an element of one or two lags, or of a damped one, to an excitation, on the points of a record: each
 * the mean of a block of samples, as in response.h. Exact for any block, by geometric sums. Times in samples.
 *
 * With the poles -1/T1 and -1/T2 the unit step response is a sum of two exponentials; damped poles are a conjugate pair and
 * need one complex exponential. Equal lags would cancel digits, so lags are kept apart by SHAPE_APART of their sum. */
#ifndef REFLUX_IDENTIFY_SHAPE_RESPONSE_H
#define REFLUX_IDENTIFY_SHAPE_RESPONSE_H

#include <stdbool.h>
#include <stdint.h>

#include "identify/excitation.h"
#include "num/real.h"

/* Least difference of two lags over their sum: lags of 0.98 and 1.02 of their mean. */
#define SHAPE_APART REAL_C(0.02)

/* exp(-(rate - i turn) t), and what it adds to the step response and to its derivative: less Re(weight exp()). */
struct shape_mode {
    real_t rate, turn;           /* 1/sample, rad/sample */
    real_t step_re, step_im;     /* weights in the step response, which tends to 1 */
    real_t change_re, change_im; /* weights in its derivative by time */
};

struct shape_modes {
    uint32_t count; /* 1 or 2 */
    struct shape_mode mode[2];
};

/* Modes of 1/(square s^2 + lag s + 1). lag [0, 1e9] samples, square from 0 to 100 lag^2, 0 for one lag. */
void shape_modes_find(real_t lag, real_t square, struct shape_modes *m);

/* A column gets the response to `gain (zero s + 1)` with gain_zero = gain zero, or its derivative by the dead time. */
struct shape_column {
    real_t *value; /* points values, overwritten */
    real_t gain, gain_zero;
    bool by_dead;
};

#define SHAPE_COLUMNS_MAX 3

/* Fills count columns, 1 to SHAPE_COLUMNS_MAX. dead: dead time in samples, [0, 1e6]; block from 1. Costs about three
 * exponentials an edge and mode, and ten products a point, mode and column. */
void shape_response(const struct excitation *u, const struct shape_modes *m, real_t dead,
                    uint32_t block, uint32_t points, const struct shape_column *columns,
                    uint32_t count);

/* Returns the part of a response of 1 to a unit step that is still to come: 1 right after it begins, 0 in the end, below 0 while the
 * response is beyond its end. time: since the step, without the dead time, samples; zero: of the element, samples. */
real_t shape_response_to_come(const struct shape_modes *m, real_t time, real_t zero);

#endif
