/* Settings of blocks: each a record of the block's kind, the struct that its rows of parameters fill, in the pool of the
 * configuration. Records stand there in the order of their blocks without gaps, so that equal settings have equal
 * bytes whatever was set before. The record of a kind that is a table stands elsewhere (exchange/tables.h).
 */
#ifndef REFLUX_EXCHANGE_BLOCK_SETTINGS_H
#define REFLUX_EXCHANGE_BLOCK_SETTINGS_H

#include "exchange/block_kinds.h"
#include "exchange/config.h"

/* Of a table: a row is set in one line and stored in one piece. So many values of nine digits with sign and exponent, and the
 * name, are a line that the console takes and prints (LINE_EDITOR_MAX, CONSOLE_OUTPUT_MAX). */
#define RECORD_COLS_MAX 8
#define RECORD_ROWS_MAX 1024

/* May blockN.kind be that? Kinds without parameters have them elsewhere (loopN, decoupleN, ffN); one with a larger table
 * cannot be. */
bool block_kind_has_record(uint8_t kind);
/* Kind of block n: a place in block_kinds[]. PLAN_NONE: unused, unknown to this build, or its record found no room. */
uint8_t config_block_kind(const struct config *config, uint8_t n);
/* Settings of block n, the struct of its kind; NULL where config_block_kind() is PLAN_NONE. */
const void *config_record(const struct config *config, uint8_t n);
/* "block2.tune": what is told to, or said by, block n. */
void block_word_name(uint8_t n, const char *word, char name[CHANNEL_NAME_SIZE]);

/* Values of a parameter: more than one is a table. */
static inline uint32_t block_value_count(const struct block_parameter *p)
{
    uint32_t count = (uint32_t)p->rows * p->cols;
    return count ? count : 1u;
}

/* Bytes of one value. */
static inline size_t block_value_size(uint8_t type)
{
    return type == BLOCK_FLOAT ? sizeof(float) : type == BLOCK_U16 ? sizeof(uint16_t) : 1u;
}

#endif
