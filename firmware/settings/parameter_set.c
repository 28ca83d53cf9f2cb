/* Parameters from texts and numbers. */
#include <string.h>

#include "settings/block_pool.h"
#include "settings/parameters.h"
#include "settings/words.h"

static bool name_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

#if CONFIG_BLOCKS
static bool subject_character(char c)
{
    return name_character(c) || c == '.';
}
#endif

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

#if CONFIG_BLOCKS
/* A list whose names all differ. Of one with a repeated name an estimator would take the same error for two. */
static enum err set_list(char *list, size_t size, const char *value)
{
    char before[BLOCK_NAMES_SIZE];
    memcpy(before, list, size);
    enum err err = block_list_set(list, size, value);
    if (!err && block_list_repeats(list)) {
        memcpy(list, before, size);
        err = ERR_CONFLICT;
    }
    return err;
}

/* How many values a row needs. Where it has a column for each loop that a block of the kind can have: one for each loop it has. */
static unsigned values_needed(const struct parameter *p, const struct config *config)
{
    const struct block_kind *kind = block_kinds[config_block_kind(config, p->index)];
    const char *list = config->block[p->index].loops;
    unsigned loops = *list ? 1u : 0u;
    for (; *list; list++)
        loops += *list == ' ';
    return loops && loops < p->own->cols && p->own->cols == kind->members_most ? loops
                                                                               : p->own->cols;
}

static enum err set_of_block(const struct parameter *p, struct config *config, const char *value)
{
    uint32_t needed, free;
    if (p->field->type == PARAMETER_KIND && !value[0])
        return ERR_PARSE;
    if (p->field->type == PARAMETER_KIND)
        return record_make(config, p->index, strcmp(value, "-") == 0 ? "" : value, &needed, &free);
    if (!config_record(config, p->index))
        return block_is_unknown(config, p->index) ? ERR_UNSUPPORTED : ERR_STATE;
    if (p->field->type == PARAMETER_LIST)
        return set_list(parameter_place(p, config), parameter_size(p), value);
    enum err err = parameter_to_write(p, config);
    return err ? err
               : block_row_set(p->own, parameter_place(p, config), value, values_needed(p, config));
}

bool parameter_restore(const struct parameter *p, struct config *config, const char *value)
{
    if (p->field->type == PARAMETER_KIND) {
        char name[CHANNEL_NAME_SIZE] = "";
        return set_text((uint8_t *)name, value, sizeof name, name_character) == ERR_OK &&
               record_restore(config, p->index, name);
    }
    return p->field->type == PARAMETER_LIST && config->block[p->index].kind[0]
               ? block_list_set(parameter_place(p, config), parameter_size(p), value) == ERR_OK
               : parameter_set(p, config, value) == ERR_OK;
}
#endif

enum err parameter_set(const struct parameter *p, struct config *config, const char *value)
{
#if CONFIG_BLOCKS
    if (p->group == &parameter_blocks && p->field->type >= PARAMETER_KIND)
        return set_of_block(p, config, value);
    enum err full = parameter_to_write(p, config);
    if (full)
        return full;
#endif
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
#if CONFIG_BLOCKS
        if (field->unit[0] == PARAMETER_SUBJECT[0])
            return set_text(at, value, CHANNEL_NAME_SIZE, subject_character);
#endif
        return set_text(at, value, CHANNEL_NAME_SIZE, name_character);
    default:
        return set_text(at, value, CHANNEL_UNIT_SIZE, unit_character);
    }
}

enum err parameter_set_number(const struct parameter *p, struct config *config, float value)
{
#if CONFIG_BLOCKS
    enum err err = parameter_to_write(p, config);
    if (err)
        return err;
#endif
    const struct parameter_field *field = parameter_number_field(p);
    uint8_t *at = (uint8_t *)parameter_place(p, config) + parameter_number_offset(p);
    bool word = field->type == PARAMETER_WORD;
    float lo = word ? 0.0f : parameter_lo(p);
    float hi = word ? (float)(parameter_words(p) - 1u) : parameter_hi(p);
    if (field->type == PARAMETER_FIXED)
        return ERR_READ_ONLY;
    if (field->type >= PARAMETER_NAME)
        return ERR_PARSE;
    if (!(value >= lo && value <= hi)) /* nor what is no number */
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
