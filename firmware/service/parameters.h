/* Parameters: every field of struct config, declared once in parameter_table.c. Console, manual and
 * storage come from that declaration.
 *
 * A parameter is named group[index].field: "loop1.gain", "meas3.lo", "tick.base". Its id never changes
 * meaning: group << 12 | field << 6 | index (0-based).
 */
#ifndef REFLUX_SERVICE_PARAMETERS_H
#define REFLUX_SERVICE_PARAMETERS_H

#include <stdbool.h>

#include "base/error.h"
#include "base/text.h"
#include "supervise/config.h"

enum parameter_type {
    PARAMETER_FLOAT,
    PARAMETER_U32,
    PARAMETER_U16,
    PARAMETER_FIXED, /* uint32_t that cannot be set */
    PARAMETER_WORD,  /* uint8_t, index into words ("reverse|direct") */
    PARAMETER_NAME,  /* char[CHANNEL_NAME_SIZE]: letters, digits, _ ; "-" writes an empty one */
    PARAMETER_UNIT /* char[CHANNEL_UNIT_SIZE]: printable without blanks; "-" writes an empty one */
};

/* In place of the unit of a PARAMETER_NAME: never shown. Its value reads "***" when there is one, and setting it to
 * "***" leaves it as it is, so that what `diff` and `dump` print can be pasted. */
#define PARAMETER_SECRET "***"

struct parameter_field {
    uint8_t id; /* 0..63, unique in its group, never used again for something else */
    uint8_t type;
    uint16_t offset; /* in the group's struct */
    const char *name;
    const char *unit; /* of PARAMETER_WORD the words; of PARAMETER_NAME PARAMETER_SECRET or "" */
    const char *help;
    uint8_t lo, hi, initial; /* places in a list of numbers: field_lo() ... */
};

struct parameter_group {
    uint8_t id; /* 1..15 */
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
    const struct parameter_field *field;
    uint8_t index;
};

extern const struct parameter_group parameter_groups[];
extern const unsigned parameter_group_count;

/* Every parameter at its default. */
void parameters_defaults(struct config *config);

/* The n-th of all parameters in the order of the table; false past the end. */
bool parameter_at(unsigned n, struct parameter *p);
/* ERR_UNKNOWN: no such group, index or field. ERR_UNSUPPORTED: larger boards have that index; *p then tells group and
 * field only. */
MUST_CHECK enum err parameter_find(const char *name, struct parameter *p);
uint16_t parameter_id(const struct parameter *p);
MUST_CHECK enum err parameter_find_id(uint16_t id, struct parameter *p);
bool parameter_is_secret(const struct parameter *p);

/* "EU": engineering units of the channel; "" for names and words. */
const char *field_unit(const struct parameter_field *field);
/* "off|on", of a PARAMETER_WORD. */
const char *field_words(const struct parameter_field *field);
float field_lo(const struct parameter_field *field);
float field_hi(const struct parameter_field *field);
float field_initial(const struct parameter_field *field);

void parameter_name(const struct parameter *p, struct text *t);
void parameter_value(const struct parameter *p, const struct config *config, struct text *t);
void parameter_default(const struct parameter *p, struct text *t);
/* "0 .. 100", "reverse|direct", "name of up to 15 letters, digits, _" */
void parameter_range(const struct parameter *p, struct text *t);
/* For storage: where the value is, how many bytes it has, how many words there are to choose from. */
void *parameter_place(const struct parameter *p, struct config *config);
size_t parameter_size(const struct parameter *p);
unsigned parameter_words(const struct parameter *p);
bool parameter_is_default(const struct parameter *p, const struct config *config);
bool parameter_equal(const struct parameter *p, const struct config *a, const struct config *b);

/* ERR_PARSE, ERR_RANGE, ERR_READ_ONLY: *config is unchanged. */
MUST_CHECK enum err parameter_set(const struct parameter *p, struct config *config,
                                  const char *value);
/* The same from a number; of a PARAMETER_WORD its place in the list. ERR_PARSE: names and units are no numbers. */
MUST_CHECK enum err parameter_set_number(const struct parameter *p, struct config *config,
                                         float value);
/* What it has, as such a number, as near as a float comes to it. ERR_PARSE: names and units. */
MUST_CHECK enum err parameter_get_number(const struct parameter *p, const struct config *config,
                                         float *value);

#endif
