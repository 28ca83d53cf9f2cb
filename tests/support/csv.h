/* Reads the committed reference tables: numbers separated by commas, '#' lines are remarks, and the first
 * other line names the columns. */
#ifndef REFLUX_TESTS_CSV_H
#define REFLUX_TESTS_CSV_H

#include <stdio.h>
#include <stdlib.h>

/* Next row of exactly n numbers into values. 1 = a row, 0 = end of the table; stops the program on a row of
 * another length, so that a damaged table is never a passed test. */
static inline int csv_row(FILE *f, double *values, int n)
{
    char line[4096];
    while (fgets(line, sizeof line, f)) {
        char first = line[0];
        if (first == '#' || (first >= 'a' && first <= 'z'))
            continue;
        char *at = line;
        for (int i = 0; i < n; i++) {
            char *end;
            values[i] = strtod(at, &end);
            if (end == at || (i + 1 < n && *end != ',')) {
                fprintf(stderr, "bad row in reference table: %s", line);
                exit(2);
            }
            at = end + 1;
        }
        if (at[-1] == ',') {
            fprintf(stderr, "row too long in reference table: %s", line);
            exit(2);
        }
        return 1;
    }
    return 0;
}

static inline FILE *csv_open(const char *path)
{
    FILE *f = fopen(path, "r");
    if (!f) {
        fprintf(stderr, "cannot open %s (tests run in the folder tests/)\n", path);
        exit(2);
    }
    return f;
}

#endif
