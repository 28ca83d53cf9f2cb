/* Tables of columns that nobody has made: a plausible one of any size, values of it written over, its checksum right or not.
 * Nothing crashes; what is refused names a field and says what it must be; what is accepted is a column that can be set up
 * with its nominal inputs and evaluated, with as many states as it says.
 *
 * Input: shape, then places and values.
 */
#include <math.h>
#include <string.h>

#include "fuzz.h"
#include "model/column_table.h"

static float values[COLUMN_TABLE_MOST];

static float some_float(struct feed *f)
{
    static const float odd[] = {0.0f, 1.0f,  -1.0f, 0.5f,  2.0f,   1e-30f, -1e30f, 1e30f,
                                3.0f, 40.0f, 41.0f, 37.0f, 300.0f, 1e-12f, 4.0f,   16777215.0f};
    uint8_t what = feed_byte(f);
    uint32_t bits = 0;
    float x;
    if (what < 128)
        return odd[what % (sizeof odd / sizeof odd[0])];
    for (unsigned k = 0; k < 4; k++)
        bits = bits << 8 | feed_byte(f);
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* C components one easier to boil than the other, constant relative volatility but for the temperature's sake. */
static unsigned plausible(unsigned stages, unsigned components, unsigned model)
{
    float *v = values;
    memset(values, 0, sizeof values);
    v[COLUMN_TABLE_TITLE] = 1.0f;
    v[COLUMN_TABLE_N_STAGES] = (float)stages;
    v[COLUMN_TABLE_N_COMPONENTS] = (float)components;
    v[COLUMN_TABLE_FEED_STAGE] = 2.0f;
    v[COLUMN_TABLE_EFFICIENCY] = 0.8f;
    v[COLUMN_TABLE_HOLDUP_REBOILER] = v[COLUMN_TABLE_HOLDUP_CONDENSER] = 10.0f;
    v[COLUMN_TABLE_HOLDUP_TRAY] = 1.0f;
    v[COLUMN_TABLE_LOWEST_K] = 250.0f;
    v[COLUMN_TABLE_HIGHEST_K] = 500.0f;
    v[COLUMN_TABLE_SOFTNESS] = 0.02f;
    v[COLUMN_TABLE_ACTIVITY] = (float)model;
    v[COLUMN_TABLE_FEED] = 1.0f;
    v[COLUMN_TABLE_FEED_BY] = v[COLUMN_TABLE_FEED_STATE] = 1.0f;
    v[COLUMN_TABLE_REFLUX] = 2.0f;
    v[COLUMN_TABLE_BOILUP_GIVEN] = 1.0f;
    v[COLUMN_TABLE_HEAT] = 2.5f;
    v[COLUMN_TABLE_PRESSURE] = 1e5f;
    float *at = v + COLUMN_TABLE_FIXED;
    for (unsigned j = 0; j < components; j++, at += COLUMN_TABLE_C_VALUES) {
        at[COLUMN_TABLE_C_NAME] = (float)(j + 1u);
        at[COLUMN_TABLE_C_ANTOINE] = 21.0f - 0.5f * (float)j;
        at[COLUMN_TABLE_C_ANTOINE + 1] = 3500.0f;
        at[COLUMN_TABLE_C_FEED] = 1.0f / (float)components;
    }
    at += COLUMN_TABLE_ACTIVITY_VALUES(model, components);
    for (unsigned i = 0; i < stages * (components - 1u); i++)
        *at++ = 1.0f / (float)components;
    return (unsigned)(at - v);
}

static void look(const struct column_table *table)
{
    static struct column column;
    struct column_fault fault;
    size_t truncated = 0;
    DEMAND(table->config.stages >= 4 && table->config.stages <= COLUMN_TABLE_STAGES);
    DEMAND(table->config.components >= 2 && table->config.components <= COLUMN_TABLE_COMPONENTS);
    DEMAND(column_init(&column, &table->config, &fault) == ERR_OK);
    DEMAND(column_set_inputs(&column, &table->nominal, &fault) == ERR_OK);
    for (size_t s = 1; s <= table->config.stages; s++)
        truncated += column_table_is_truncated(table, s);
    DEMAND(column_table_states(table) + truncated == column.n_states);
    if (column_evaluate(&column, table->profile) != ERR_OK)
        return;
    for (size_t s = 0; s < table->config.stages; s++)
        DEMAND(column.temperature[s] >= table->config.temperature_min &&
               column.temperature[s] <= table->config.temperature_max);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct feed f = {data, size};
    unsigned stages = 4u + feed_byte(&f) % 37u, components = 2u + feed_byte(&f) % 3u;
    unsigned n = plausible(stages, components, feed_byte(&f) % 3u);
    for (unsigned writes = feed_byte(&f) % 6u; writes; writes--) {
        unsigned place = (unsigned)feed_byte(&f) << 8 | feed_byte(&f);
        values[place % COLUMN_TABLE_MOST] = some_float(&f);
    }
    struct column_table_text text = {
        .version = COLUMN_TABLE_VERSION, .size = (uint16_t)n, .value = values};
    struct column_table table, moved;
    struct column_fault fault;
    uint8_t spoil = feed_byte(&f);
    text.checksum = column_table_checksum(text.version, text.size, values);
    if (spoil == 1)
        text.checksum ^= 1u << feed_byte(&f) % 32u;
    else if (spoil == 2)
        text.size = (uint16_t)(feed_byte(&f) << 8 | feed_byte(&f));
    else if (spoil == 3)
        text.version = feed_byte(&f);
    enum err err = column_table_read(&text, &table, &fault);
    if (err) {
        DEMAND(fault.field[0] && fault.wanted[0]);
        return 0;
    }
    look(&table);
    moved = table; /* as an arena does */
    memset(&table, 0xFF, sizeof table);
    column_table_moved(&moved);
    look(&moved);
    return 0;
}
