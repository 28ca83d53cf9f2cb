#include "service/parameters.h"

#include <string.h>

#include "base/channel.h"

const char *field_unit(const struct parameter_field *field)
{
    return field->type == PARAMETER_WORD || field->type == PARAMETER_NAME ? "" : field->unit;
}

const char *field_words(const struct parameter_field *field)
{
    return field->type == PARAMETER_WORD ? field->unit : "";
}

void *parameter_place(const struct parameter *p, struct config *config)
{
    return (uint8_t *)config + p->group->offset + (size_t)p->index * p->group->stride +
           p->field->offset;
}

static const uint8_t *place_const(const struct parameter *p, const struct config *config)
{
    return (const uint8_t *)config + p->group->offset + (size_t)p->index * p->group->stride +
           p->field->offset;
}

size_t parameter_size(const struct parameter *p)
{
    switch (p->field->type) {
    case PARAMETER_FLOAT:
    case PARAMETER_U32:
    case PARAMETER_FIXED:
        return 4;
    case PARAMETER_U16:
        return 2;
    case PARAMETER_NAME:
        return CHANNEL_NAME_SIZE;
    case PARAMETER_UNIT:
        return CHANNEL_UNIT_SIZE;
    default:
        return 1;
    }
}

static float initial(const struct parameter *p)
{
    bool diagonal =
        p->group->offset == offsetof(struct config, decoupler) && p->field->id == p->index + 1u;
    return diagonal ? 1.0f : field_initial(p->field);
}

bool parameter_at(unsigned n, struct parameter *p)
{
    for (unsigned g = 0; g < parameter_group_count; g++) {
        const struct parameter_group *group = &parameter_groups[g];
        unsigned all = (unsigned)group->count * group->n_fields;
        if (n < all) {
            p->group = group;
            p->index = (uint8_t)(n / group->n_fields);
            p->field = &group->fields[n % group->n_fields];
            return true;
        }
        n -= all;
    }
    return false;
}

void parameters_defaults(struct config *config)
{
    struct parameter p;
    memset(config, 0, sizeof *config);
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        uint8_t *at = parameter_place(&p, config);
        float f = initial(&p);
        /* Only real ones may be negative. */
        uint32_t u32 = p.field->type == PARAMETER_FLOAT ? 0 : (uint32_t)field_initial(p.field);
        uint16_t u16 = (uint16_t)u32;
        switch (p.field->type) {
        case PARAMETER_FLOAT:
            memcpy(at, &f, sizeof f);
            break;
        case PARAMETER_U32:
        case PARAMETER_FIXED:
            memcpy(at, &u32, sizeof u32);
            break;
        case PARAMETER_U16:
            memcpy(at, &u16, sizeof u16);
            break;
        case PARAMETER_WORD:
            *at = (uint8_t)field_initial(p.field);
            break;
        default:
            break; /* names and units begin empty */
        }
    }
}

enum err parameter_find(const char *name, struct parameter *p)
{
    for (unsigned g = 0; g < parameter_group_count; g++) {
        const struct parameter_group *group = &parameter_groups[g];
        size_t n = strlen(group->name);
        if (strncmp(name, group->name, n) != 0)
            continue;
        const char *s = name + n;
        unsigned index = 0;
        if (group->indexed) {
            if (*s < '1' || *s > '9')
                continue;
            for (; *s >= '0' && *s <= '9' && index < 1000; s++)
                index = index * 10 + (unsigned)(*s - '0');
            if (index > group->count && index > group->most)
                continue;
            index--;
        }
        if (*s++ != '.')
            continue;
        for (unsigned f = 0; f < group->n_fields; f++) {
            if (strcmp(s, group->fields[f].name) != 0)
                continue;
            *p = (struct parameter){group, &group->fields[f], (uint8_t)index};
            return index < group->count ? ERR_OK : ERR_UNSUPPORTED;
        }
    }
    return ERR_UNKNOWN;
}

uint16_t parameter_id(const struct parameter *p)
{
    return (uint16_t)((p->group->id << 12) | (p->field->id << 6) | p->index);
}

enum err parameter_find_id(uint16_t id, struct parameter *p)
{
    for (unsigned g = 0; g < parameter_group_count; g++) {
        const struct parameter_group *group = &parameter_groups[g];
        if (group->id != id >> 12 || (id & 0x3F) >= group->count)
            continue;
        for (unsigned f = 0; f < group->n_fields; f++) {
            if (group->fields[f].id != (id >> 6 & 0x3F))
                continue;
            *p = (struct parameter){group, &group->fields[f], (uint8_t)(id & 0x3F)};
            return ERR_OK;
        }
    }
    return ERR_UNKNOWN;
}

