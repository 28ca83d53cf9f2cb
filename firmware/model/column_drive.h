/* Inputs of a column as blocks measure them: one value after the other, in SI units. */
#ifndef REFLUX_MODEL_COLUMN_DRIVE_H
#define REFLUX_MODEL_COLUMN_DRIVE_H

#include "model/column_table.h"

enum column_drive {
    DRIVE_FEED, /* mol/s, kg/s or m3/s, as the table has it */
    DRIVE_FEED_TEMPERATURE,
    DRIVE_FEED_QUALITY,
    DRIVE_REFLUX,
    DRIVE_HEAT,
    DRIVE_BOILUP,
    DRIVE_PRESSURE
};

/* Returns the factor; 1 where none is given, which is 0. */
static inline float column_drive_factor(float factor)
{
    return factor < 0 || factor > 0 ? factor : 1.0f;
}

/* Takes a value into *inputs, kept within what a column of the table can have: flows from 0, the feed's temperature within the table's range, its
 * quality 0 to 2, the pressure half to twice the table's, beyond which its bubble points say nothing. The heat is less by what is lost. */
void column_drive_take(const struct column_table *table, struct column_inputs *inputs,
                       enum column_drive drive, real_t value);

/* Returns what would be right, in words, where the table has the other one: heat or boil-up, the feed's temperature or quality. NULL: it is
 * right. */
const char *column_drive_refused(const struct column_table *table, enum column_drive drive);

#endif
