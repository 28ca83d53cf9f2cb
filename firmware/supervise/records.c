#include "supervise/records.h"

#include <string.h>

#include "base/text.h"

#define NO_KIND 0xFFu

uint8_t block_kind_find(const char *name)
{
    for (uint8_t k = 0; name[0] && k < block_kind_count; k++)
        if (strcmp(block_kinds[k]->name, name) == 0)
            return k;
    return NO_KIND;
}

#if CONFIG_BLOCKS
_Static_assert(CONFIG_POOL_BYTES % 4 == 0 && CONFIG_POOL_BYTES <= UINT16_MAX, "places of records");

bool block_kind_has_record(uint8_t kind)
{
    const struct block_kind *k = kind < block_kind_count ? block_kinds[kind] : NULL;
    for (unsigned i = 0; k && i < k->parameters; i++)
        if (k->parameter[i].cols > RECORD_COLS_MAX || k->parameter[i].rows > RECORD_ROWS_MAX)
            return false;
    return k && k->parameters != 0;
}

uint8_t config_block_kind(const struct config *config, uint8_t n)
{
    const struct block_config *b = &config->block[n];
    uint8_t kind = block_kind_find(b->kind);
    return block_kind_has_record(kind) && b->bytes == block_kinds[kind]->settings_bytes ? kind
                                                                                        : NO_KIND;
}

const void *config_record(const struct config *config, uint8_t n)
{
    return config_block_kind(config, n) == NO_KIND ? NULL : config->pool + config->block[n].at;
}

void block_word_name(uint8_t n, const char *word, char name[CHANNEL_NAME_SIZE])
{
    struct text t = text_on(name, CHANNEL_NAME_SIZE);
    text_str(&t, "block");
    text_u32(&t, n + 1u);
    text_char(&t, '.');
    text_str(&t, word);
}

static uint32_t bytes_in_use(const struct config *config)
{
    uint32_t bytes = 0;
    for (unsigned n = 0; n < CONFIG_BLOCKS; n++)
        bytes += config->block[n].bytes;
    return bytes;
}

/* The record of block n takes so many bytes, all 0; those behind it move up or down. */
static void resize(struct config *config, uint8_t n, uint16_t bytes)
{
    struct block_config *b = &config->block[n];
    uint32_t used = bytes_in_use(config);
    uint32_t at = 0;
    for (unsigned k = 0; k < n; k++)
        at += config->block[k].bytes;
    uint32_t behind = used - at - b->bytes;
    memmove(config->pool + at + bytes, config->pool + at + b->bytes, behind);
    memset(config->pool + at, 0, bytes);
    memset(config->pool + at + bytes + behind, 0, CONFIG_POOL_BYTES - at - bytes - behind);
    b->bytes = bytes;
    for (unsigned k = n; k < CONFIG_BLOCKS; k++) {
        config->block[k].at = config->block[k].bytes ? (uint16_t)at : 0;
        at += config->block[k].bytes;
    }
}

static void put_initial(uint8_t *record, const struct block_parameter *p)
{
    uint8_t *at = record + p->offset;
    uint16_t u16 = p->type == BLOCK_FLOAT ? 0 : (uint16_t)p->initial;
    for (uint32_t i = 0; i < block_value_count(p); i++) {
        if (p->type == BLOCK_FLOAT)
            memcpy(at, &p->initial, sizeof p->initial);
        else if (p->type == BLOCK_U16)
            memcpy(at, &u16, sizeof u16);
        else
            *at = (uint8_t)u16;
        at += block_value_size(p->type);
    }
}

static void name_kind(struct config *config, uint8_t n, const char *kind)
{
    size_t length = strlen(kind);
    memset(config->block[n].kind, 0, CHANNEL_NAME_SIZE);
    memcpy(config->block[n].kind, kind,
           length < CHANNEL_NAME_SIZE ? length : CHANNEL_NAME_SIZE - 1u);
}

enum err record_make(struct config *config, uint8_t n, const char *kind, uint32_t *needed,
                     uint32_t *free)
{
    struct block_config *b = &config->block[n];
    if (!kind[0]) {
        resize(config, n, 0);
        memset(b, 0, sizeof *b);
        return ERR_OK;
    }
    uint8_t k = block_kind_find(kind);
    if (!block_kind_has_record(k))
        return ERR_UNKNOWN;
    if (config_block_kind(config, n) == k)
        return ERR_OK;
    *needed = block_kinds[k]->settings_bytes;
    *free = CONFIG_POOL_BYTES - (bytes_in_use(config) - b->bytes);
    if (*needed > *free)
        return ERR_FULL;
    name_kind(config, n, kind);
    resize(config, n, block_kinds[k]->settings_bytes);
    for (unsigned i = 0; i < block_kinds[k]->parameters; i++)
        put_initial(config->pool + b->at, &block_kinds[k]->parameter[i]);
    return ERR_OK;
}

bool record_restore(struct config *config, uint8_t n, const char *kind)
{
    uint32_t needed, free;
    if (record_make(config, n, kind, &needed, &free) == ERR_OK)
        return true;
    resize(config, n, 0);
    name_kind(config, n, kind);
    return false;
}
#endif
