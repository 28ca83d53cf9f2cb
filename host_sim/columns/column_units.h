/* The units in which a column's file may give and show quantities, and what they are in SI: docs/reference/plant-files.md. */
#ifndef REFLUX_HOST_SIM_COLUMN_UNITS_H
#define REFLUX_HOST_SIM_COLUMN_UNITS_H

#include <stddef.h>

/* Measures of units, as masks: a quantity may allow several of them. */
enum column_measure {
    MEASURE_MOLAR_FLOW = 1 << 0,  /* mol/s */
    MEASURE_MASS_FLOW = 1 << 1,   /* kg/s */
    MEASURE_VOLUME_FLOW = 1 << 2, /* m3/s */
    MEASURE_FLOW = MEASURE_MOLAR_FLOW | MEASURE_MASS_FLOW | MEASURE_VOLUME_FLOW,
    MEASURE_POWER = 1 << 3,         /* W */
    MEASURE_PRESSURE = 1 << 4,      /* Pa */
    MEASURE_TEMPERATURE = 1 << 5,   /* K */
    MEASURE_DIFFERENCE = 1 << 6,    /* K, of temperatures */
    MEASURE_MOLE_FRACTION = 1 << 7, /* 1 */
    MEASURE_MASS_FRACTION = 1 << 8, /* 1 */
    MEASURE_NUMBER = 1 << 9,        /* 1 */
    MEASURE_AMOUNT = 1 << 10,       /* mol */
    MEASURE_CAPACITY = 1 << 11      /* share of what a vessel holds */
};

/* SI = (value + offset) * in, and back: value = SI * times / before * size / after - offset, where size turns moles
 * into kg or m3 for a molar flow shown as another one, and is 1 elsewhere. What does not apply is 1, or 0. The ways
 * back differ in the last bit only: each unit has the one with which it was first used, so that logs stay equal. */
struct column_unit {
    const char *name;
    enum column_measure measure;
    double offset, in, times, before, after;
};

/* The unit of that name for one of the measures; NULL when there is none. */
const struct column_unit *column_unit_find(const char *name, unsigned measures);

/* The k-th unit; NULL past the end. */
const struct column_unit *column_unit_at(size_t k);

/* Names of all units for the measures, "K, degC". */
void column_unit_names(unsigned measures, char *text, size_t size);

#endif
