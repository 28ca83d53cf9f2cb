/* Prints the simulator's tables for tools/reference: objects of plant files and their keys, quantities of a column, units, faults of a
 * virtual board. A line has
 * fields with tabs between them; the first field says what the line is.
 *
 *     plant_tables
 */
#include <math.h>
#include <stdio.h>

#include "columns/column_reader.h"
#include "columns/column_units.h"
#include "plants/file_keys.h"
#include "virtual_board/fault_table.h"

static void print_limits(const struct file_key *key)
{
    if (key->allowed != NULL)
        printf("%s", key->allowed);
    else
        printf("%g .. %g%s", key->lo, key->hi, key->type[0] == 'l' ? " of them" : "");
}

static void print_default(const struct file_key *key)
{
    if (key->otherwise != NULL)
        printf("%s", key->otherwise);
    else if (isnan(key->fallback))
        printf("required");
    else
        printf("%g", key->fallback);
}

static void print_objects(const char *kind, const struct file_object *object)
{
    for (; object->title != NULL; object++) {
        printf("object\t%s\t%s\t%s\n", kind, object->title, object->about);
        for (const struct file_key *key = object->keys; key->name != NULL; key++) {
            printf("key\t%s\t%s\t%s\t%s\t", object->title, key->name, key->type, key->unit);
            print_limits(key);
            printf("\t");
            print_default(key);
            printf("\t%s\t%s\n", key->about, key->models != NULL ? key->models : "");
        }
    }
}

/* Names of measures with their SI units, in the order of enum column_measure. */
static const char *const measures[][2] = {
    {"molar flow", "mol/s"},
    {"mass flow", "kg/s"},
    {"volume flow", "m3/s"},
    {"power", "W"},
    {"pressure", "Pa"},
    {"temperature", "K"},
    {"temperature difference", "K"},
    {"mole fraction", "-"},
    {"mass fraction", "-"},
    {"number", "-"},
    {"amount", "mol"},
    {"share of the capacity", "-"},
};
#define MEASURES (sizeof(measures) / sizeof(measures[0]))

static void print_measures(unsigned mask, unsigned which)
{
    const char *between = "";
    for (size_t k = 0; k < MEASURES; k++) {
        if ((mask & 1u << k) != 0) {
            printf("%s%s", between, measures[k][which]);
            between = ", ";
        }
    }
}

static void print_quantities(const char *kind, const struct column_quantity *(*row)(size_t k))
{
    for (size_t k = 0; row(k) != NULL; k++) {
        const struct column_quantity *q = row(k);
        printf("%s\t%s\t", kind, q->name);
        print_measures(q->measures, 0);
        printf("\t");
        print_measures(q->measures, 1);
        printf("\t%g\t%g\t%s\t%s\t%s%s%s\n", q->lo, q->hi, q->about,
               q->otherwise != NULL ? q->otherwise : "", (q->keys & KEY_STAGE) != 0 ? "stage " : "",
               (q->keys & KEY_STAGES) != 0 ? "stages " : "", (q->keys & KEY_OF) != 0 ? "of" : "");
    }
}

int main(void)
{
    print_objects("linear", linear_objects);
    print_objects("column", column_objects);
    print_quantities("drive", column_drive_row);
    print_quantities("sight", column_sight_row);
    for (size_t k = 0; column_unit_at(k) != NULL; k++) {
        const struct column_unit *unit = column_unit_at(k);
        printf("unit\t%s\t", unit->name);
        print_measures(unit->measure, 0);
        printf("\t");
        print_measures(unit->measure, 1);
        printf("\t%.9g\t%g\n", unit->in, unit->offset);
    }
    for (size_t k = 0; k < FAULT_KINDS; k++) {
        const struct fault_row *row = &fault_table[k];
        printf("fault\t%s\t%s\t%.10g .. %.10g\t%s\t%s\n", row->name, row->unit, row->lo, row->hi,
               row->whole ? "whole number" : "number", row->about);
    }
    return 0;
}
