/* Parameters by number and name; those of blocks: parameter_find_block.c. */
#include <string.h>

#include "settings/parameter_find.h"

unsigned parameter_table_count(void)
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
