#include "exchange/block_kinds.h"

#include <string.h>

#define NO_KIND 0xFFu

uint8_t block_kind_find(const char *name)
{
    for (uint8_t k = 0; name[0] && k < block_kind_count; k++)
        if (strcmp(block_kinds[k]->name, name) == 0)
            return k;
    return NO_KIND;
}
