/* Physical properties of the components of a column: vapour pressure, liquid density, heat of
 * vaporisation, liquid heat capacity. SI units throughout: K, Pa, mol, kg, m3, J.
 *
 * A liquid mixture is ideal in volume and heat: molar volumes, heats of vaporisation and heat capacities
 * add by mole fraction. */
#ifndef REFLUX_MODEL_PROPERTIES_H
#define REFLUX_MODEL_PROPERTIES_H

#include "model/double_symbols.h"
#include "num/real.h"

#include <stdbool.h>
#include <stddef.h>

/* A property that is 0 is not given; column_validate() and column_validate_inputs() say where one is needed. Only the
 * vapour pressure always is. */
struct component {
    const char *name;
    /* Vapour pressure, ln(P / Pa) = A - B/(C + T) + D T + E ln T + F T^G with T in K: the extended
     * Antoine equation of Frau 2.5 (her 7 constants). Antoine when D = E = F = 0, DIPPR-101 when
     * C = D = 0. */
    real_t antoine[7];
    real_t molar_mass; /* kg/mol, above 0 */
    real_t density[2]; /* liquid, kg/m3: density[0] + density[1] T, above 0 in the range used */
    real_t vaporisation_heat;    /* J/mol at boiling_point, above 0 */
    real_t boiling_point;        /* K, where vaporisation_heat holds */
    real_t critical_temperature; /* K, above boiling_point and above every temperature used */
    real_t heat_capacity;        /* liquid, J/(mol K), above 0 */
};

/* Vapour pressure in Pa and its derivative in Pa/K at T (K, with C + T > 0). Frau (3.2g), digest 2.5. */
real_t component_vapour_pressure(const struct component *c, real_t temperature, real_t *derivative);

/* The same of n components c[n] at one temperature: pressure[n] and derivative[n]. */
void component_vapour_pressures(const struct component *c, size_t n, real_t temperature,
                                real_t *pressure, real_t *derivative);

/* Heat of vaporisation, J/mol, by Watson's rule with exponent 0.38; 0 at and above the critical
 * temperature. */
real_t component_vaporisation_heat(const struct component *c, real_t temperature);

/* Molar volume of the pure liquid, m3/mol. */
real_t component_molar_volume(const struct component *c, real_t temperature);

/* Mixture values for n components with mole fractions x[n]. */
real_t mixture_molar_mass(const struct component *c, size_t n, const real_t *x);  /* kg/mol */
real_t mixture_molar_volume(const struct component *c, size_t n, const real_t *x, /* m3/mol */
                            real_t temperature);
real_t mixture_vaporisation_heat(const struct component *c, size_t n, const real_t *x, /* J/mol */
                                 real_t temperature);
real_t mixture_heat_capacity(const struct component *c, size_t n, const real_t *x); /* J/(mol K) */

/* Mole fractions x[n] of a mixture given by mass fractions w[n] (any positive sum; x adds up to 1). */
void mole_from_mass_fractions(const struct component *c, size_t n, const real_t *w, real_t *x);

/* Mass fraction of component j in a mixture of mole fractions x[n]. */
real_t mass_fraction_of(const struct component *c, size_t n, const real_t *x, size_t j);

#endif
