/* Sets parameters from texts and numbers. */
#include <string.h>

#include "settings/block_pool.h"
#include "settings/block_texts.h"
#include "settings/parameters.h"
#include "settings/words.h"

static bool name_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

static bool subject_character(char c)
{
    return name_character(c) || c == '.';
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

static void put_float(const struct parameter *p, struct config *config, float f)
{
    if (parameter_is_mv(p, PARAMETER_MV_HI)) {
        struct mv_config *mv = &config->mv[p->index];
        mv->max = mv->max == mv->hi ? f : mv->max;
    }
    memcpy((uint8_t *)parameter_place(p, config) + parameter_number_offset(p), &f, sizeof f);
}

void parameters_defaults(struct config *config)
{
    struct parameter p;
    memset(config, 0, sizeof *config);
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        uint8_t *at = parameter_place(&p, config);
        float f = parameter_initial(&p);
        /* Only parameters of type float may be negative. */
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

enum err parameter_set(const struct parameter *p, struct config *config, const char *value)
{
    enum err full = parameter_to_write(p, config);
    if (full)
        return full;
    if (parameter_is_of_block(p) && p->field->type >= PARAMETER_KIND) {
        bool lacks_row = parameter_own(p) && !config_block_settings(config, p->index);
        return block_text_set(p, config, lacks_row ? NULL : parameter_place(p, config), value);
    }
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
        if (f < parameter_lo(p) || f > parameter_hi(p))
            return ERR_RANGE;
        if (f == 0.0f)
            f = 0.0f; /* no negative zero: equal settings have equal bits */
        put_float(p, config, f);
        return ERR_OK;
    case PARAMETER_U32:
    case PARAMETER_U16:
        err = text_parse_u32(value, &u32);
        if (err)
            return err;
        if ((float)u32 < parameter_lo(p) || (float)u32 > parameter_hi(p))
            return ERR_RANGE;
        if (field->type == PARAMETER_U32) {
            memcpy(at, &u32, sizeof u32);
        } else {
            uint16_t u16 = (uint16_t)u32;
            memcpy(at, &u16, sizeof u16);
        }
        return ERR_OK;
    case PARAMETER_WORD:
        return words_find(parameter_word_list(p), value, at) ? ERR_OK : ERR_PARSE;
    case PARAMETER_NAME:
        if (parameter_is_secret(p) && strcmp(value, PARAMETER_SECRET) == 0)
            return ERR_OK;
        return set_text(at, value, CHANNEL_NAME_SIZE,
                        parameter_names_event(p) ? subject_character : name_character);
    default:
        return set_text(at, value, CHANNEL_UNIT_SIZE, unit_character);
    }
}

bool parameter_restore(const struct parameter *p, struct config *config, const char *value)
{
    if (!CONFIG_BLOCKS)
        return false;
    if (p->field->type == PARAMETER_KIND) {
        char name[CHANNEL_NAME_SIZE] = "";
        return set_text((uint8_t *)name, value, sizeof name, name_character) == ERR_OK &&
               record_restore(config, p->index, name);
    }
    return p->field->type == PARAMETER_LIST && config->block[p->index].kind[0]
               ? block_list_set(parameter_place(p, config), parameter_size(p), value) == ERR_OK
               : parameter_set(p, config, value) == ERR_OK;
}

enum err parameter_set_number(const struct parameter *p, struct config *config, float value)
{
    enum err err = parameter_to_write(p, config);
    if (err)
        return err;
    const struct parameter_field *field = parameter_number_field(p);
    uint8_t *at = (uint8_t *)parameter_place(p, config) + parameter_number_offset(p);
    bool word = field->type == PARAMETER_WORD;
    float lo = word ? 0.0f : parameter_lo(p);
    float hi = word ? (float)(parameter_words(p) - 1u) : parameter_hi(p);
    if (field->type == PARAMETER_FIXED)
        return ERR_READ_ONLY;
    if (field->type >= PARAMETER_NAME)
        return ERR_PARSE;
    if (!(value >= lo && value <= hi)) /* also refuses NaN */
        return ERR_RANGE;
    if (value == 0.0f)
        value = 0.0f; /* no negative zero: equal settings have equal bits */
    if (field->type == PARAMETER_FLOAT) {
        put_float(p, config, value);
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
