/* Records of blocks: the block that they belong to, and the kind that they give it. */
#include <string.h>

#include "storage/storage_parts.h"
#include "storage/storage_record.h"

bool record_of_block(const struct stored_record *r, uint8_t *block)
{
    *block = (uint8_t)(r->id & 0x3F);
    return r->id >> 24 == parameter_blocks.id && *block < CONFIG_BLOCKS;
}

/* Reads the kind of that block. Returns whether the record is that kind. */
static bool kind_stored(const struct stored_record *r, uint8_t block, char kind[CHANNEL_NAME_SIZE])
{
    struct parameter p = {.group = &parameter_blocks,
                          .field = &parameter_blocks.fields[BLOCK_FIELD_KIND],
                          .index = block};
    uint8_t size = (uint8_t)(r->size - r->wide);
    memset(kind, 0, CHANNEL_NAME_SIZE);
    return r->id == parameter_id(&p) && r->type == STORAGE_TEXT && size < CHANNEL_NAME_SIZE &&
           storage_read(r->address + RECORD_HEAD + r->wide, kind, size) == ERR_OK;
}

bool record_is_kind(const struct stored_record *r, uint8_t block, const struct config *config)
{
    char kind[CHANNEL_NAME_SIZE];
    return kind_stored(r, block, kind) && strcmp(kind, config->block[block].kind) == 0;
}

bool record_is_table(const struct stored_record *r)
{
    char kind[CHANNEL_NAME_SIZE];
    uint8_t block;
    if (!record_of_block(r, &block) || !kind_stored(r, block, kind))
        return false;
    uint8_t k = block_kind_find(kind);
    return block_kind_is_numbered(k) && block_kinds[k]->table;
}
