/* Strict reading of parsed JSON: every step knows its path, the first error wins and is kept.
 * After an error every function returns at once with nothing: check walk->failed where it matters. */
#ifndef REFLUX_HOST_SIM_JSON_WALK_H
#define REFLUX_HOST_SIM_JSON_WALK_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

#include "plants/file_keys.h"

struct json_walk {
    const char *file;
    char path[256]; /* $.elements[1][0].lags */
    char *err;
    size_t err_size;
    bool failed;
    struct walk_memory *memory; /* all that walk_memory() gave */
};

/* Zeroed memory that lives until walk_free(). */
void *walk_memory(struct json_walk *w, size_t count, size_t size);
void walk_free(struct walk_memory *memory);

/* Blanks for what is no character to be printed: errors quote what stands in a file. */
void walk_one_line(char *text);

/* Remembers "FILE: PATH: text" unless there was an error before; returns false. */
bool walk_fail(struct json_walk *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* One step down the path and back: n = walk_key(w, "A"); ...; walk_up(w, n). */
size_t walk_key(struct json_walk *w, const char *key);
size_t walk_index(struct json_walk *w, size_t i);
void walk_up(struct json_walk *w, size_t mark);

/* The value at the path is an object and has none but the known keys. */
bool walk_object(struct json_walk *w, const json_t *value, const struct file_key *known);
/* The value at the path is an array of min to max elements; returns how many. */
size_t walk_array(struct json_walk *w, const json_t *value, size_t min, size_t max,
                  const char *what);

/* The value of a key of an object. A missing one is an error, unless required is false: then NULL. */
const json_t *walk_get(struct json_walk *w, const json_t *object, const char *key, bool required);
/* A number from lo to hi; fallback when the key is missing (NaN: it must be there). */
double walk_number(struct json_walk *w, const json_t *object, const char *key, double lo, double hi,
                   double fallback);
/* The same with the limits and the default that the row of the key has. */
double walk_field(struct json_walk *w, const json_t *object, const struct file_key *keys,
                  const char *key);
/* Returns the number of elements in the list of a key; the row of the key has its limits. The path is that of the list. */
size_t walk_list(struct json_walk *w, const json_t *list, const struct file_key *keys,
                 const char *key, const char *what);
/* The value at the path as a number from lo to hi. */
double walk_value(struct json_walk *w, const json_t *value, double lo, double hi);
/* A text of at most `longest` characters, not empty; fallback as above (NULL: it must be there). */
const char *walk_text(struct json_walk *w, const json_t *object, const char *key, size_t longest,
                      const char *fallback);
/* A text under a key that must be one of n names: its number; 0 where it is none of them. wrong: what follows it in the line,
 * "drives no column". */
size_t walk_choice(struct json_walk *w, const json_t *object, const char *key,
                   const char *(*name)(size_t k), size_t n, const char *wrong);
/* rows x columns numbers times factor, from an array of arrays under a key; NULL when missing and optional. */
double *walk_matrix(struct json_walk *w, const json_t *object, const char *key, size_t rows,
                    size_t columns, double factor, bool required);
/* The same from a value at the present path. */
bool walk_rows(struct json_walk *w, const json_t *value, size_t rows, size_t columns, double factor,
               double *to);

#endif
