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

#include "settings/parameter_table.h"

/* Every parameter at its default. */
void parameters_defaults(struct config *config);
/* The default as a number; 0 of names and units. */
float parameter_initial(const struct parameter *p);

/* The n-th of all parameters in the order of the table; false past the end. Not those of blocks. */
bool parameter_at(unsigned n, struct parameter *p);
/* ERR_UNKNOWN: no such group, index or field. ERR_UNSUPPORTED: larger boards have that index; *p then tells group and
 * field only. Not those of blocks. */
MUST_CHECK enum err parameter_find(const char *name, struct parameter *p);
/* The same with those of blocks, which depend on their kinds in *config. What is found is of that configuration, or of one
 * where the block has the same kind. ERR_EMPTY: the block has no kind, or this build lacks it. */
bool parameter_of(const struct config *config, unsigned n, struct parameter *p);
MUST_CHECK enum err parameter_find_in(const struct config *config, const char *name,
                                      struct parameter *p);
unsigned parameter_count(const struct config *config);
uint32_t parameter_id(const struct parameter *p);
MUST_CHECK enum err parameter_find_id(const struct config *config, uint32_t id,
                                      struct parameter *p);
bool parameter_is_secret(const struct parameter *p);

/* Of rows of the table. "EU": engineering units of the channel; "" for names and words. */
const char *field_unit(const struct parameter_field *field);
/* "off|on", of a PARAMETER_WORD. */
const char *field_words(const struct parameter_field *field);
/* The same of every parameter. */
const char *parameter_unit(const struct parameter *p);
const char *parameter_word_list(const struct parameter *p);
const char *parameter_about(const struct parameter *p);
float parameter_lo(const struct parameter *p);
float parameter_hi(const struct parameter *p);

void parameter_name(const struct parameter *p, struct text *t);
void parameter_value(const struct parameter *p, const struct config *config, struct text *t);
/* Of mv.max it is mv.hi of that configuration. */
void parameter_default(const struct parameter *p, const struct config *config, struct text *t);
/* "0 .. 100", "reverse|direct", "name of up to 15 letters, digits, _" */
void parameter_range(const struct parameter *p, struct text *t);
/* Values as stored, also of a block whose kind this build lacks. False: it is no such value, or a kind it lacks. */
bool parameter_restore(const struct parameter *p, struct config *config, const char *value);
/* Before it is written through parameter_place(). ERR_FULL: it is in a table that others refer to, and there is no place for
 * a copy. */
MUST_CHECK enum err parameter_to_write(const struct parameter *p, struct config *config);
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

/* What is meant as a number: how it is kept, and where in the parameter. */
const struct parameter_field *parameter_number_field(const struct parameter *p);
size_t parameter_number_offset(const struct parameter *p);
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
