/* One parameter: the row that declares it, the group it is in, which of the group it is. parameters.h says what can be done with it. */
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
    PARAMETER_NAME,  /* char[CHANNEL_NAME_SIZE]: letters, digits, _ ; "-" writes an empty one */
    PARAMETER_UNIT, /* char[CHANNEL_UNIT_SIZE]: printable without blanks; "-" writes an empty one */
    /* Of blocks (settings/block_parameters.h) */
    PARAMETER_KIND, /* char[CHANNEL_NAME_SIZE]: of a kind in block_kinds[]; "-" for none */
    PARAMETER_LIST, /* names with commas between them; "-" for none */
    PARAMETER_ROW   /* of a table: values with commas between them */
};

/* Of a block's own parameters the field of the id is this and the id in the kind. */
#define PARAMETER_OWN_ID 64u

/* In place of the unit of a PARAMETER_NAME: never shown. Its value reads "***" when there is one, and setting it to
 * "***" leaves it as it is, so that what `diff` and `dump` print can be pasted. */
#define PARAMETER_SECRET "***"

/* Likewise: it may also name an event of a block, "block2.drift". */
#define PARAMETER_SUBJECT "."

struct parameter_field {
    uint8_t id; /* 0..63, unique in its group, never used again for something else */
    uint8_t type;
    uint16_t offset; /* in the group's struct */
    const char *name;
    /* Of PARAMETER_WORD the words; of PARAMETER_NAME PARAMETER_SECRET, PARAMETER_SUBJECT or "". */
    const char *unit;
    const char *help;
    uint8_t lo, hi, initial; /* places in a list of numbers: field_lo() ... */
    bool if_set; /* stored and dumped only where it is not the default, which never changes */
};

struct parameter_group {
    uint8_t id; /* 1..15, of blocks 16 */
    uint8_t count;
    uint8_t n_fields;
    bool indexed;
    uint16_t offset, stride; /* in struct config */
    const char *name;
    const struct parameter_field *fields;
    uint8_t most; /* count of the largest board */
};

struct parameter {
    const struct parameter_group *group;
    const struct parameter_field *field; /* of a row of a kind the type only */
    uint8_t index;
    uint8_t col;                       /* the value of a row that is meant as a number */
    uint16_t row;                      /* of a table */
    const struct block_parameter *own; /* row of the block's kind, or NULL: see parameter_own() */
};

extern const struct parameter_group parameter_groups[];
extern const unsigned parameter_group_count;
extern const struct parameter_group parameter_blocks; /* not among those */
extern const struct parameter_field parameter_own_fields[4];

/* The row of a block's kind that a parameter is, or NULL. A board without blocks knows that it is NULL when it is compiled. */
static inline const struct block_parameter *parameter_own(const struct parameter *p)
{
    return CONFIG_BLOCKS ? p->own : NULL;
}
static inline bool parameter_is_of_block(const struct parameter *p)
{
    return CONFIG_BLOCKS && p->group == &parameter_blocks;
}
/* It may name an event of a block. */
static inline bool parameter_names_event(const struct parameter *p)
{
    return CONFIG_BLOCKS && p->field->unit[0] == PARAMETER_SUBJECT[0];
}

/* Limits and default of a row of the table. */
float field_lo(const struct parameter_field *field);
float field_hi(const struct parameter_field *field);
float field_initial(const struct parameter_field *field);

#endif