bool parameter_is_secret(const struct parameter *p)
{
    return p->field->type == PARAMETER_NAME && p->field->unit[0];
}

void parameter_name(const struct parameter *p, struct text *t)
{
    text_str(t, p->group->name);
    if (p->group->indexed)
        text_u32(t, p->index + 1u);
    text_char(t, '.');
    text_str(t, p->field->name);
}

static void word_at(const char *words, unsigned index, struct text *t)
{
    for (; *words && index; words++)
        if (*words == '|')
            index--;
    for (; *words && *words != '|'; words++)
        text_char(t, *words);
}

void parameter_value(const struct parameter *p, const struct config *config, struct text *t)
{
    const uint8_t *at = place_const(p, config);
    float f;
    uint32_t u32;
    uint16_t u16;
    switch (p->field->type) {
    case PARAMETER_FLOAT:
        memcpy(&f, at, sizeof f);
        text_float(t, f);
        break;
    case PARAMETER_U32:
    case PARAMETER_FIXED:
        memcpy(&u32, at, sizeof u32);
        text_u32(t, u32);
        break;
    case PARAMETER_U16:
        memcpy(&u16, at, sizeof u16);
        text_u32(t, u16);
        break;
    case PARAMETER_WORD:
        word_at(field_words(p->field), *at, t);
        break;
    default:
        text_str(t, !*at ? "-" : parameter_is_secret(p) ? PARAMETER_SECRET : (const char *)at);
        break;
    }
}

void parameter_default(const struct parameter *p, struct text *t)
{
    switch (p->field->type) {
    case PARAMETER_FLOAT:
        text_float(t, initial(p));
        break;
    case PARAMETER_U32:
    case PARAMETER_U16:
    case PARAMETER_FIXED:
        text_u32(t, (uint32_t)field_initial(p->field));
        break;
    case PARAMETER_WORD:
        word_at(field_words(p->field), (unsigned)field_initial(p->field), t);
        break;
    default:
        text_str(t, "-");
        break;
    }
}

void parameter_range(const struct parameter *p, struct text *t)
{
    switch (p->field->type) {
    case PARAMETER_WORD:
        text_str(t, field_words(p->field));
        break;
    case PARAMETER_FIXED:
        text_str(t, "read-only");
        break;
    case PARAMETER_NAME:
        text_str(t, "up to 15 letters, digits or _, - for none");
        break;
    case PARAMETER_UNIT:
        text_str(t, "up to 11 printable characters without blanks or commas, - for none");
        break;
    default:
        text_float(t, field_lo(p->field));
        text_str(t, " .. ");
        text_float(t, field_hi(p->field));
        break;
    }
}

bool parameter_equal(const struct parameter *p, const struct config *a, const struct config *b)
{
    return memcmp(place_const(p, a), place_const(p, b), parameter_size(p)) == 0;
}

bool parameter_is_default(const struct parameter *p, const struct config *config)
{
    const uint8_t *at = place_const(p, config);
    float f = initial(p), there;
    uint32_t u32;
    uint16_t u16;
    switch (p->field->type) {
    case PARAMETER_FLOAT:
        memcpy(&there, at, sizeof there);
        return there == f;
    case PARAMETER_U32:
    case PARAMETER_FIXED:
        memcpy(&u32, at, sizeof u32);
        return u32 == (uint32_t)f;
    case PARAMETER_U16:
        memcpy(&u16, at, sizeof u16);
        return u16 == (uint16_t)f;
    case PARAMETER_WORD:
        return *at == (uint8_t)f;
    default:
        return *at == 0;
    }
}

unsigned parameter_words(const struct parameter *p)
{
    unsigned n = 1;
    for (const char *words = field_words(p->field); *words; words++)
        n += *words == '|';
    return n;
}

static bool word_find(const char *words, const char *value, uint8_t *index)
{
    uint8_t at = 0;
    size_t n = strlen(value);
    while (n) {
        const char *end = strchr(words, '|');
        size_t width = end ? (size_t)(end - words) : strlen(words);
        if (width == n && memcmp(words, value, n) == 0) {
            *index = at;
            return true;
        }
        if (!end)
            return false;
        words = end + 1;
        at++;
    }
    return false;
}

