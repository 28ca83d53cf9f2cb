#include "plants/json_walk.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"

struct walk_memory {
    struct walk_memory *next;
    max_align_t begin;
};

void *walk_memory(struct json_walk *w, size_t count, size_t size)
{
    struct walk_memory *m =
        calloc(1, sizeof(*m) + (count < SIZE_MAX / 2 / size ? count * size : SIZE_MAX / 2));
    if (m == NULL) {
        (void)walk_fail(w, "out of memory");
        return NULL;
    }
    m->next = w->memory;
    w->memory = m;
    return &m->begin;
}

void walk_free(struct walk_memory *memory)
{
    while (memory != NULL) {
        struct walk_memory *next = memory->next;
        free(memory);
        memory = next;
    }
}

void walk_one_line(char *text)
{
    for (; *text != '\0'; text++) {
        *text = (unsigned char)*text < ' ' || *text == '\x7f' ? ' ' : *text;
    }
}

bool walk_fail(struct json_walk *w, const char *format, ...)
{
    if (w->failed) {
        return false;
    }
    w->failed = true;
    char text[512];
    va_list list;
    va_start(list, format);
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): va_start stands one line above */
    (void)vsnprintf(text, sizeof(text), format, list);
    va_end(list);
    walk_one_line(text);
    return sim_fail(w->err, w->err_size, "%s: %s: %s", w->file, w->path, text);
}

size_t walk_key(struct json_walk *w, const char *key)
{
    size_t mark = strlen(w->path);
    sim_append(w->path, sizeof(w->path), ".%s", key);
    return mark;
}

size_t walk_index(struct json_walk *w, size_t i)
{
    size_t mark = strlen(w->path);
    sim_append(w->path, sizeof(w->path), "[%zu]", i);
    return mark;
}

void walk_up(struct json_walk *w, size_t mark)
{
    w->path[mark] = '\0';
}

static const char *type_of(const json_t *value)
{
    switch (json_typeof(value)) {
    case JSON_OBJECT:
        return "an object";
    case JSON_ARRAY:
        return "an array";
    case JSON_STRING:
        return "a text";
    case JSON_INTEGER:
    case JSON_REAL:
        return "a number";
    case JSON_NULL:
        return "null";
    default:
        return "true or false";
    }
}

const struct file_key *file_key_find(const struct file_key *keys, const char *name)
{
    for (; keys->name != NULL; keys++) {
        if (strcmp(keys->name, name) == 0) {
            return keys;
        }
    }
    return NULL;
}

bool walk_object(struct json_walk *w, const json_t *value, const struct file_key *known)
{
    if (w->failed) {
        return false;
    }
    if (!json_is_object(value)) {
        return walk_fail(w, "must be an object, is %s", type_of(value));
    }
    const char *key;
    json_t *unused;
    json_object_foreach((json_t *)value, key, unused)
    {
        if (file_key_find(known, key) == NULL) {
            char list[256] = "";
            for (size_t k = 0; known[k].name != NULL; k++) {
                sim_append(list, sizeof(list), "%s%s", k > 0 ? ", " : "", known[k].name);
            }
            return walk_fail(w, "no key \"%.40s\" is known here; known are %s", key, list);
        }
    }
    return true;
}

size_t walk_array(struct json_walk *w, const json_t *value, size_t min, size_t max,
                  const char *what)
{
    if (w->failed) {
        return 0;
    }
    if (!json_is_array(value)) {
        (void)walk_fail(w, "must be an array of %s, is %s", what, type_of(value));
        return 0;
    }
    size_t n = json_array_size(value);
    if (n >= min && n <= max) {
        return n;
    }
    if (min == max) {
        (void)walk_fail(w, "must hold %zu %s, holds %zu", min, what, n);
    } else {
        (void)walk_fail(w, "must hold %zu to %zu %s, holds %zu", min, max, what, n);
    }
    return 0;
}

const json_t *walk_get(struct json_walk *w, const json_t *object, const char *key, bool required)
{
    if (w->failed) {
        return NULL;
    }
    const json_t *value = json_object_get(object, key);
    if (value == NULL && required) {
        (void)walk_fail(w, "the key \"%s\" is missing", key);
    }
    return value;
}

