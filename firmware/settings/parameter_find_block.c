/* Parameters of all, those of blocks included, by number and name; those of blocks by id. */
#include <string.h>

#include "settings/parameter_find.h"

/* In parameter_own_fields[]. */
static struct parameter of_block(const struct block_parameter_place *place)
{
    struct parameter p = {.group = &parameter_blocks,
                          .field = &parameter_blocks.fields[place->field],
                          .index = place->block,
                          .row = place->row,
                          .own = place->own};
    if (p.own)
        p.field = &parameter_own_fields[block_parameter_is_table(p.own) ? 3 : p.own->type];
    return p;
}

bool parameter_of(const struct config *config, unsigned n, struct parameter *p)
{
    struct block_parameter_place place;
    unsigned others = parameter_table_count();
    if (n < others)
        return parameter_at(n, p);
    if (!block_parameter_at(config, n - others, &place))
        return false;
    *p = of_block(&place);
    return true;
}

unsigned parameter_count(const struct config *config)
{
    unsigned n = parameter_table_count();
    struct parameter p;
    while (parameter_of(config, n, &p))
        n++;
    return n;
}

enum err parameter_find_in(const struct config *config, const char *name, struct parameter *p)
{
    struct block_parameter_place place;
    const char *s = name + strlen(parameter_blocks.name);
    enum err err = parameter_find(name, p);
    if (err != ERR_UNKNOWN || strncmp(name, parameter_blocks.name, (size_t)(s - name)) != 0 ||
        *s < '1' || *s >= '1' + CONFIG_BLOCKS || s[1] != '.')
        return err;
    uint8_t block = (uint8_t)(*s - '1');
    s += 2;
    for (uint8_t f = 0; f < BLOCK_FIELDS; f++) {
        place = (struct block_parameter_place){.block = block, .field = f};
        if (strcmp(s, parameter_blocks.fields[f].name) == 0) {
            *p = of_block(&place);
            return ERR_OK;
        }
    }
    if (block_parameter_find(config, block, s, &place)) {
        *p = of_block(&place);
        return ERR_OK;
    }
    return config_record(config, block) ? ERR_UNKNOWN : ERR_EMPTY;
}

enum err parameter_find_block_id(const struct config *config, uint32_t id, struct parameter *p)
{
    struct block_parameter_place place = {.block = (uint8_t)(id & 0x3F)};
    uint8_t field = (uint8_t)(id >> 16);
    uint16_t row = (uint16_t)(id >> 6 & 0x3FF);
    if (id >> 24 != parameter_blocks.id || place.block >= CONFIG_BLOCKS)
        return ERR_UNKNOWN;
    if (field >= 1u && field <= BLOCK_FIELDS && row == 0)
        place.field = (uint8_t)(field - 1u);
    else if (field <= PARAMETER_OWN_ID ||
             !block_parameter_find_id(config, place.block, (uint8_t)(field - PARAMETER_OWN_ID), row,
                                      &place))
        return ERR_UNKNOWN;
    *p = of_block(&place);
    return ERR_OK;
}
