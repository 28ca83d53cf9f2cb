/* Finds parameters by number, name and id. Those of blocks depend on the kinds in a configuration. */
#include <string.h>

#include "settings/parameters.h"

static unsigned table_count(void)
{
    unsigned n = 0;
    for (unsigned g = 0; g < parameter_group_count; g++)
        n += (unsigned)parameter_groups[g].count * parameter_groups[g].n_fields;
    return n;
}

bool parameter_at(unsigned n, struct parameter *p)
{
    for (unsigned g = 0; g < parameter_group_count; g++) {
        const struct parameter_group *group = &parameter_groups[g];
        unsigned all = (unsigned)group->count * group->n_fields;
        if (n < all) {
            *p = (struct parameter){.group = group,
                                    .field = &group->fields[n % group->n_fields],
                                    .index = (uint8_t)(n / group->n_fields)};
            return true;
        }
        n -= all;
    }
    return false;
}

enum err parameter_find(const char *name, struct parameter *p)
{
    for (unsigned g = 0; g < parameter_group_count; g++) {
        const struct parameter_group *group = &parameter_groups[g];
        size_t n = strlen(group->name);
        if (strncmp(name, group->name, n) != 0)
            continue;
        const char *s = name + n;
        unsigned index = 0;
        if (group->indexed) {
            if (*s < '1' || *s > '9')
                continue;
            for (; *s >= '0' && *s <= '9' && index < 1000; s++)
                index = index * 10 + (unsigned)(*s - '0');
            if (index > group->count && index > group->most)
                continue;
            index--;
        }
        if (*s++ != '.')
            continue;
        for (unsigned f = 0; f < group->n_fields; f++) {
            if (strcmp(s, group->fields[f].name) != 0)
                continue;
            *p = (struct parameter){
                .group = group, .field = &group->fields[f], .index = (uint8_t)index};
            return index < group->count ? ERR_OK : ERR_UNSUPPORTED;
        }
    }
    return ERR_UNKNOWN;
}

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
    unsigned others = table_count();
    if (!CONFIG_BLOCKS || n < others)
        return parameter_at(n, p);
    if (!block_parameter_at(config, n - others, &place))
        return false;
    *p = of_block(&place);
    return true;
}

unsigned parameter_count(const struct config *config)
{
    unsigned n = table_count();
    struct parameter p;
    while (CONFIG_BLOCKS && parameter_of(config, n, &p))
        n++;
    return n;
}

static enum err find_numbered(const struct config *config, const char *name, struct parameter *p)
{
    struct block_parameter_place place;
    const char *s = name + strlen(parameter_blocks.name);
    enum err err = parameter_find(name, p);
    if (!CONFIG_BLOCKS || err != ERR_UNKNOWN ||
        strncmp(name, parameter_blocks.name, (size_t)(s - name)) != 0 || *s < '1' ||
        *s >= '1' + CONFIG_BLOCKS || s[1] != '.')
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
    return config_block_settings(config, block) ? ERR_UNKNOWN : ERR_EMPTY;
}

enum err parameter_find_in(const struct config *config, const char *name, struct parameter *p)
{
    enum err err = find_numbered(config, name, p);
    if (!CONFIG_PEOPLE)
        return err;
    char full[40]; /* longer than any */
    for (unsigned k = 0; err == ERR_UNKNOWN && k < PARAMETER_OWNERS; k++) {
        struct text t = text_on(full, sizeof full);
        if (parameter_numbered_name(config, name, k, &t))
            err = parameter_find(full, p);
    }
    return err;
}

static enum err find_block_id(const struct config *config, uint32_t id, struct parameter *p)
{
    struct block_parameter_place place = {.block = (uint8_t)(id & 0x3F)};
    uint8_t field = (uint8_t)(id >> 16);
    uint16_t row = (uint16_t)(id >> 6 & 0x3FF);
    if (id >> 24 != parameter_blocks.id || place.block >= parameter_blocks.count)
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

uint32_t parameter_id(const struct parameter *p)
{
    if (parameter_is_of_block(p)) {
        uint32_t field = p->own ? PARAMETER_OWN_ID + (uint32_t)p->own->id : p->field->id;
        return (uint32_t)p->group->id << 24 | field << 16 | (uint32_t)p->row << 6 | p->index;
    }
    return (uint32_t)p->group->id << 12 | (uint32_t)p->field->id << 6 | p->index;
}

enum err parameter_find_id(const struct config *config, uint32_t id, struct parameter *p)
{
    if (CONFIG_BLOCKS && id >> 24)
        return find_block_id(config, id, p);
    for (unsigned g = 0; g < parameter_group_count; g++) {
        const struct parameter_group *group = &parameter_groups[g];
        if (group->id != id >> 12 || (id & 0x3F) >= group->count)
            continue;
        for (unsigned f = 0; f < group->n_fields; f++) {
            if (group->fields[f].id != (id >> 6 & 0x3F))
                continue;
            *p = (struct parameter){
                .group = group, .field = &group->fields[f], .index = (uint8_t)(id & 0x3F)};
            return ERR_OK;
        }
    }
    return ERR_UNKNOWN;
}
