#include "kinds/column/column.h"

#include <string.h>

#include "base/assertion.h"
#include "base/text.h"

#define NAME_SIZE (COLUMN_TABLE_NAME_SIZE + 9) /* with what stands in front of it */

/* State: values for the console. */
struct column_state {
    float size, stages, feed_stage, states;
    float feed[COLUMN_TABLE_COMPONENTS];
    char table[NAME_SIZE];
    char component[COLUMN_TABLE_COMPONENTS][NAME_SIZE];
    uint8_t components;
};

static const struct block_parameter parameters[] = {
    {.id = 1,
     .type = BLOCK_U16,
     .offset = offsetof(struct column_record, version),
     .name = "version",
     .unit = "",
     .help = "of the form of the table: 1",
     .lo = 0,
     .hi = 65535,
     .initial = 0},
    {.id = 2,
     .type = BLOCK_U16,
     .offset = offsetof(struct column_record, size),
     .name = "size",
     .unit = "",
     .help = "values of the table that count",
     .lo = 0,
     .hi = 65535,
     .initial = 0},
    {.id = 3,
     .type = BLOCK_U16,
     .offset = offsetof(struct column_record, checksum),
     .rows = 1,
     .cols = 2,
     .name = "checksum",
     .unit = "",
     .help = "of version, size and values, upper and lower half",
     .lo = 0,
     .hi = 65535,
     .initial = 0},
    {.id = 4,
     .type = BLOCK_FLOAT,
     .offset = offsetof(struct column_record, value),
     .rows = COLUMN_TABLE_ROWS,
     .cols = COLUMN_TABLE_COLS,
     .name = "value",
     .unit = "",
     .help = "what reflux-sim --table prints, in SI units",
     .lo = -1e30f,
     .hi = 1e30f,
     .initial = 0},
};

enum err column_record_read(const struct column_record *record, struct column_table *table,
                            struct column_fault *fault)
{
    struct column_table_text text = {.version = record->version,
                                     .size = record->size,
                                     .checksum = column_record_checksum(record),
                                     .value = record->value};
    return column_table_read(&text, table, fault);
}

enum err column_record_open(const struct column_record *record, struct column_table *table,
                            struct column *column)
{
    struct column_fault fault;
    enum err err = column_record_read(record, table, &fault);
    return err ? err : column_init(column, &table->config, &fault);
}

static uint32_t column_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct column_state);
}

static enum err column_check(const struct block_setup *setup, struct block_fault *fault)
{
    struct column_table table;
    struct column_fault reason;
    enum err err = column_record_read(setup->settings, &table, &reason);
    *fault = (struct block_fault){
        .field = err ? reason.field : "", .wanted = err ? reason.wanted : "", .must_be = true};
    return err;
}

static void name_it(char text[NAME_SIZE], const char *what, const float *value)
{
    char name[COLUMN_TABLE_NAME_SIZE];
    struct text t = text_on(text, NAME_SIZE);
    (void)column_table_name(value, name);
    text_str(&t, what);
    text_str(&t, name);
}

/* Runs in the tick: it looks values up that check() has accepted, and does not read the table again. */
static enum err column_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct column_state *c = state;
    const struct column_record *record = setup->settings;
    const float *v = record->value, *component = v + COLUMN_TABLE_FIXED;
    (void)retune;
    memset(c, 0, sizeof *c);
    c->size = (float)record->size;
    c->stages = v[COLUMN_TABLE_N_STAGES];
    c->components = (uint8_t)v[COLUMN_TABLE_N_COMPONENTS];
    c->feed_stage = v[COLUMN_TABLE_FEED_STAGE];
    c->states = c->stages * (float)(c->components - 1u) -
                (float)column_table_count(v + COLUMN_TABLE_TRUNCATED);
    name_it(c->table, "table of ", v + COLUMN_TABLE_TITLE);
    REFLUX_ASSERT(c->components <= COLUMN_COMPONENTS_MAX);
    for (unsigned j = 0; j < c->components; j++, component += COLUMN_TABLE_C_VALUES) {
        name_it(c->component[j], "feed of ", component + COLUMN_TABLE_C_NAME);
        c->feed[j] = component[COLUMN_TABLE_C_FEED];
    }
    return ERR_OK;
}

static void column_rest(void *state, struct block_io *io)
{
    (void)state;
    (void)io;
}

static const char *column_describe(const void *state, size_t i, float *value)
{
    const struct column_state *c = state;
    const char *const names[] = {c->table, "stages", "feed_stage", "states"};
    const float values[] = {c->size, c->stages, c->feed_stage, c->states};
    size_t fixed = sizeof values / sizeof values[0];
    if (i < fixed) {
        *value = values[i];
        return names[i];
    }
    if (i - fixed >= c->components)
        return NULL;
    *value = c->feed[i - fixed];
    return c->component[i - fixed];
}

const struct block_kind column_kind = {
    .name = "column",
    .stage = STAGE_ESTIMATE,
    .parameter = parameters,
    .parameters = sizeof parameters / sizeof parameters[0],
    .settings_bytes = sizeof(struct column_record),
    .table = true,
    .bytes = column_bytes,
    .check = column_check,
    .configure = column_configure,
    .step = column_rest,
    .describe = column_describe,
};
