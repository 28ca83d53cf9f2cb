/* The compact table of a column (docs/methods/column-table.md) as console lines to paste, and read from them. The same functions
 * write and read the numbers as on the board. No real_t here: whoever makes a table computes in double, the board, and who
 * checks a table as the board does, in float. */
#ifndef REFLUX_HOST_SIM_TABLE_LINES_H
#define REFLUX_HOST_SIM_TABLE_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "model/column_table_form.h"

#define TABLE_BLOCKS 4u /* block1 to block4 */

/* The table in the lines of one block. */
struct table_lines {
    uint16_t version, size, checksum[2];
    float value[COLUMN_TABLE_MOST];
};

/* Contents of a table, read with the code of the board. */
struct table_says {
    char title[COLUMN_TABLE_NAME_SIZE];
    char component[COLUMN_TABLE_COMPONENTS][COLUMN_TABLE_NAME_SIZE];
    unsigned stages, components, feed_stage, states, truncated;
    double temperature[COLUMN_TABLE_STAGES]; /* bubble points of the profile, K */
};

/* `begin` to `apply`. */
void table_lines_print(FILE *to, unsigned block, const struct table_lines *lines);
/* From a file of console lines, of every block that has `set blockN.kind column`; has[n] tells which. Other lines are passed
 * over. False: a line that is none, with its number in err; or no such block. */
bool table_lines_read(FILE *from, const char *file, struct table_lines lines[TABLE_BLOCKS],
                      bool has[TABLE_BLOCKS], char *err, size_t err_size);

/* table_check.c: reads the table as the board does, and evaluates its column once at the nominal state. False: what is wrong
 * in err, "feed_stage: must be 2 to stages - 2". */
bool table_check(const struct table_lines *lines, struct table_says *says, char *err,
                 size_t err_size);
/* Sets version and checksum. */
void table_close(struct table_lines *lines, unsigned size);

#endif
