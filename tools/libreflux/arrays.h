/* Arrays of frequency responses for the host tools: direct and inverse, Gershgorin's radii, compensators, loci. Rules as in
 * libreflux.h; a complex number is re and im, one after the other, and a table has a p x m matrix for every frequency.
 * tools/reflux/arrays.py is the Python side. */
#ifndef REFLUX_LIBREFLUX_ARRAYS_H
#define REFLUX_LIBREFLUX_ARRAYS_H

#include <stdint.h>

#include "libreflux.h"

/* a: p x na; b: p x m x nb, coefficients of z^-1, z^-2 and so on (lti/difference_model.h) */
struct reflux_sampled {
    int32_t outputs, inputs, na, nb;
    double period_s;
    const double *a, *b;
};

/* response: points tables of p x m; omega: rad/s, as many */
int32_t reflux_response(const struct reflux_plant *plant, int32_t points, const double *omega,
                        double *response);
int32_t reflux_response_sampled(const struct reflux_sampled *model, int32_t points,
                                const double *omega, double *response);

/* F at `points` frequencies, each n x n, and G, n x n. array: (F G)^-1 where inverse is not 0, else F G, at each. By point n numbers:
 * radii and ratios by rows and by columns. *failed: at which point there was an error. */
int32_t reflux_array(int32_t n, int32_t points, const double *response, const double *g,
                     int32_t inverse, double *array, double *row_radius, double *column_radius,
                     double *row_ratio, double *column_ratio, int32_t *failed);

/* kind: 0 add, 1 scale, 2 swap (interact/ina.h); rows from 0; g is changed */
int32_t reflux_array_operate(int32_t n, double *g, int32_t kind, int32_t row, int32_t other,
                             double by);
/* response: one n x n */
int32_t reflux_array_align(int32_t n, const double *response, double *g);
/* *all: every column by its own diagonal element */
int32_t reflux_array_normalise(int32_t n, double *g, int32_t *all);

/* by: 0 rows, 1 columns. g: from where, and what was found. numbers: ratio before, after, looks, largest
 * relative gain of G. */
int32_t reflux_array_search(int32_t n, int32_t points, const double *response, int32_t by,
                            int32_t starts, int32_t seed, double *g, double *numbers);

/* Characteristic loci: eigenvalues of F G, n by point, each in the order of the point before. */
int32_t reflux_loci(int32_t n, int32_t points, const double *response, const double *g,
                    double *loci);

#endif
