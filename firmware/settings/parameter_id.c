/* Parameters by id (parameters.h says what an id is). */
#include "settings/parameter_find.h"

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
    if (id >> 16)
        return parameter_find_block_id(config, id, p);
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
