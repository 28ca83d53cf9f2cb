#include "columns/column_units.h"

#include <stddef.h>
#include <string.h>

#include "bench/text.h"

#define MINUTE  60.0
#define HOUR    3600.0
#define KILO    1e3
#define LITRE   1e-3
#define CALORIE 4.184 /* J */
#define KELVIN  273.15
#define MMHG    133.322
#define ATM     101325.0

/* SI is value times the first number; back by times the second, or over the first. */
#define TIMES(n, m, factor, back)                                                                  \
    {                                                                                              \
        .name = (n), .measure = (m), .in = (factor), .times = (back), .before = 1.0, .after = 1.0  \
    }
#define OVER(n, m, factor)                                                                         \
    {                                                                                              \
        .name = (n), .measure = (m), .in = (factor), .times = 1.0, .before = 1.0,                  \
        .after = (factor)                                                                          \
    }
#define OVER_FIRST(n, m, factor)                                                                   \
    {                                                                                              \
        .name = (n), .measure = (m), .in = (factor), .times = 1.0, .before = (factor),             \
        .after = 1.0                                                                               \
    }

static const struct column_unit units[] = {
    TIMES("mol/s", MEASURE_MOLAR_FLOW, 1.0, 1.0),
    TIMES("mol/min", MEASURE_MOLAR_FLOW, 1.0 / MINUTE, MINUTE),
    TIMES("mol/h", MEASURE_MOLAR_FLOW, 1.0 / HOUR, HOUR),
    TIMES("kmol/s", MEASURE_MOLAR_FLOW, KILO, 1.0 / KILO),
    TIMES("kmol/min", MEASURE_MOLAR_FLOW, KILO / MINUTE, MINUTE / KILO),
    TIMES("kmol/h", MEASURE_MOLAR_FLOW, KILO / HOUR, HOUR / KILO),
    OVER("kg/s", MEASURE_MASS_FLOW, 1.0),
    OVER("kg/h", MEASURE_MASS_FLOW, 1.0 / HOUR),
    OVER("t/h", MEASURE_MASS_FLOW, KILO / HOUR),
    OVER("l/s", MEASURE_VOLUME_FLOW, LITRE),
    OVER("l/min", MEASURE_VOLUME_FLOW, LITRE / MINUTE),
    OVER("l/h", MEASURE_VOLUME_FLOW, LITRE / HOUR),
    OVER("m3/s", MEASURE_VOLUME_FLOW, 1.0),
    OVER_FIRST("m3/h", MEASURE_VOLUME_FLOW, 1.0 / HOUR),
    OVER("W", MEASURE_POWER, 1.0),
    OVER("kW", MEASURE_POWER, 1e3),
    OVER("MW", MEASURE_POWER, 1e6),
    OVER("kcal/h", MEASURE_POWER, 1e3 * CALORIE / HOUR),
    OVER("Mcal/h", MEASURE_POWER, 1e6 * CALORIE / HOUR),
    OVER("Gcal/h", MEASURE_POWER, 1e9 * CALORIE / HOUR),
    OVER("kJ/h", MEASURE_POWER, 1e3 / HOUR),
    OVER("MJ/h", MEASURE_POWER, 1e6 / HOUR),
    OVER("GJ/h", MEASURE_POWER, 1e9 / HOUR),
    OVER("Pa", MEASURE_PRESSURE, 1.0),
    OVER("kPa", MEASURE_PRESSURE, 1e3),
    OVER("bar", MEASURE_PRESSURE, 1e5),
    OVER("mbar", MEASURE_PRESSURE, 1e2),
    OVER("mmHg", MEASURE_PRESSURE, MMHG),
    OVER("atm", MEASURE_PRESSURE, ATM),
    OVER("K", MEASURE_TEMPERATURE, 1.0),
    {.name = "degC",
     .measure = MEASURE_TEMPERATURE,
     .offset = KELVIN,
     .in = 1.0,
     .times = 1.0,
     .before = 1.0,
     .after = 1.0},
    OVER("K", MEASURE_DIFFERENCE, 1.0),
    TIMES("-", MEASURE_MOLE_FRACTION, 1.0, 1.0),
    TIMES("%", MEASURE_MOLE_FRACTION, 1e-2, 1e2),
    TIMES("ppm", MEASURE_MOLE_FRACTION, 1e-6, 1e6),
    TIMES("%w", MEASURE_MASS_FRACTION, 1e-2, 1e2),
    TIMES("-", MEASURE_NUMBER, 1.0, 1.0),
    TIMES("mol", MEASURE_AMOUNT, 1.0, 1.0),
    TIMES("kmol", MEASURE_AMOUNT, KILO, 1.0 / KILO),
    TIMES("%", MEASURE_CAPACITY, 1e-2, 1e2),
};

#define UNITS (sizeof units / sizeof units[0])

const struct column_unit *column_unit_find(const char *name, unsigned measures)
{
    for (size_t k = 0; k < UNITS; k++)
        if ((units[k].measure & measures) != 0 && strcmp(units[k].name, name) == 0)
            return &units[k];
    return NULL;
}

const struct column_unit *column_unit_at(size_t k)
{
    return k < UNITS ? &units[k] : NULL;
}

void column_unit_names(unsigned measures, char *text, size_t size)
{
    text[0] = '\0';
    for (size_t k = 0; k < UNITS; k++)
        if ((units[k].measure & measures) != 0)
            sim_append(text, size, "%s%s", text[0] != '\0' ? ", " : "", units[k].name);
}
