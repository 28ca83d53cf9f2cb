#include "settings/block_parameters.h"

#include <stddef.h>
#include <string.h>

#include "settings/words.h"

#define VALUE_TEXT_SIZE 42

static const struct block_kind *kind_of_block(const struct config *config, uint8_t block)
{
    uint8_t kind = config_block_kind(config, block);
    return block_kind_is_numbered(kind) ? block_kinds[kind] : NULL;
}

static unsigned rows_of(const struct block_parameter *own)
{
    return block_parameter_is_table(own) ? own->rows : 1u;
}

bool block_parameter_at(const struct config *config, unsigned n, struct block_parameter_place *p)
{
    for (uint8_t b = 0; b < CONFIG_BLOCKS; b++) {
        const struct block_kind *kind = kind_of_block(config, b);
        unsigned fixed = config->block[b].kind[0] ? BLOCK_FIELDS : 1u;
        *p = (struct block_parameter_place){.block = b};
        if (n < fixed) {
            p->field = (uint8_t)n;
            return true;
        }
        n -= fixed;
        for (unsigned i = 0; kind && i < kind->parameters; i++) {
            p->own = &kind->parameter[i];
            if (n < rows_of(p->own)) {
                p->row = (uint16_t)n;
                return true;
            }
            n -= rows_of(p->own);
        }
    }
    return false;
}

/* Reads the "3" of "table.3": from 1 up to `rows`, without leading zeros. Returns whether it is one. */
static bool row_number(const char *s, unsigned rows, uint16_t *row)
{
    uint32_t x;
    if (*s == '0' || text_parse_u32(s, &x) != ERR_OK || x == 0 || x > rows)
        return false;
    *row = (uint16_t)(x - 1u);
    return true;
}

bool block_parameter_find(const struct config *config, uint8_t block, const char *name,
                          struct block_parameter_place *p)
{
    const struct block_kind *kind = kind_of_block(config, block);
    *p = (struct block_parameter_place){.block = block};
    for (unsigned i = 0; kind && i < kind->parameters; i++) {
        p->own = &kind->parameter[i];
        size_t n = strlen(p->own->name);
        if (strncmp(name, p->own->name, n) != 0)
            continue;
        if (block_parameter_is_table(p->own)
                ? name[n] == '.' && row_number(name + n + 1, p->own->rows, &p->row)
                : name[n] == '\0')
            return true;
    }
    return false;
}

bool block_parameter_find_id(const struct config *config, uint8_t block, uint8_t id, uint16_t row,
                             struct block_parameter_place *p)
{
    const struct block_kind *kind = kind_of_block(config, block);
    *p = (struct block_parameter_place){.block = block, .row = row};
    for (unsigned i = 0; kind && i < kind->parameters; i++) {
        p->own = &kind->parameter[i];
        if (p->own->id == id)
            return row < rows_of(p->own);
    }
    return false;
}

const uint8_t *block_parameter_where(const struct config *config, uint8_t block, uint16_t row,
                                     const struct block_parameter *own)
{
    return (const uint8_t *)config_block_settings(config, block) + own->offset +
           row * block_row_size(own);
}

bool block_is_unknown(const struct config *config, uint8_t block)
{
    return config->block[block].kind[0] && !kind_of_block(config, block);
}

void block_kinds_put(struct text *t)
{
    for (uint8_t k = 0; k < block_kind_count; k++) {
        if (block_kind_is_numbered(k)) {
            text_str(t, block_kinds[k]->name);
            text_char(t, '|');
        }
    }
    text_char(t, '-');
}

/* ---- items with commas or blanks between them ---- */

static bool between(char c)
{
    return c == ',' || c == ' ';
}

/* Gets the next item. Returns NULL where it is empty, or has no room with its zero. */
static const char *next_item(const char **s, char *item, size_t size)
{
    size_t n = 0;
    while ((*s)[n] && !between((*s)[n]))
        n++;
    if (n == 0 || n >= size)
        return NULL;
    memcpy(item, *s, n);
    item[n] = '\0';
    *s += n;
    return item;
}

/* ---- lists of names ---- */

void block_list_put(const char *list, struct text *t)
{
    if (!*list)
        text_char(t, '-');
    for (; *list; list++)
        text_char(t, *list == ' ' ? ',' : *list);
}

static bool is_name(const char *s)
{
    for (; *s; s++)
        if (!((*s >= 'a' && *s <= 'z') || (*s >= 'A' && *s <= 'Z') || (*s >= '0' && *s <= '9') ||
              *s == '_'))
            return false;
    return true;
}

enum err block_list_set(char *list, size_t size, const char *value)
{
    char item[CHANNEL_NAME_SIZE], copy[BLOCK_NAMES_SIZE] = {0};
    size_t n = strlen(value);
    if (n == 0 || n >= size || n >= sizeof copy)
        return ERR_RANGE;
    if (strcmp(value, "-") != 0) {
        const char *s = value;
        while (next_item(&s, item, sizeof item) && is_name(item) && *s)
            s++;
        if (*s || between(s[-1]) || !is_name(item))
            return ERR_PARSE;
        for (size_t i = 0; i < n; i++)
            copy[i] = (char)(value[i] == ',' ? ' ' : value[i]);
    }
    memcpy(list, copy, size);
    return ERR_OK;
}

static size_t name_length(const char *s)
{
    size_t n = 0;
    while (s[n] && s[n] != ' ')
        n++;
    return n;
}

