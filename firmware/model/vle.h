/* Vapour-liquid equilibrium of one stage: bubble point, equilibrium vapour and their derivatives. */
#ifndef REFLUX_MODEL_VLE_H
#define REFLUX_MODEL_VLE_H

#include "base/error.h"
#include "model/properties.h"

/* Activity coefficients gamma[n] of a liquid with mole fractions x[n] at temperature (K). All above 0.
 * NULL where one is asked for means an ideal liquid. */
typedef void activity_fn(void *context, const real_t *x, real_t temperature, real_t *gamma);

struct vle {
    const struct component *component; /* [n] */
    size_t n;
    activity_fn *activity; /* NULL: ideal liquid */
    void *activity_context;
    real_t temperature_min, temperature_max; /* K, where the property data may be used */
};

/* Bubble point: the T for which sum_j x_j gamma_j P_j(T) = pressure, and the vapour in equilibrium,
 * y_j = x_j gamma_j P_j / pressure. Frau (3.2g) with activity coefficients added.
 *
 *   x            [n] mole fractions
 *   pressure     Pa, above 0
 *   temperature  K; in: where Newton starts, out: the bubble point
 *   y            [n] out
 *   k            [n] out, y_j / x_j at equilibrium: gamma_j P_j / pressure (also where x_j = 0)
 *   dk           [n] out, derivative of k by temperature, 1/K
 *   warm         k and dk hold, on entry, their values at *temperature and this pressure (an earlier answer
 *                of this function): then the first step needs no exponentials
 *
 * ERR_RANGE when there is no bubble point in the temperature range or Newton does not reach it,
 * ERR_NOT_FINITE when a composition or the start is not finite. Outputs are undefined then, except
 * *temperature, which keeps its value. */
MUST_CHECK enum err vle_bubble_point(const struct vle *vle, const real_t *x, real_t pressure,
                                     real_t *temperature, real_t *y, real_t *k, real_t *dk,
                                     bool warm);

/* The same by one step from the answer at other mole fractions and the same pressure, without exponentials: k, dk and *temperature hold
 * that on entry. For derivatives: of k it misses 1e-4 of it where the bubble point is 1 K away, four times that at 2 K. False where it is
 * more than VLE_NEAR_K away or the liquid is not ideal; then nothing has changed. Not to be done again on its own answer. */
#define VLE_NEAR_K REAL_C(2.0)
MUST_CHECK bool vle_bubble_point_near(const struct vle *vle, const real_t *x, real_t *temperature,
                                      real_t *y, real_t *k, real_t *dk);

/* Derivatives along the bubble-point surface for the first n - 1 mole fractions, the last one closing to 1,
 * activity coefficients held: dt[j] = dT/dx_j (K), dy[i (n-1) + j] = dy_i/dx_j for i, j < n - 1.
 * x, k, dk as in vle_bubble_point. Implicit differentiation of (3.2g). */
void vle_slopes(size_t n, const real_t *x, const real_t *k, const real_t *dk, real_t *dt,
                real_t *dy);

/* As vle_slopes, activity coefficients moving along: their slopes are taken by differences, n calls of the activity
 * function. Good for Newton matrices, not for gains. */
void vle_full_slopes(const struct vle *vle, real_t temperature, const real_t *x, const real_t *k,
                     const real_t *dk, real_t *dt, real_t *dy);

#endif
