#include "settings/parameters.h"

#include <string.h>

#include "base/channel.h"
#include "settings/block_pool.h"
#include "settings/block_texts.h"
#include "settings/words.h"

const char *field_unit(const struct parameter_field *field)
{
    return field->type == PARAMETER_WORD || field->type == PARAMETER_NAME ? "" : field->unit;
}

const char *field_words(const struct parameter_field *field)
{
    return field->type == PARAMETER_WORD ? field->unit : "";
}

const char *parameter_unit(const struct parameter *p)
{
    const struct block_parameter *own = parameter_own(p);
    if (own)
        return own->type == BLOCK_WORD ? "" : own->unit;
    return parameter_is_of_block(p) ? "" : field_unit(p->field);
}

const char *parameter_word_list(const struct parameter *p)
{
    const struct block_parameter *own = parameter_own(p);
    return own && own->type == BLOCK_WORD ? own->unit : field_words(p->field);
}

const char *parameter_about(const struct parameter *p)
{
    const struct block_parameter *own = parameter_own(p);
    return own ? own->help : p->field->help;
}

float parameter_lo(const struct parameter *p)
{
    const struct block_parameter *own = parameter_own(p);
    return own ? own->lo : field_lo(p->field);
}

float parameter_hi(const struct parameter *p)
{
    const struct block_parameter *own = parameter_own(p);
    return own ? own->hi : field_hi(p->field);
}

static const uint8_t *place_const(const struct parameter *p, const struct config *config)
{
    if (parameter_own(p))
        return block_parameter_where(config, p->index, p->row, p->own);
    return (const uint8_t *)config + p->group->offset + (size_t)p->index * p->group->stride +
           p->field->offset;
}

void *parameter_place(const struct parameter *p, struct config *config)
{
    if (parameter_own(p)) /* a record may be in another place */
        return (uint8_t *)record_place(config, p->index) +
               (place_const(p, config) - (const uint8_t *)config_block_settings(config, p->index));
    return (uint8_t *)config + (place_const(p, config) - (const uint8_t *)config);
}

enum err parameter_to_write(const struct parameter *p, struct config *config)
{
    return parameter_own(p) ? record_to_write(config, p->index) : ERR_OK;
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
    case PARAMETER_WORD:
        return 1;
    default:
        return block_text_size(p);
    }
}

float parameter_initial(const struct parameter *p)
{
    if (parameter_own(p))
        return p->own->initial;
    bool diagonal =
        p->group->offset == offsetof(struct config, decoupler) && p->field->id == p->index + 1u;
    return diagonal ? 1.0f : field_initial(p->field);
}

bool parameter_is_secret(const struct parameter *p)
{
    return p->field->type == PARAMETER_NAME && p->field->unit[0] == PARAMETER_SECRET[0];
}

void parameter_name(const struct parameter *p, struct text *t)
{
    text_str(t, p->group->name);
    if (p->group->indexed)
        text_u32(t, p->index + 1u);
    text_char(t, '.');
    if (parameter_own(p)) {
        text_str(t, p->own->name);
        if (p->field->type == PARAMETER_ROW) {
            text_char(t, '.');
            text_u32(t, p->row + 1u);
        }
        return;
    }
    text_str(t, p->field->name);
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
        words_put(parameter_word_list(p), *at, t);
        break;
    default:
        if (block_text_put(p, at, t))
            break;
        text_str(t, !*at ? "-" : parameter_is_secret(p) ? PARAMETER_SECRET : (const char *)at);
        break;
    }
}

bool parameter_is_mv(const struct parameter *p, uint8_t field)
{
    return p->group->offset == offsetof(struct config, mv) && p->field->id == field;
}

const float *parameter_follows(const struct parameter *p, const struct config *config)
{
    return parameter_is_mv(p, PARAMETER_MV_MAX) ? &config->mv[p->index].hi : NULL;
}

void parameter_default(const struct parameter *p, const struct config *config, struct text *t)
{
    const float *source = parameter_follows(p, config);
    switch (p->field->type) {
    case PARAMETER_FLOAT:
        text_float(t, source ? *source : parameter_initial(p));
        break;
    case PARAMETER_U32:
    case PARAMETER_U16:
    case PARAMETER_FIXED:
        text_u32(t, (uint32_t)parameter_initial(p));
        break;
    case PARAMETER_WORD:
        words_put(parameter_word_list(p), (unsigned)parameter_initial(p), t);
        break;
    default:
        if (block_text_put_initial(p, t))
            break;
        text_str(t, "-");
        break;
    }
}

void parameter_range(const struct parameter *p, struct text *t)
{
    switch (p->field->type) {
    case PARAMETER_WORD:
        text_str(t, parameter_word_list(p));
        break;
    case PARAMETER_FIXED:
        text_str(t, "read-only");
        break;
    case PARAMETER_NAME:
        text_str(t, parameter_names_event(p)
                        ? "up to 15 letters, digits or _, blockN.CODE, - for none"
                        : "up to 15 letters, digits or _, - for none");
        break;
    case PARAMETER_UNIT:
        text_str(t, "up to 11 printable characters without blanks or commas, - for none");
        break;
    default:
        if (block_text_range(p, t))
            break;
        text_float(t, parameter_lo(p));
        text_str(t, " .. ");
        text_float(t, parameter_hi(p));
        break;
    }
}

bool parameter_equal(const struct parameter *p, const struct config *a, const struct config *b)
{
    if (parameter_is_of_block(p) && (p->own || p->field->type == PARAMETER_KIND)) {
        /* With another kind in b, or without a record there, a default is no change besides that of the kind. */
        bool same = config_block_kind(a, p->index) == config_block_kind(b, p->index);
        if (p->own && !same)
            return parameter_is_default(p, a);
        if (!same)
            return false;
    }
    return memcmp(place_const(p, a), place_const(p, b), parameter_size(p)) == 0;
}

bool parameter_is_default(const struct parameter *p, const struct config *config)
{
    const uint8_t *at = place_const(p, config);
    float f = parameter_initial(p), there;
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
        return block_text_is_initial(p, at);
    }
}

unsigned parameter_words(const struct parameter *p)
{
    return words_count(parameter_word_list(p));
}

const struct parameter_field *parameter_number_field(const struct parameter *p)
{
    return parameter_own(p) && p->field->type == PARAMETER_ROW ? &parameter_own_fields[p->own->type]
                                                               : p->field;
}

size_t parameter_number_offset(const struct parameter *p)
{
    return parameter_own(p) && p->field->type == PARAMETER_ROW
               ? p->col * block_value_size(p->own->type)
               : 0;
}

enum err parameter_get_number(const struct parameter *p, const struct config *config, float *value)
{
    const uint8_t *at = place_const(p, config) + parameter_number_offset(p);
    uint32_t u32;
    uint16_t u16;
    switch (parameter_number_field(p)->type) {
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
