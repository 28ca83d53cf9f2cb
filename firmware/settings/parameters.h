/* Parameters: every field of struct config, declared once in parameter_table.c. Console, manual and
 * storage come from that declaration.
 *
 * A parameter is named group[index].field: "loop1.gain", "meas3.lo", "tick.base". Its id never changes
 * meaning: group << 12 | field << 6 | index (0-based) of groups up to 15, else group << 24 | field << 16 | row << 6 | index.
 * Of a block the fields up to 63 are those of parameter_table.c, those from 64 on the rows of its kind, which differ from
 * kind to kind (block/block.h).
 */
#ifndef REFLUX_SETTINGS_PARAMETERS_H
#define REFLUX_SETTINGS_PARAMETERS_H

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
#if CONFIG_BLOCKS
    uint8_t col;                       /* the value of a row that is meant as a number */
    uint16_t row;                      /* of a table */
    const struct block_parameter *own; /* row of the block's kind, or NULL */
#endif
};

extern const struct parameter_group parameter_groups[];
extern const unsigned parameter_group_count;
#if CONFIG_BLOCKS
extern const struct parameter_group parameter_blocks; /* not among those */
extern const struct parameter_field parameter_own_fields[4];
#endif

/* Every parameter at its default. */
void parameters_defaults(struct config *config);

/* The n-th of all parameters in the order of the table; false past the end. Not those of blocks. */
bool parameter_at(unsigned n, struct parameter *p);
/* ERR_UNKNOWN: no such group, index or field. ERR_UNSUPPORTED: larger boards have that index; *p then tells group and
 * field only. Not those of blocks. */
MUST_CHECK enum err parameter_find(const char *name, struct parameter *p);
#if CONFIG_BLOCKS
/* The same with those of blocks, which depend on their kinds in *config. What is found is of that configuration, or of one
 * where the block has the same kind. ERR_EMPTY: the block has no kind, or this build lacks it. */
bool parameter_of(const struct config *config, unsigned n, struct parameter *p);
MUST_CHECK enum err parameter_find_in(const struct config *config, const char *name,
                                      struct parameter *p);
#else
#define parameter_of(config, n, p)         ((void)(config), parameter_at(n, p))
#define parameter_find_in(config, name, p) ((void)(config), parameter_find(name, p))
#endif
unsigned parameter_count(const struct config *config);
uint32_t parameter_id(const struct parameter *p);
MUST_CHECK enum err parameter_find_id(const struct config *config, uint32_t id,
                                      struct parameter *p);
bool parameter_is_secret(const struct parameter *p);

/* Of rows of the table. "EU": engineering units of the channel; "" for names and words. */
const char *field_unit(const struct parameter_field *field);
/* "off|on", of a PARAMETER_WORD. */
const char *field_words(const struct parameter_field *field);
float field_lo(const struct parameter_field *field);
float field_hi(const struct parameter_field *field);
float field_initial(const struct parameter_field *field);
/* The same of every parameter. */
#if CONFIG_BLOCKS
const char *parameter_unit(const struct parameter *p);
const char *parameter_word_list(const struct parameter *p);
const char *parameter_about(const struct parameter *p);
float parameter_lo(const struct parameter *p);
float parameter_hi(const struct parameter *p);
#else
#define parameter_unit(p)      field_unit((p)->field)
#define parameter_word_list(p) field_words((p)->field)
#define parameter_about(p)     ((p)->field->help)
#define parameter_lo(p)        field_lo((p)->field)
#define parameter_hi(p)        field_hi((p)->field)
#endif

void parameter_name(const struct parameter *p, struct text *t);
void parameter_value(const struct parameter *p, const struct config *config, struct text *t);
/* Of mv.max it is mv.hi of that configuration. */
void parameter_default(const struct parameter *p, const struct config *config, struct text *t);
/* "0 .. 100", "reverse|direct", "name of up to 15 letters, digits, _" */
void parameter_range(const struct parameter *p, struct text *t);
#if CONFIG_BLOCKS
/* Values as stored, also of a block whose kind this build lacks. False: it is no such value, or a kind it lacks. */
bool parameter_restore(const struct parameter *p, struct config *config, const char *value);
#endif
#if CONFIG_BLOCKS
/* Before it is written through parameter_place(). ERR_FULL: it is in a table that others refer to, and there is no place for
 * a copy. */
MUST_CHECK enum err parameter_to_write(const struct parameter *p, struct config *config);
#endif
/* For storage: where the value is, how many bytes it has, how many words there are to choose from. */
void *parameter_place(const struct parameter *p, struct config *config);
size_t parameter_size(const struct parameter *p);
unsigned parameter_words(const struct parameter *p);
/* Is it as parameters_defaults() leaves it? */
bool parameter_is_default(const struct parameter *p, const struct config *config);
/* Is it this field of an mv? */
enum { PARAMETER_MV_HI = 4, PARAMETER_MV_MAX = 6 };
bool parameter_is_mv(const struct parameter *p, uint8_t field);
/* The value that is the default of p and moves with another parameter; NULL: its default is a number of its own. */
const float *parameter_follows(const struct parameter *p, const struct config *config);
bool parameter_equal(const struct parameter *p, const struct config *a, const struct config *b);

#if CONFIG_BLOCKS
/* What is meant as a number: how it is kept, and where in the parameter. */
const struct parameter_field *parameter_number_field(const struct parameter *p);
size_t parameter_number_offset(const struct parameter *p);
#else
#define parameter_number_field(p)  ((p)->field)
#define parameter_number_offset(p) ((size_t)0)
#endif
/* A parameter whose default follows this one and has that value moves along.
 * ERR_PARSE, ERR_RANGE, ERR_READ_ONLY: *config is unchanged. Of blocks also ERR_UNKNOWN: no such kind, ERR_FULL: no room
 * for its settings (nor for a copy of its table), ERR_UNSUPPORTED: this build lacks the block's kind. */
MUST_CHECK enum err parameter_set(const struct parameter *p, struct config *config,
                                  const char *value);
/* The same from a number; of a PARAMETER_WORD its place in the list, of a PARAMETER_ROW that value of it that p->col says. ERR_PARSE:
 * names and units are no numbers. */
MUST_CHECK enum err parameter_set_number(const struct parameter *p, struct config *config,
                                         float value);
/* What it has, as such a number, as near as a float comes to it. ERR_PARSE: names and units. */
MUST_CHECK enum err parameter_get_number(const struct parameter *p, const struct config *config,
                                         float *value);

#endif
