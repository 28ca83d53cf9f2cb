/* Settings of blocks with a number (blockN). The settings of each block are the struct that its kind's rows of
 * parameters fill, and stand in the pool of the configuration. They stand there in the order of their blocks
 * without gaps, so that equal settings have equal bytes, whatever was set before. The settings of a kind that is a
 * table stand elsewhere (exchange/tables.h). */
#ifndef REFLUX_EXCHANGE_BLOCK_SETTINGS_H
#define REFLUX_EXCHANGE_BLOCK_SETTINGS_H

#include "exchange/block_kinds.h"
#include "exchange/config.h"

/* Limits of a table. A row is set in one line and stored in one piece: the name and this many values of nine digits
 * with sign and exponent fit a line that the console takes and prints (LINE_EDITOR_MAX, CONSOLE_OUTPUT_MAX). */
#define BLOCK_COLS_MAX 8
#define BLOCK_ROWS_MAX 1024

/* Returns true if blockN.kind may select this kind. Kinds without parameters have them elsewhere (loopN, decoupleN,
 * ffN), and a kind with a larger table than the limits allow cannot be selected. */
bool block_kind_is_numbered(uint8_t kind);
/* Returns the kind of block n, a place in block_kinds[]. PLAN_NONE: the block is unused, its kind is unknown to
 * this build, or its settings found no room. */
uint8_t config_block_kind(const struct config *config, uint8_t n);
/* Returns the settings of block n, the struct of its kind; NULL where config_block_kind() is PLAN_NONE. */
const void *config_block_settings(const struct config *config, uint8_t n);
/* Writes the name of a verb or event of block n, such as "block2.tune". */
void block_word_name(uint8_t n, const char *word, char name[CHANNEL_NAME_SIZE]);

/* Returns the number of values of a parameter; a parameter with more than one is a table. */
static inline uint32_t block_value_count(const struct block_parameter *p)
{
    uint32_t count = (uint32_t)p->rows * p->cols;
    return count ? count : 1u;
}

/* Returns the bytes of one value. */
static inline size_t block_value_size(uint8_t type)
{
    return type == BLOCK_FLOAT ? sizeof(float) : type == BLOCK_U16 ? sizeof(uint16_t) : 1u;
}

#endif
