#include "exchange/block_settings.h"

#include <string.h>

#include "base/text.h"
#include "exchange/tables.h"

#define NO_KIND 0xFFu

bool block_kind_is_numbered(uint8_t kind)
{
    const struct block_kind *k = kind < block_kind_count ? block_kinds[kind] : NULL;
    for (unsigned i = 0; k && i < k->parameters; i++)
        if (k->parameter[i].cols > BLOCK_COLS_MAX || k->parameter[i].rows > BLOCK_ROWS_MAX)
            return false;
    return k && k->parameters != 0 && (!k->table || k->settings_bytes <= CONFIG_TABLE_BYTES);
}

uint8_t config_block_kind(const struct config *config, uint8_t n)
{
    const struct block_config *b = &config->block[n];
    uint8_t kind = block_kind_find(b->kind);
    return block_kind_is_numbered(kind) && b->bytes == block_kinds[kind]->settings_bytes ? kind
                                                                                         : NO_KIND;
}

const void *config_block_settings(const struct config *config, uint8_t n)
{
    if (config_block_kind(config, n) == NO_KIND)
        return NULL;
    return config->table[n] ? table_at(config, n) : config->pool + config->block[n].offset;
}

void block_word_name(uint8_t n, const char *word, char name[CHANNEL_NAME_SIZE])
{
    struct text t = text_on(name, CHANNEL_NAME_SIZE);
    text_str(&t, "block");
    text_u32(&t, n + 1u);
    text_char(&t, '.');
    text_str(&t, word);
}