static bool name_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

static bool unit_character(char c)
{
    return c > ' ' && c < 127 && c != ',' && c != '[' && c != ']';
}

static enum err set_text(uint8_t *at, const char *value, size_t size, bool (*allowed)(char))
{
    char copy[CHANNEL_NAME_SIZE] = {0};
    size_t n = strlen(value);
    if (n == 0 || n >= size)
        return ERR_RANGE;
    if (strcmp(value, "-") != 0) {
        for (size_t i = 0; i < n; i++)
            if (!allowed(value[i]))
                return ERR_PARSE;
        memcpy(copy, value, n + 1);
    }
    memcpy(at, copy, size);
    return ERR_OK;
}

enum err parameter_set(const struct parameter *p, struct config *config, const char *value)
{
    uint8_t *at = parameter_place(p, config);
    const struct parameter_field *field = p->field;
    float f;
    uint32_t u32;
    enum err err;
    switch (field->type) {
    case PARAMETER_FIXED:
        return ERR_READ_ONLY;
    case PARAMETER_FLOAT:
        err = text_parse_float(value, &f);
        if (err)
            return err;
        if (f < field_lo(field) || f > field_hi(field))
            return ERR_RANGE;
        if (f == 0.0f)
            f = 0.0f; /* no negative zero: equal settings have equal bits */
        memcpy(at, &f, sizeof f);
        return ERR_OK;
    case PARAMETER_U32:
    case PARAMETER_U16:
        err = text_parse_u32(value, &u32);
        if (err)
            return err;
        if ((float)u32 < field_lo(field) || (float)u32 > field_hi(field))
            return ERR_RANGE;
        if (field->type == PARAMETER_U32) {
            memcpy(at, &u32, sizeof u32);
        } else {
            uint16_t u16 = (uint16_t)u32;
            memcpy(at, &u16, sizeof u16);
        }
        return ERR_OK;
    case PARAMETER_WORD:
        return word_find(field_words(field), value, at) ? ERR_OK : ERR_PARSE;
    case PARAMETER_NAME:
        if (parameter_is_secret(p) && strcmp(value, PARAMETER_SECRET) == 0)
            return ERR_OK;
        return set_text(at, value, CHANNEL_NAME_SIZE, name_character);
    default:
        return set_text(at, value, CHANNEL_UNIT_SIZE, unit_character);
    }
}

enum err parameter_set_number(const struct parameter *p, struct config *config, float value)
{
    uint8_t *at = parameter_place(p, config);
    const struct parameter_field *field = p->field;
    bool word = field->type == PARAMETER_WORD;
    float lo = word ? 0.0f : field_lo(field);
    float hi = word ? (float)(parameter_words(p) - 1u) : field_hi(field);
    if (field->type == PARAMETER_FIXED)
        return ERR_READ_ONLY;
    if (field->type == PARAMETER_NAME || field->type == PARAMETER_UNIT)
        return ERR_PARSE;
    if (!(value >= lo && value <= hi)) /* nor what is no number */
        return ERR_RANGE;
    if (value == 0.0f)
        value = 0.0f; /* no negative zero: equal settings have equal bits */
    if (field->type == PARAMETER_FLOAT) {
        memcpy(at, &value, sizeof value);
        return ERR_OK;
    }
    uint32_t u32 = (uint32_t)value;
    uint16_t u16 = (uint16_t)u32;
    if ((float)u32 != value)
        return ERR_RANGE;
    if (word)
        *at = (uint8_t)u32;
    else if (field->type == PARAMETER_U16)
        memcpy(at, &u16, sizeof u16);
    else
        memcpy(at, &u32, sizeof u32);
    return ERR_OK;
}

enum err parameter_get_number(const struct parameter *p, const struct config *config, float *value)
{
    const uint8_t *at = place_const(p, config);
    uint32_t u32;
    uint16_t u16;
    switch (p->field->type) {
    case PARAMETER_FLOAT:
        memcpy(value, at, sizeof *value);
        return ERR_OK;
    case PARAMETER_U32:
    case PARAMETER_FIXED:
        memcpy(&u32, at, sizeof u32);
        *value = (float)u32;
        return ERR_OK;
    case PARAMETER_U16:
        memcpy(&u16, at, sizeof u16);
        *value = (float)u16;
        return ERR_OK;
    case PARAMETER_WORD:
        *value = (float)*at;
        return ERR_OK;
    default:
        return ERR_PARSE;
    }
}
