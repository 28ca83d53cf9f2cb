/* Inverse Nyquist array: a plant F of n outputs and n inputs, a constant compensator G before it, H = F G, and how far H^-1 is from
 * diagonal. H. H. Rosenbrock, "Design of multivariable control systems using the inverse Nyquist array", Proc. IEE 116
 * (1969) 1929; on the unit circle J. Kotyk and J. Machacek, Sci. Papers Univ. Pardubice, Ser. A 1 (1995), section 4.
 *
 * All of it looks at one frequency; the responses come from interact_response (exact dead times, s = i omega) or
 * difference_response (z = exp(i omega h)). Row i of H^-1 belongs to input i, column j to output j: dominance by rows depends on the
 * units of the outputs, by columns on those of the inputs. Neither depends on the size of G as a whole. */
#ifndef REFLUX_INTERACT_INA_H
#define REFLUX_INTERACT_INA_H

#include "interact/double_symbols.h"
#include "num/cmatrix.h"

#define INA_MOST 8 /* loops: as many as the static decoupler of the firmware has rows */

enum ina_by { INA_BY_ROWS, INA_BY_COLUMNS };

/* An elementary operation on the rows of H^-1: E H^-1, so that G becomes G E^-1. */
enum ina_kind {
    INA_ADD, /* by times row `other` is added to row `row`: column `other` of G loses by times column `row` */
    INA_SCALE, /* row `row` times by: column `row` of G over by */
    INA_SWAP   /* rows `row` and `other` change places, and so do these columns of G */
};
struct ina_operation {
    enum ina_kind kind;
    uint8_t row, other; /* from 0 */
    real_t by;          /* finite, magnitude at most 1e6; INA_SCALE: at least 1e-6 */
};

struct ina_work {
    struct cmatrix h;
    struct clu lu;
};

/* g = identity of n x n, 1 to INA_MOST. */
MUST_CHECK enum err ina_identity(uint8_t n, struct matrix *g);

/* ERR_RANGE: rows outside G or (add, swap) the same twice, or by; G is as it was. What undoes it to the last bit is the G of
 * before. */
MUST_CHECK enum err ina_operate(struct matrix *g, const struct ina_operation *operation);

/* h = F G. ERR_RANGE: f is not n x n with n to INA_MOST, or g of another size; ERR_NOT_FINITE. */
MUST_CHECK enum err ina_direct(const struct cmatrix *f, const struct matrix *g, struct cmatrix *h);

/* inverse = (F G)^-1, each element within about 8 n REAL_EPSILON kappa of its largest, kappa the condition number of F G. As
 * ina_direct; ERR_SINGULAR: there is none. */
MUST_CHECK enum err ina_inverse(const struct cmatrix *f, const struct matrix *g,
                                struct ina_work *work, struct cmatrix *inverse);

/* Judges a square array of n to INA_MOST, H^-1 or H. radius[i]: sum of the magnitudes off the diagonal in row (column) i, that of Gershgorin's
 * circle about its diagonal element; ratio[i]: that over the magnitude of the diagonal element, infinite where it is 0. The array is
 * diagonally dominant where all ratios are below 1. Returns the largest. Either array may be NULL. */
real_t ina_dominance(const struct cmatrix *array, enum ina_by by, real_t *radius, real_t *ratio);

/* ALIGN: the real G that makes F G at this frequency most like diag(exp(i a_1), ..): each column of G and its angle a_j minimise
 * |F g_j - exp(i a_j) e_j|. A. G. J. MacFarlane and B. Kouvaritakis, Int. J. Control 25 (1977) 837. At omega = 0 it is F^-1. The
 * angles are between -pi/2 and pi/2. Solved by the pseudo-inverse of [Re F; Im F], so its error grows with the condition
 * number of that, not the square. ERR_RANGE, ERR_NOT_FINITE: f; ERR_SINGULAR. */
struct ina_align_work {
    struct pseudo_inverse_work pseudo;
    struct matrix stacked, inverse;
};
MUST_CHECK enum err ina_align(const struct cmatrix *f, struct ina_align_work *work,
                              struct matrix *g);

/* Columns of G over their diagonal elements, so that loop j moves its own input by what it asks for. A column whose diagonal element
 * is less than 0.01 of its largest is divided by that instead, and the result is false. Dominance of H^-1 by rows and of H by
 * columns stays as it is. A column of zeros stays. */
bool ina_normalise(struct matrix *g);

#endif
