#include "exchange/tables.h"

#include <string.h>

#include "base/assertion.h"
#include "base/crc32.h"

_Static_assert(CONFIG_TABLE_BYTES % 8 == 0, "places of tables");

static uint64_t place[CONFIG_TABLES][CONFIG_TABLE_BYTES / 8]; /* aligned for any settings */
static const struct config *watched[TABLES_WATCHERS];

void tables_begin(void)
{
    memset(place, 0, sizeof place);
    memset(watched, 0, sizeof watched);
}

void tables_watch(enum tables_watcher who, const struct config *config)
{
    watched[who] = config;
}

void *table_at(const struct config *config, uint8_t n)
{
    REFLUX_ASSERT(config->table[n] >= 1 && config->table[n] <= CONFIG_TABLES);
    return place[config->table[n] - 1u];
}

/* Returns true if a block of *config other than number `but` refers to a place. */
static bool refers(const struct config *config, uint8_t which, uint8_t but)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++)
        if (n != but && config->table[n] == which)
            return true;
    return false;
}

/* Returns true if a watched configuration other than *config refers to a place. */
static bool others_refer(const struct config *config, uint8_t which)
{
    for (unsigned k = 0; k < TABLES_WATCHERS; k++)
        if (watched[k] && watched[k] != config && refers(watched[k], which, CONFIG_BLOCKS))
            return true;
    return false;
}

/* Returns true if anything but block n of *config refers to a place. */
static bool place_taken(const struct config *config, uint8_t which, uint8_t n)
{
    return refers(config, which, n) || others_refer(config, which);
}

/* Returns a place that only block n of *config may refer to, or CONFIG_NO_TABLE. */
static uint8_t free_place(const struct config *config, uint8_t n)
{
    for (uint8_t which = 1; which <= CONFIG_TABLES; which++)
        if (!place_taken(config, which, n))
            return which;
    return CONFIG_NO_TABLE;
}

unsigned tables_free_for(const struct config *config)
{
    unsigned n = 0;
    for (uint8_t which = 1; which <= CONFIG_TABLES; which++)
        n += !others_refer(config, which);
    return n;
}

bool table_take(struct config *config, uint8_t n)
{
    uint8_t which = free_place(config, n);
    if (which == CONFIG_NO_TABLE)
        return false;
    memset(place[which - 1u], 0, CONFIG_TABLE_BYTES);
    config->table[n] = which;
    return true;
}

enum err table_to_write(struct config *config, uint8_t n)
{
    uint8_t now = config->table[n];
    if (!place_taken(config, now, n))
        return ERR_OK;
    uint8_t which = free_place(config, n);
    if (which == CONFIG_NO_TABLE)
        return ERR_FULL;
    memcpy(place[which - 1u], place[now - 1u], CONFIG_TABLE_BYTES);
    config->table[n] = which;
    return ERR_OK;
}

uint32_t tables_identity(const struct config *config, uint32_t crc)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++)
        if (config->table[n])
            crc = crc32_update(crc, table_at(config, n), CONFIG_TABLE_BYTES);
    return crc;
}

void tables_share(struct config *config, const struct config *other)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++)
        for (uint8_t k = 0; config->table[n] && k < CONFIG_BLOCKS; k++)
            if (other->table[k] &&
                memcmp(table_at(config, n), table_at(other, k), CONFIG_TABLE_BYTES) == 0)
                config->table[n] = other->table[k];
}
