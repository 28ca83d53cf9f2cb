/* An element of interact/plant.h as a sum of lags, without its gain and dead time.
 *
 *     (zero s + 1)/(square s^2 + T s + 1) = w/(T1 s + 1) + (1 - w)/(T2 s + 1)
 *
 * T1 and T2 are real, or conjugate complex where the element is underdamped. Real ones are taken at least 3 % apart,
 * because the weights of equal ones are infinite; that changes square_s2 by at most 0.03 %. */
#ifndef REFLUX_DESIGN_MODES_H
#define REFLUX_DESIGN_MODES_H

#include <stdbool.h>

#include "design/double_symbols.h"
#include "interact/plant.h"

struct modes {
    bool second;       /* two lags: false for a single one, in lag_s[0] */
    bool conjugate;    /* complex: rate and turn count, and not lag_s */
    real_t lag_s[2];   /* the longer one first; 0 allowed */
    real_t rate, turn; /* poles -rate +- i turn, 1/s and rad/s */
    /* Real lags: weight w of the first; the other one has 1 - share. Conjugate lags: the output is Re x + share Im x, x the
     * state of the pole -rate + i turn. */
    real_t share;
};

/* element and shape as interact_check wants them. */
void modes_of(const struct fopdt *element, const struct interact_shape *shape, struct modes *modes);

/* Puts 1 - exp(-time_s/T) of both lags into rise, or its real and imaginary part for conjugate lags. It keeps its digits where
 * time_s is far below T. Lags below a thousandth of step_s count as none. */
void modes_rise(const struct modes *modes, real_t time_s, real_t step_s, real_t rise[2]);

/* Returns the standard deviation of the element's output, per unit of gain, where its input is white noise of 1 that is
 * held for interval_s. */
real_t modes_noise(const struct modes *modes, real_t interval_s);

#endif