bool block_list_repeats(const char *list)
{
    for (const char *a = list; *a; a += name_length(a) + (a[name_length(a)] == ' ')) {
        size_t n = name_length(a);
        const char *b = a + n;
        while (*b) {
            b++; /* skip the blank */
            if (name_length(b) == n && memcmp(a, b, n) == 0)
                return true;
            b += name_length(b);
        }
    }
    return false;
}

/* ---- rows of tables ---- */

static void put_value(const struct block_parameter *own, const uint8_t *at, struct text *t)
{
    float f;
    uint16_t u16;
    if (own->type == BLOCK_FLOAT) {
        memcpy(&f, at, sizeof f);
        text_float(t, f);
    } else if (own->type == BLOCK_U16) {
        memcpy(&u16, at, sizeof u16);
        text_u32(t, u16);
    } else {
        words_put(own->unit, *at, t);
    }
}

void block_row_put(const struct block_parameter *own, const uint8_t *at, struct text *t)
{
    for (unsigned i = 0; i < own->cols; i++) {
        if (i)
            text_char(t, ',');
        put_value(own, at + i * block_value_size(own->type), t);
    }
}

/* Writes a number in the type of the row. */
static void keep(const struct block_parameter *own, uint8_t *at, float f)
{
    uint16_t u16 = own->type == BLOCK_FLOAT ? 0 : (uint16_t)f;
    if (own->type == BLOCK_FLOAT)
        memcpy(at, &f, sizeof f);
    else if (own->type == BLOCK_U16)
        memcpy(at, &u16, sizeof u16);
    else
        *at = (uint8_t)u16;
}

void block_row_put_initial(const struct block_parameter *own, struct text *t)
{
    uint8_t initial[sizeof(float)];
    keep(own, initial, own->initial);
    for (unsigned i = 0; i < own->cols; i++) {
        if (i)
            text_char(t, ',');
        put_value(own, initial, t);
    }
}

bool block_row_is_initial(const struct block_parameter *own, const uint8_t *at)
{
    uint8_t initial[sizeof(float)];
    size_t size = block_value_size(own->type);
    keep(own, initial, own->initial);
    for (unsigned i = 0; i < own->cols; i++)
        if (memcmp(at + i * size, initial, size) != 0)
            return false;
    return true;
}

static enum err parse_value(const struct block_parameter *own, const char *item, float *f)
{
    uint32_t u32;
    uint8_t word;
    enum err err = ERR_OK;
    if (own->type == BLOCK_WORD) {
        if (!words_find(own->unit, item, &word))
            return ERR_PARSE;
        *f = (float)word;
        return ERR_OK;
    }
    if (own->type == BLOCK_U16) {
        err = text_parse_u32(item, &u32);
        *f = err ? 0.0f : (float)u32;
    } else {
        err = text_parse_float(item, f);
    }
    if (err)
        return err;
    if (*f < own->lo || *f > own->hi)
        return ERR_RANGE;
    if (*f == 0.0f)
        *f = 0.0f; /* no negative zero: equal settings have equal bits */
    return ERR_OK;
}

enum err block_row_set(const struct block_parameter *own, uint8_t *at, const char *value,
                       unsigned least)
{
    char item[VALUE_TEXT_SIZE];
    uint8_t row[BLOCK_COLS_MAX * sizeof(float)];
    size_t size = block_value_size(own->type);
    const char *s = value;
    unsigned given = 0;
    for (bool last = false; !last; given++) {
        float f;
        if (!next_item(&s, item, sizeof item))
            return ERR_PARSE;
        enum err err = parse_value(own, item, &f);
        if (err)
            return err;
        keep(own, row + given * size, f);
        last = given + 1u == own->cols || (given + 1u >= least && *s == '\0');
        if (last ? *s != '\0' : !between(*s))
            return ERR_PARSE;
        s += !last;
    }
    memcpy(at, row, given * size);
    return ERR_OK;
}

/* ---- rows as stored ---- */

size_t block_row_encode(const struct block_parameter *own, const uint8_t *at, uint8_t *stored)
{
    size_t size = block_value_size(own->type);
    for (unsigned i = 0; i < own->cols; i++) {
        uint32_t bits = 0;
        uint16_t u16;
        if (size == sizeof bits) {
            memcpy(&bits, at + i * size, sizeof bits);
        } else if (size == sizeof u16) {
            memcpy(&u16, at + i * size, sizeof u16);
            bits = u16;
        } else {
            bits = at[i];
        }
        for (size_t k = 0; k < size; k++)
            *stored++ = (uint8_t)(bits >> 8 * k);
    }
    return own->cols * size;
}

bool block_row_decode(const struct block_parameter *own, uint8_t *at, const uint8_t *stored,
                      bool *taken)
{
    uint8_t row[BLOCK_COLS_MAX * sizeof(float)];
    size_t size = block_value_size(own->type);
    float hi = own->type == BLOCK_WORD ? (float)(words_count(own->unit) - 1u) : own->hi;
    float lo = own->type == BLOCK_WORD ? 0.0f : own->lo;
    bool as_stored = true;
    *taken = false;
    for (unsigned i = 0; i < own->cols; i++) {
        uint32_t bits = 0;
        for (size_t k = 0; k < size; k++)
            bits |= (uint32_t)*stored++ << 8 * k;
        float f = (float)bits;
        if (own->type == BLOCK_FLOAT)
            memcpy(&f, &bits, sizeof f);
        if (!float_is_finite(f))
            return false;
        float allowed = f < lo ? lo : f > hi ? hi : f;
        as_stored = as_stored && allowed == f;
        keep(own, row + i * size, allowed == 0.0f ? 0.0f : allowed);
    }
    memcpy(at, row, own->cols * size);
    *taken = true;
    return as_stored;
}
