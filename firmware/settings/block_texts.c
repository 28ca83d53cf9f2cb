#include "settings/block_texts.h"

#include <string.h>

#include "settings/block_pool.h"

size_t block_text_size(const struct parameter *p)
{
    switch (p->field->type) {
    case PARAMETER_KIND:
        return CHANNEL_NAME_SIZE;
    case PARAMETER_LIST:
        return p->field->id == 1u + BLOCK_FIELD_LOOPS ? BLOCK_LOOPS_SIZE : BLOCK_NAMES_SIZE;
    default:
        return p->own ? block_row_size(p->own) : 0;
    }
}

bool block_text_put(const struct parameter *p, const uint8_t *value, struct text *t)
{
    if (p->field->type == PARAMETER_LIST)
        block_list_put((const char *)value, t);
    else if (p->field->type == PARAMETER_ROW)
        block_row_put(p->own, value, t);
    else
        return false;
    return true;
}

bool block_text_put_initial(const struct parameter *p, struct text *t)
{
    if (p->field->type != PARAMETER_ROW)
        return false;
    block_row_put_initial(p->own, t);
    return true;
}

static void range_of_row(const struct parameter *p, struct text *t)
{
    text_u32(t, p->own->cols);
    text_str(t, " with commas between them, each ");
    if (p->own->type == BLOCK_WORD) {
        text_str(t, p->own->unit);
        return;
    }
    text_float(t, p->own->lo);
    text_str(t, " .. ");
    text_float(t, p->own->hi);
}

bool block_text_range(const struct parameter *p, struct text *t)
{
    switch (p->field->type) {
    case PARAMETER_KIND:
        block_kinds_put(t);
        return true;
    case PARAMETER_LIST:
        text_str(t, "names with commas between them, up to ");
        text_u32(t, (uint32_t)block_text_size(p) - 1u);
        text_str(t, " characters, - for none");
        return true;
    case PARAMETER_ROW:
        range_of_row(p, t);
        return true;
    default:
        return false;
    }
}

bool block_text_is_initial(const struct parameter *p, const uint8_t *value)
{
    return p->field->type == PARAMETER_ROW ? block_row_is_initial(p->own, value) : *value == 0;
}

/* Sets a list whose names all differ. With a repeated name, an estimator would count the same error twice. */
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

/* Returns the number of values that a row needs. A row with a column for each possible loop of the kind needs one for each loop that
 * the block has. */
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

enum err block_text_set(const struct parameter *p, struct config *config, void *place,
                        const char *value)
{
    uint32_t needed, free;
    if (p->field->type == PARAMETER_KIND && !value[0])
        return ERR_PARSE;
    if (p->field->type == PARAMETER_KIND)
        return record_make(config, p->index, strcmp(value, "-") == 0 ? "" : value, &needed, &free);
    if (!config_block_settings(config, p->index))
        return block_is_unknown(config, p->index) ? ERR_UNSUPPORTED : ERR_STATE;
    if (p->field->type == PARAMETER_LIST)
        return set_list(place, block_text_size(p), value);
    return block_row_set(p->own, place, value, values_needed(p, config));
}
