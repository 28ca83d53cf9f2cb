#include "settings/block_pool.h"

#include <string.h>

#include "exchange/tables.h"

#define NO_KIND 0xFFu

_Static_assert(CONFIG_POOL_BYTES % 4 == 0 && CONFIG_POOL_BYTES <= UINT16_MAX, "places of records");

void *record_place(struct config *config, uint8_t n)
{
    return config->table[n] ? table_at(config, n) : config->pool + config->block[n].offset;
}

enum err record_to_write(struct config *config, uint8_t n)
{
    return config->table[n] ? table_to_write(config, n) : ERR_OK;
}

/* Returns the bytes of the pool that block n uses. */
static uint16_t pool_bytes(const struct config *config, unsigned n)
{
    return config->table[n] ? 0 : config->block[n].bytes;
}

static uint32_t bytes_in_use(const struct config *config)
{
    uint32_t bytes = 0;
    for (unsigned n = 0; n < CONFIG_BLOCKS; n++)
        bytes += pool_bytes(config, n);
    return bytes;
}

/* Gives the record of block n `bytes` bytes of the pool, all 0, and takes its table away. The records after it move up or down. */
static void resize(struct config *config, uint8_t n, uint16_t bytes)
{
    struct block_config *b = &config->block[n];
    uint32_t used = bytes_in_use(config);
    uint32_t at = 0;
    for (unsigned k = 0; k < n; k++)
        at += pool_bytes(config, k);
    uint32_t before = pool_bytes(config, n), behind = used - at - before;
    memmove(config->pool + at + bytes, config->pool + at + before, behind);
    memset(config->pool + at, 0, bytes);
    memset(config->pool + at + bytes + behind, 0, CONFIG_POOL_BYTES - at - bytes - behind);
    b->bytes = bytes;
    config->table[n] = CONFIG_NO_TABLE;
    for (unsigned k = n; k < CONFIG_BLOCKS; k++) {
        config->block[k].offset = pool_bytes(config, k) ? (uint16_t)at : 0;
        at += pool_bytes(config, k);
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

/* Makes room for a record of that kind, all 0. Errors as record_make(). */
static enum err room_for_record(struct config *config, uint8_t n, const struct block_kind *kind,
                                uint32_t *needed, uint32_t *free)
{
    *needed = *free = 0;
    if (kind->table) {
        uint8_t now = config->table[n];
        if (!table_take(config, n))
            return ERR_FULL;
        uint8_t taken = config->table[n];
        config->table[n] = now;
        resize(config, n, 0);
        config->table[n] = taken;
        config->block[n].bytes = kind->settings_bytes;
        return ERR_OK;
    }
    *needed = kind->settings_bytes;
    *free = CONFIG_POOL_BYTES - (bytes_in_use(config) - pool_bytes(config, n));
    if (*needed > *free)
        return ERR_FULL;
    resize(config, n, kind->settings_bytes);
    return ERR_OK;
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
    if (!block_kind_is_numbered(k))
        return ERR_UNKNOWN;
    if (config_block_kind(config, n) == k)
        return ERR_OK;
    enum err err = room_for_record(config, n, block_kinds[k], needed, free);
    if (err)
        return err;
    name_kind(config, n, kind);
    for (unsigned i = 0; i < block_kinds[k]->parameters; i++)
        put_initial(record_place(config, n), &block_kinds[k]->parameter[i]);
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
