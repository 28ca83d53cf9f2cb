#include "model/properties.h"

/* Watson's exponent, the usual value for normal liquids (Reid, Prausnitz and Poling). */
#define WATSON_EXPONENT REAL_C(0.38)

/* T^G; the exponents of the handbooks' tables (DIPPR-101: 1, 2, 6) by products. */
static real_t power(real_t t, real_t g)
{
    if (g == REAL_C(1.0))
        return t;
    if (g == REAL_C(2.0))
        return t * t;
    if (g == REAL_C(6.0))
        return t * t * t * (t * t * t);
    return real_pow(t, g);
}

/* inverse: 1/T; logarithm: ln T, read only where the equation has it. */
static real_t vapour_pressure(const real_t *k, real_t t, real_t inverse, real_t logarithm,
                              real_t *derivative)
{
    real_t reciprocal = k[2] == REAL_C(0.0) ? inverse : REAL_C(1.0) / (k[2] + t);
    real_t exponent = k[0] - k[1] * reciprocal;
    real_t slope = k[1] * reciprocal * reciprocal;

    if (k[3] != REAL_C(0.0)) {
        exponent += k[3] * t;
        slope += k[3];
    }
    if (k[4] != REAL_C(0.0)) {
        exponent += k[4] * logarithm;
        slope += k[4] * inverse;
    }
    if (k[5] != REAL_C(0.0)) {
        real_t part = k[5] * power(t, k[6]);
        exponent += part;
        slope += k[6] * part * inverse;
    }
    real_t pressure = real_exp(exponent);
    *derivative = pressure * slope;
    return pressure;
}

void component_vapour_pressures(const struct component *c, size_t n, real_t temperature,
                                real_t *pressure, real_t *derivative)
{
    real_t inverse = REAL_C(1.0) / temperature, logarithm = REAL_C(0.0);
    bool known = false; /* one logarithm serves all components */

    for (size_t j = 0; j < n; j++) {
        if (c[j].antoine[4] != REAL_C(0.0) && !known) {
            logarithm = real_log(temperature);
            known = true;
        }
        pressure[j] =
            vapour_pressure(c[j].antoine, temperature, inverse, logarithm, &derivative[j]);
    }
}

real_t component_vapour_pressure(const struct component *c, real_t temperature, real_t *derivative)
{
    real_t pressure;
    component_vapour_pressures(c, 1, temperature, &pressure, derivative);
    return pressure;
}

real_t component_vaporisation_heat(const struct component *c, real_t temperature)
{
    if (temperature >= c->critical_temperature)
        return REAL_C(0.0);
    real_t ratio =
        (c->critical_temperature - temperature) / (c->critical_temperature - c->boiling_point);
    return c->vaporisation_heat * real_pow(ratio, WATSON_EXPONENT);
}

real_t component_molar_volume(const struct component *c, real_t temperature)
{
    return c->molar_mass / (c->density[0] + c->density[1] * temperature);
}

real_t mixture_molar_mass(const struct component *c, size_t n, const real_t *x)
{
    real_t sum = REAL_C(0.0);
    for (size_t j = 0; j < n; j++)
        sum += x[j] * c[j].molar_mass;
    return sum;
}

real_t mixture_molar_volume(const struct component *c, size_t n, const real_t *x,
                            real_t temperature)
{
    real_t sum = REAL_C(0.0);
    for (size_t j = 0; j < n; j++)
        sum += x[j] * component_molar_volume(&c[j], temperature);
    return sum;
}

real_t mixture_vaporisation_heat(const struct component *c, size_t n, const real_t *x,
                                 real_t temperature)
{
    real_t sum = REAL_C(0.0);
    for (size_t j = 0; j < n; j++)
        sum += x[j] * component_vaporisation_heat(&c[j], temperature);
    return sum;
}

real_t mixture_heat_capacity(const struct component *c, size_t n, const real_t *x)
{
    real_t sum = REAL_C(0.0);
    for (size_t j = 0; j < n; j++)
        sum += x[j] * c[j].heat_capacity;
    return sum;
}

void mole_from_mass_fractions(const struct component *c, size_t n, const real_t *w, real_t *x)
{
    real_t sum = REAL_C(0.0);
    for (size_t j = 0; j < n; j++) {
        x[j] = w[j] / c[j].molar_mass;
        sum += x[j];
    }
    for (size_t j = 0; j < n; j++)
        x[j] /= sum;
}

real_t mass_fraction_of(const struct component *c, size_t n, const real_t *x, size_t j)
{
    return x[j] * c[j].molar_mass / mixture_molar_mass(c, n, x);
}
