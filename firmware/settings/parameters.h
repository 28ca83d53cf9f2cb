/* Parameters: every field of struct config, declared once in parameter_table.c. Console, manual and
 * storage use that declaration.
 *
 * A parameter is named group[index].field: "loop1.gain", "meas3.lo", "tick.base". Its id never changes
 * meaning: group << 12 | field << 6 | index (0-based), of blocks group << 24 | field << 16 | row << 6 | index.
 * The fields of a block up to 63 are those of parameter_table.c. The fields from 64 on are the rows of its kind, which
 * differ from kind to kind (block/block.h).
 */
#ifndef REFLUX_SETTINGS_PARAMETERS_H
#define REFLUX_SETTINGS_PARAMETERS_H

#include <stdbool.h>

#include "settings/parameter_table.h"

/* Sets every parameter to its default. */
void parameters_defaults(struct config *config);
/* Returns the default as a number; 0 for names and units. */
float parameter_initial(const struct parameter *p);

/* Gets the n-th of all parameters in the order of the table, without those of blocks. Returns false past the end. */
bool parameter_at(unsigned n, struct parameter *p);
/* Finds a parameter by name, without those of blocks. ERR_UNKNOWN: no such group, index or field. ERR_UNSUPPORTED: larger
 * boards have that index; only group and field of *p are then valid. */
MUST_CHECK enum err parameter_find(const char *name, struct parameter *p);
/* Get and find the same with those of blocks, which depend on their kinds in *config. The name may begin with the name of a loop,
 * a measurement or a manipulated variable ("bottom.gain"): the first of these, in this order, that has such a parameter. The result is valid for that
 * configuration, or one where the block has the same kind. ERR_EMPTY: the block has no kind, or this build lacks it. */
bool parameter_of(const struct config *config, unsigned n, struct parameter *p);
MUST_CHECK enum err parameter_find_in(const struct config *config, const char *name,
                                      struct parameter *p);
#if CONFIG_PEOPLE
#define PARAMETER_OWNERS 3u /* loop, measurement, manipulated variable */
/* Writes "loop2.gain" for "bottom.gain", where the k-th kind of owner has one of that name in *config. Returns false where it has none. */
bool parameter_numbered_name(const struct config *config, const char *name, unsigned k,
                             struct text *full);
#else
#define PARAMETER_OWNERS 1u /* which never has one */
static inline bool parameter_numbered_name(const struct config *config, const char *name,
                                           unsigned k, struct text *full)
{
    (void)config;
    (void)name;
    (void)k;
    (void)full;
    return false;
}
#endif
unsigned parameter_count(const struct config *config);
uint32_t parameter_id(const struct parameter *p);
MUST_CHECK enum err parameter_find_id(const struct config *config, uint32_t id,
                                      struct parameter *p);
bool parameter_is_secret(const struct parameter *p);

/* Returns the unit of a row of the table. "EU": engineering units of the channel; "" for names and words. */
const char *field_unit(const struct parameter_field *field);
/* Returns the words of a PARAMETER_WORD, "off|on"; "" for others. */
const char *field_words(const struct parameter_field *field);
/* Return the same of every parameter, also of blocks, and its help text and limits. */
const char *parameter_unit(const struct parameter *p);
const char *parameter_word_list(const struct parameter *p);
const char *parameter_about(const struct parameter *p);
float parameter_lo(const struct parameter *p);
float parameter_hi(const struct parameter *p);

void parameter_name(const struct parameter *p, struct text *t);
void parameter_value(const struct parameter *p, const struct config *config, struct text *t);
/* Writes the default. The default of mv.max is mv.hi of that configuration. */
void parameter_default(const struct parameter *p, const struct config *config, struct text *t);
/* Writes the allowed values: "0 .. 100", "reverse|direct", "up to 15 letters, digits or _, - for none" */
void parameter_range(const struct parameter *p, struct text *t);
/* Sets a stored value, also of a block whose kind this build lacks. Returns false where the value is not allowed, or is a
 * kind that this build lacks. */
bool parameter_restore(const struct parameter *p, struct config *config, const char *value);
/* Prepares a parameter for writing through parameter_place(). ERR_FULL: it is in a table that others refer to, and there is
 * no place for a copy. */
MUST_CHECK enum err parameter_to_write(const struct parameter *p, struct config *config);
/* Return the address of the value, its bytes, and the number of words to choose from. For storage. */
void *parameter_place(const struct parameter *p, struct config *config);
size_t parameter_size(const struct parameter *p);
unsigned parameter_words(const struct parameter *p);
/* Returns whether the value is the one of parameters_defaults(). */
bool parameter_is_default(const struct parameter *p, const struct config *config);
/* Returns whether the parameter is that field of an mv. */
enum { PARAMETER_MV_HI = 4, PARAMETER_MV_MAX = 6 };
bool parameter_is_mv(const struct parameter *p, uint8_t field);
/* Returns the value of another parameter that is the default of p; NULL where the default of p is a number. */
const float *parameter_follows(const struct parameter *p, const struct config *config);
bool parameter_equal(const struct parameter *p, const struct config *a, const struct config *b);

/* Return the field that gives the type of the number, and the offset of the number in the value. */
const struct parameter_field *parameter_number_field(const struct parameter *p);
size_t parameter_number_offset(const struct parameter *p);
/* Sets a parameter from a text. A parameter whose default follows this one moves along while it has the same value. On an
 * error *config is unchanged. ERR_PARSE, ERR_RANGE, ERR_READ_ONLY. For blocks also: ERR_UNKNOWN: no such kind; ERR_FULL: no
 * room for its settings or for a copy of its table; ERR_UNSUPPORTED: this build lacks the block's kind; ERR_STATE: the block
 * has no kind; ERR_CONFLICT: a list has a name twice. */
MUST_CHECK enum err parameter_set(const struct parameter *p, struct config *config,
                                  const char *value);
/* Sets a parameter from a number: for a PARAMETER_WORD the place in its list, for a PARAMETER_ROW the value in column p->col.
 * ERR_PARSE: names and units are no numbers. */
MUST_CHECK enum err parameter_set_number(const struct parameter *p, struct config *config,
                                         float value);
/* Gets the value as such a number, to the nearest float. ERR_PARSE: names and units. */
MUST_CHECK enum err parameter_get_number(const struct parameter *p, const struct config *config,
                                         float *value);

#endif
