#include "columns/table_lines.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "bench/text.h"

#define LINE_SIZE 512

void table_lines_print(FILE *to, unsigned block, const struct table_lines *lines)
{
    (void)fprintf(to,
                  "begin\nset block%u.kind -\nset block%u.kind column\nset block%u.version %u\n"
                  "set block%u.size %u\nset block%u.checksum.1 %u,%u\n",
                  block, block, block, lines->version, block, lines->size, block,
                  lines->checksum[0], lines->checksum[1]);
    for (unsigned i = 0; i < lines->size && i < COLUMN_TABLE_MOST; i += COLUMN_TABLE_COLS) {
        char row[COLUMN_TABLE_COLS * 16];
        struct text t = text_on(row, sizeof(row));
        for (unsigned k = 0; k < COLUMN_TABLE_COLS; k++) {
            text_str(&t, k > 0 ? "," : "");
            text_float(&t, lines->value[i + k]);
        }
        (void)fprintf(to, "set block%u.value.%u %s\n", block, i / COLUMN_TABLE_COLS + 1u, row);
    }
    (void)fputs("apply\n", to);
}

/* Numbers with commas between them. */
static bool parse_floats(const char *text, unsigned n, float *x)
{
    char copy[LINE_SIZE], *at = copy;
    (void)snprintf(copy, sizeof(copy), "%s", text);
    for (unsigned k = 0; k < n; k++) {
        char *end = strchr(at, ',');
        if ((end == NULL) != (k + 1u == n)) {
            return false;
        }
        if (end != NULL) {
            *end = '\0';
        }
        if (text_parse_float(at, &x[k]) != ERR_OK) {
            return false;
        }
        at = end != NULL ? end + 1 : at;
    }
    return true;
}

static bool parse_u16s(const char *text, unsigned n, uint16_t *x)
{
    float f[2];
    if (!parse_floats(text, n, f)) {
        return false;
    }
    for (unsigned k = 0; k < n; k++) {
        if (!(f[k] >= 0.0f && f[k] <= 65535.0f && f[k] == (float)(uint16_t)f[k])) {
            return false;
        }
        x[k] = (uint16_t)f[k];
    }
    return true;
}

/* NULL, or what it must be. */
static const char *take(struct table_lines *lines, const char *field, const char *value)
{
    static const char whole[] = "a whole number from 0 to 65535";
    unsigned row = 0;
    if (strcmp(field, "version") == 0) {
        return parse_u16s(value, 1, &lines->version) ? NULL : whole;
    }
    if (strcmp(field, "size") == 0) {
        return parse_u16s(value, 1, &lines->size) ? NULL : whole;
    }
    if (strcmp(field, "checksum.1") == 0) {
        return parse_u16s(value, 2, lines->checksum) ? NULL : "two whole numbers from 0 to 65535";
    }
    if (strncmp(field, "value.", 6) == 0) {
        row = (unsigned)strtoul(field + 6, NULL, 10);
    }
    if (row < 1 || row > COLUMN_TABLE_ROWS) {
        return "version, size, checksum.1 or value.1 to the last row of a table";
    }
    return parse_floats(value, COLUMN_TABLE_COLS,
                        lines->value + (size_t)(row - 1u) * COLUMN_TABLE_COLS)
               ? NULL
               : "eight numbers with commas between them";
}

bool table_lines_read(FILE *from, const char *file, struct table_lines lines[TABLE_BLOCKS],
                      bool has[TABLE_BLOCKS], char *err, size_t err_size)
{
    char line[LINE_SIZE], field[LINE_SIZE], value[LINE_SIZE];
    bool any = false;
    memset(lines, 0, TABLE_BLOCKS * sizeof(lines[0]));
    memset(has, 0, TABLE_BLOCKS * sizeof(has[0]));
    for (unsigned number = 1; fgets(line, sizeof(line), from) != NULL; number++) {
        unsigned block = 0;
        if (sscanf(line, " set block%1u.%511s %511s", &block, field, value) != 3 || block < 1 ||
            block > TABLE_BLOCKS) {
            continue;
        }
        bool *is = &has[block - 1u];
        if (strcmp(field, "kind") == 0) {
            *is = strcmp(value, "column") == 0;
            memset(&lines[block - 1u], 0, sizeof(lines[0]));
        } else if (*is && strcmp(field, "loops") != 0 && strcmp(field, "inputs") != 0 &&
                   strcmp(field, "points") != 0) {
            const char *wanted = take(&lines[block - 1u], field, value);
            if (wanted != NULL) {
                return sim_fail(err, err_size, "%s:%u: block%u.%s: must be %s", file, number, block,
                                field, wanted);
            }
        }
    }
    for (unsigned n = 0; n < TABLE_BLOCKS; n++) {
        any = any || has[n];
    }
    return any || sim_fail(err, err_size, "%s: no line `set blockN.kind column`", file);
}
