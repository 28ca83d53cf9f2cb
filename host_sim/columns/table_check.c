/* As the board reads a table: in float, by the board's code. */
#include <string.h>

#include "columns/table_lines.h"
#include "model/column_table.h"

void table_close(struct table_lines *lines, unsigned size)
{
    lines->version = COLUMN_TABLE_VERSION;
    lines->size = (uint16_t)size;
    uint32_t sum = column_table_checksum(lines->version, lines->size, lines->value);
    lines->checksum[0] = (uint16_t)(sum >> 16);
    lines->checksum[1] = (uint16_t)sum;
}

static bool evaluate(const struct column_table *table, struct table_says *says, char *err,
                     size_t err_size)
{
    static struct column column;
    struct column_fault fault;
    enum err e = column_init(&column, &table->config, &fault);
    if (!e)
        e = column_set_inputs(&column, &table->nominal, &fault);
    if (e) {
        (void)snprintf(err, err_size, "%s: must be %s", fault.field, fault.wanted);
        return false;
    }
    if (column_evaluate(&column, table->profile) != ERR_OK) {
        (void)snprintf(err, err_size,
                       "profile: must be of compositions that boil in the temperature range");
        return false;
    }
    for (unsigned s = 0; s < says->stages; s++)
        says->temperature[s] = (double)column.temperature[s];
    return true;
}

bool table_check(const struct table_lines *lines, struct table_says *says, char *err,
                 size_t err_size)
{
    struct column_table table;
    struct column_fault fault;
    struct column_table_text text = {.version = lines->version,
                                     .size = lines->size,
                                     .checksum =
                                         (uint32_t)lines->checksum[0] << 16 | lines->checksum[1],
                                     .value = lines->value};
    memset(says, 0, sizeof *says);
    if (column_table_read(&text, &table, &fault) != ERR_OK) {
        (void)snprintf(err, err_size, "%s: must be %s", fault.field, fault.wanted);
        return false;
    }
    memcpy(says->title, table.title, sizeof says->title);
    memcpy(says->component, table.name, sizeof says->component);
    says->stages = (unsigned)table.config.stages;
    says->components = (unsigned)table.config.components;
    says->feed_stage = (unsigned)table.config.feed_stage;
    says->states = (unsigned)column_table_states(&table);
    says->truncated = says->stages * (says->components - 1u) - says->states;
    return evaluate(&table, says, err, err_size);
}
