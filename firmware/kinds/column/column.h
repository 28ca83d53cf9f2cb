/* A kind of the estimate stage that estimates nothing: its settings are the compact table of a column (model/column_table.h,
 * docs/methods/column-table.md), which other blocks name. No member, no input, no point. */
#ifndef REFLUX_COLUMN_COLUMN_H
#define REFLUX_COLUMN_COLUMN_H

#include "block/block.h"
#include "model/column_table.h"

#if CONFIG_BLOCKS

/* Its settings, pasted in lines. */
struct column_record {
    uint16_t version, size;
    uint16_t checksum[2]; /* the upper and the lower half */
    float value[COLUMN_TABLE_MOST];
};

static inline uint32_t column_record_checksum(const struct column_record *record)
{
    return (uint32_t)record->checksum[0] << 16 | record->checksum[1];
}

/* Reads a record: of the block itself, or `named` in the setup of one that names it. The record must stay as long as the table is
 * used. Errors as column_table_read(). */
MUST_CHECK enum err column_record_read(const struct column_record *record,
                                       struct column_table *table, struct column_fault *fault);
/* Reads it and makes the column of that table, which has to stay. Errors as column_record_read() and column_init(). */
MUST_CHECK enum err column_record_open(const struct column_record *record,
                                       struct column_table *table, struct column *column);

extern const struct block_kind column_kind;

#endif
#endif
