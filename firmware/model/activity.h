/* Activity coefficients from constant tables: Wilson and NRTL, any number of components that a column can have.
 *
 * Wilson: L_ij = exp(a_ij + b_ij / T),
 *   ln g_i = 1 - ln(sum_j x_j L_ij) - sum_k (x_k L_ki / sum_j x_j L_kj).
 * NRTL: t_ij = a_ij + b_ij / T, G_ij = exp(-alpha_ij t_ij), S_j = sum_k x_k G_kj, C_j = sum_k x_k t_kj G_kj,
 *   ln g_i = C_i / S_i + sum_j (x_j G_ij / S_j) (t_ij - C_j / S_j).
 * G. M. Wilson, J. Am. Chem. Soc. 86 (1964) 127; H. Renon and J. M. Prausnitz, AIChE J. 14 (1968) 135.
 *
 * Use: config.activity = activity_coefficients, config.activity_context = a struct activity that outlives the column and
 * that activity_validate() has accepted. */
#ifndef REFLUX_MODEL_ACTIVITY_H
#define REFLUX_MODEL_ACTIVITY_H

#include "model/column.h"

enum activity_model { ACTIVITY_WILSON, ACTIVITY_NRTL };

/* Tables of C rows and C columns, [i C + j], in the order of the column's components; T in K. */
struct activity {
    enum activity_model model;
    size_t components;   /* C, as the column's */
    const real_t *a;     /* its diagonal 0 */
    const real_t *b;     /* K, its diagonal 0; NULL: all 0 */
    const real_t *alpha; /* NRTL alone: 0 to 1, symmetric; its diagonal is not read */
};

/* Checks the tables for a range of temperatures (K). ERR_OK, or ERR_RANGE / ERR_NOT_FINITE with the field
 * ("activity.a"), what it must be, and in *row and *column which entry (0 where it is no entry). */
MUST_CHECK enum err activity_validate(const struct activity *activity, real_t temperature_min,
                                      real_t temperature_max, struct column_fault *fault,
                                      size_t *row, size_t *column);

/* Activity coefficients gamma[C] of a liquid of mole fractions x[C] (below 0: as 0; in the build for derivatives as it is) at
 * a temperature; an activity_fn. context: a struct activity. ln g is held between -50 and 50. */
void activity_coefficients(void *context, const real_t *x, real_t temperature, real_t *gamma);

#endif
