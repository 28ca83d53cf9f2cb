#include "columns/table_task.h"

#include <math.h>
#include <string.h>

#include "bench/text.h"
#include "columns/column_plant.h"
#include "columns/column_table_make.h"

#define TABLE_BYTES(size)                                                                          \
    (4u * (size) + 8u) /* of the settings; the board's places are as large as the largest */

/* "# splitter: 37 stages, feed on 19, ..." */
static void print_says(const struct table_lines *lines, const struct table_says *says)
{
    double lowest = says->temperature[0], highest = lowest;
    (void)printf("# %s: %u stages, feed on %u, components", says->title, says->stages,
                 says->feed_stage);
    for (unsigned j = 0; j < says->components; j++) {
        (void)printf(" %s", says->component[j]);
    }
    (void)printf(" (the last closes), %u states", says->states);
    if (says->truncated > 0) {
        (void)printf(" (%u stages truncated)", says->truncated);
    }
    for (unsigned s = 1; s < says->stages; s++) {
        lowest = fmin(lowest, says->temperature[s]);
        highest = fmax(highest, says->temperature[s]);
    }
    (void)printf("\n# %u values, %u bytes; nominal temperatures %.2f to %.2f K\n", lines->size,
                 TABLE_BYTES(lines->size), lowest, highest);
}

/* Largest difference of its bubble points from those of the column it was made from. */
static void print_difference(const struct column *column, const struct table_says *says)
{
    double most = 0.0;
    unsigned at = 0;
    for (unsigned s = 0; s < says->stages; s++) {
        double away = says->temperature[s] - column->temperature[s];
        if (fabs(away) > fabs(most)) {
            most = away;
            at = s;
        }
    }
    (void)printf("# its temperatures are off by at most %+.3f K (stage %u) at the nominal state\n",
                 most, at + 1u);
    if (column->config->levels != COLUMN_LEVELS_PERFECT || column->config->hydraulic_time > 0.0) {
        (void)puts("# levels and hydraulics are left out: holdups of a table are constant");
    }
}

/* Heat loss at the present inputs, W. */
static double heat_loss_of(const struct plant_class *class, const struct plant *p)
{
    const struct column_terms *terms = class->column->terms;
    for (size_t k = 0; k < terms->n_driven; k++) {
        if (terms->driven[k].drive == DRIVE_HEAT_LOSS) {
            return (k < terms->n_inputs ? class->value(p, k) : terms->driven[k].value) *
                   terms->driven[k].unit->in;
        }
    }
    return 0.0;
}

bool table_task_make(const struct plant_class *class, const struct plant *p,
                     const struct table_task *task, struct table_lines *lines,
                     struct table_says *says, char *err, size_t err_size)
{
    struct table_wish wish = {task->components, task->closing, task->truncated, task->antoine};
    char reason[SIM_ERROR_SIZE] = "";
    if (class->column == NULL) {
        return sim_fail(err, err_size, "--table: %s is not a column of docs/use/columns.md",
                        class->name);
    }
    return column_table_make(column_plant_column(p), column_plant_state(p), class->name,
                             heat_loss_of(class, p), &wish, lines, err, err_size) &&
           (table_check(lines, says, reason, sizeof(reason)) ||
            sim_fail(err, err_size, "--table: the board would refuse it: %s", reason));
}

bool table_task_print(const struct plant_class *class, const struct plant *p,
                      const struct table_task *task, char *err, size_t err_size)
{
    struct table_lines lines;
    struct table_says says = {.stages = 0};
    if (task->block != floor(task->block)) {
        return sim_fail(err, err_size, "--block %g: must be a whole number from 1 to 4",
                        task->block);
    }
    if (!table_task_make(class, p, task, &lines, &says, err, err_size)) {
        return false;
    }
    print_says(&lines, &says);
    print_difference(column_plant_column(p), &says);
    table_lines_print(stdout, (unsigned)task->block, &lines);
    return true;
}

bool table_task_check(const char *file, char *err, size_t err_size)
{
    static struct table_lines lines[TABLE_BLOCKS];
    bool has[TABLE_BLOCKS], good;
    FILE *from = sim_open_text(file, err, err_size);
    if (from == NULL) {
        return false;
    }
    good = table_lines_read(from, file, lines, has, err, err_size);
    (void)fclose(from);
    for (unsigned n = 0; n < TABLE_BLOCKS && good; n++) {
        struct table_says says = {.stages = 0};
        char reason[SIM_ERROR_SIZE] = "";
        if (!has[n]) {
            continue;
        }
        if (!table_check(&lines[n], &says, reason, sizeof(reason))) {
            return sim_fail(err, err_size, "%s: block%u.%s", file, n + 1u, reason);
        }
        (void)printf("# block%u\n", n + 1u);
        print_says(&lines[n], &says);
    }
    return good;
}
