/* Declaration of a parameter: its row, its group, and its index in the group. parameters.h has the functions on parameters. */
#ifndef REFLUX_SETTINGS_PARAMETER_TABLE_H
#define REFLUX_SETTINGS_PARAMETER_TABLE_H

#include <stdbool.h>

#include "base/error.h"
#include "base/text.h"
#include "exchange/config.h"
#include "settings/block_parameters.h"

enum parameter_type {
    PARAMETER_FLOAT,
    PARAMETER_U32,
    PARAMETER_U16,
    PARAMETER_FIXED, /* uint32_t that cannot be set */
    PARAMETER_WORD,  /* uint8_t, index into words ("reverse|direct") */
    PARAMETER_NAME,  /* char[CHANNEL_NAME_SIZE]: letters, digits, _ ; "-" sets it empty */
    PARAMETER_UNIT,  /* char[CHANNEL_UNIT_SIZE]: printable without blanks; "-" sets it empty */
    /* The next three are of blocks only (settings/block_parameters.h). */
    PARAMETER_KIND, /* char[CHANNEL_NAME_SIZE]: name of a kind in block_kinds[]; "-" for none */
    PARAMETER_LIST, /* names with commas between them; "-" for none */
    PARAMETER_ROW   /* row of a table: values with commas between them */
};

/* Added to the id in the kind, to give the field in the id of a block's own parameter. */
#define PARAMETER_OWN_ID 64u

/* Unit of a PARAMETER_NAME that nobody may read. Its value reads "***" when there is one. Setting it to "***" changes
 * nothing, so that the output of `diff` and `dump` can be pasted. */
#define PARAMETER_SECRET "***"

/* Unit of a PARAMETER_NAME that may also name an event of a block, "block2.drift". */
#define PARAMETER_SUBJECT "."

struct parameter_field {
    uint8_t id; /* 0..63, unique in its group, never used again for something else */
    uint8_t type;
    uint16_t offset; /* offset in the struct of the group */
    const char *name;
    /* The words of a PARAMETER_WORD; PARAMETER_SECRET, PARAMETER_SUBJECT or "" of a PARAMETER_NAME. */
    const char *unit;
    const char *help;
    uint8_t lo, hi, initial; /* places in a list of numbers: field_lo() ... */
    /* Stored and dumped only where it differs from the default, which never changes. */
    bool if_set;
};

struct parameter_group {
    uint8_t id; /* 1..15; 16 for blocks; 17.. with ids of more than 16 bits */
    uint8_t count;
    uint8_t n_fields;
    bool indexed;
    uint16_t offset, stride; /* place and distance of the elements in struct config */
    const char *name;
    const struct parameter_field *fields;
    uint8_t most; /* count of the largest board */
};

struct parameter {
    const struct parameter_group *group;
    const struct parameter_field *field; /* for a row of a kind, only its type is valid */
    uint8_t index;
    uint8_t col;                       /* index of the value in a row that is read as a number */
    uint16_t row;                      /* row of a table */
    const struct block_parameter *own; /* row of the block's kind, or NULL: see parameter_own() */
};

extern const struct parameter_group parameter_groups[];
extern const unsigned parameter_group_count;
extern const struct parameter_group parameter_blocks; /* not in parameter_groups[] */
extern const struct parameter_field parameter_own_fields[4];

/* Returns the row of a block's kind that declares the parameter, or NULL. Without blocks it is a constant NULL for the compiler. */
static inline const struct block_parameter *parameter_own(const struct parameter *p)
{
    return CONFIG_BLOCKS ? p->own : NULL;
}
static inline bool parameter_is_of_block(const struct parameter *p)
{
    return CONFIG_BLOCKS && p->group == &parameter_blocks;
}
/* Returns whether the value may name an event of a block. */
static inline bool parameter_names_event(const struct parameter *p)
{
    return CONFIG_BLOCKS && p->field->unit[0] == PARAMETER_SUBJECT[0];
}

/* Return the limits and the default of a row of the table. */
/* The list of numbers, each once. */
extern const float parameter_numbers[];
static inline float field_lo(const struct parameter_field *field)
{
    return parameter_numbers[field->lo];
}
static inline float field_hi(const struct parameter_field *field)
{
    return parameter_numbers[field->hi];
}
static inline float field_initial(const struct parameter_field *field)
{
    return parameter_numbers[field->initial];
}

#endif
