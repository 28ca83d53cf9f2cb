#include "model/properties.h"

/* Watson's exponent, the usual value for normal liquids (Reid, Prausnitz and Poling). */
#define WATSON_EXPONENT REAL_C(0.38)

real_t component_vapour_pressure(const struct component *c, real_t temperature, real_t *derivative)
{
    const real_t *k = c->antoine;
    real_t reciprocal = REAL_C(1.0) / (k[2] + temperature);
    real_t exponent = k[0] - k[1] * reciprocal;
    real_t slope = k[1] * reciprocal * reciprocal;

    if (k[3] != REAL_C(0.0)) {
        exponent += k[3] * temperature;
        slope += k[3];
    }
    if (k[4] != REAL_C(0.0)) {
        exponent += k[4] * real_log(temperature);
        slope += k[4] / temperature;
    }
    if (k[5] != REAL_C(0.0)) {
        real_t power = k[5] * real_pow(temperature, k[6]);
        exponent += power;
        slope += k[6] * power / temperature;
    }
    real_t pressure = real_exp(exponent);
    *derivative = pressure * slope;
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