double walk_value(struct json_walk *w, const json_t *value, double lo, double hi)
{
    if (w->failed) {
        return 0.0;
    }
    if (!json_is_number(value)) {
        (void)walk_fail(w, "must be a number, is %s", type_of(value));
        return 0.0;
    }
    double x = json_number_value(value);
    if (!(x >= lo && x <= hi)) {
        double read =
            0.0; /* what the short form of it says: it may be a bound, which would be right */
        char text[32];
        (void)snprintf(text, sizeof(text), "%g", x);
        bool clear = sim_parse_number(text, &read) && !(read >= lo && read <= hi);
        (void)snprintf(text, sizeof(text), clear ? "%g" : "%.17g", x);
        (void)walk_fail(w, "%s must be %g to %g", text, lo, hi);
        return 0.0;
    }
    return x;
}

double walk_number(struct json_walk *w, const json_t *object, const char *key, double lo, double hi,
                   double fallback)
{
    const json_t *value = walk_get(w, object, key, isnan(fallback));
    if (value == NULL) {
        return fallback;
    }
    size_t mark = walk_key(w, key);
    double x = walk_value(w, value, lo, hi);
    walk_up(w, mark);
    return x;
}

double walk_field(struct json_walk *w, const json_t *object, const struct file_key *keys,
                  const char *key)
{
    const struct file_key *row = file_key_find(keys, key);
    return walk_number(w, object, key, row->lo, row->hi, row->fallback);
}

size_t walk_list(struct json_walk *w, const json_t *list, const struct file_key *keys,
                 const char *key, const char *what)
{
    const struct file_key *row = file_key_find(keys, key);
    return walk_array(w, list, (size_t)row->lo, (size_t)row->hi, what);
}

const char *walk_text(struct json_walk *w, const json_t *object, const char *key, size_t longest,
                      const char *fallback)
{
    const json_t *value = walk_get(w, object, key, fallback == NULL);
    if (value == NULL) {
        return fallback != NULL ? fallback : "";
    }
    size_t mark = walk_key(w, key);
    const char *text = json_string_value(value);
    if (text == NULL) {
        (void)walk_fail(w, "must be a text, is %s", type_of(value));
        text = "";
    } else if (text[0] == '\0' || strlen(text) > longest) {
        (void)walk_fail(w, "must have 1 to %zu characters, has %zu", longest, strlen(text));
    } else if (strpbrk(text, "\n\r\t") != NULL) {
        (void)walk_fail(w, "must be one line");
    }
    walk_up(w, mark);
    return text;
}

size_t walk_choice(struct json_walk *w, const json_t *object, const char *key,
                   const char *(*name)(size_t k), size_t n, const char *wrong)
{
    const char *text = walk_text(w, object, key, 40, NULL);
    for (size_t k = 0; k < n; k++) {
        if (strcmp(name(k), text) == 0) {
            return k;
        }
    }
    char names[240] = "";
    for (size_t k = 0; k < n; k++) {
        sim_append(names, sizeof(names), "%s%s", k > 0 ? ", " : "", name(k));
    }
    size_t mark = walk_key(w, key);
    (void)walk_fail(w, "\"%s\" %s; must be one of %s", text, wrong, names);
    walk_up(w, mark);
    return 0;
}

bool walk_rows(struct json_walk *w, const json_t *value, size_t rows, size_t columns, double factor,
               double *to)
{
    if (walk_array(w, value, rows, rows, "rows") != rows || to == NULL) {
        return false;
    }
    for (size_t i = 0; i < rows; i++) {
        const json_t *row = json_array_get(value, i);
        size_t mark = walk_index(w, i);
        size_t n = walk_array(w, row, columns, columns, "numbers");
        for (size_t j = 0; j < n; j++) {
            size_t inner = walk_index(w, j);
            to[i * columns + j] = factor * walk_value(w, json_array_get(row, j), -1e15, 1e15);
            walk_up(w, inner);
        }
        walk_up(w, mark);
    }
    return !w->failed;
}

double *walk_matrix(struct json_walk *w, const json_t *object, const char *key, size_t rows,
                    size_t columns, double factor, bool required)
{
    const json_t *value = walk_get(w, object, key, required);
    double *matrix = walk_memory(w, rows * columns + 1, sizeof(*matrix));
    if (value != NULL && matrix != NULL) {
        size_t mark = walk_key(w, key);
        (void)walk_rows(w, value, rows, columns, factor, matrix);
        walk_up(w, mark);
    }
    return matrix;
}
