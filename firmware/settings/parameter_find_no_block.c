/* The same as parameter_find_block.c on a board without blocks. */
#include "settings/parameter_find.h"

bool parameter_of(const struct config *config, unsigned n, struct parameter *p)
{
    (void)config;
    return parameter_at(n, p);
}

enum err parameter_find_in(const struct config *config, const char *name, struct parameter *p)
{
    (void)config;
    return parameter_find(name, p);
}

unsigned parameter_count(const struct config *config)
{
    (void)config;
    return parameter_table_count();
}

enum err parameter_find_block_id(const struct config *config, uint32_t id, struct parameter *p)
{
    (void)config;
    (void)id;
    (void)p;
    return ERR_UNKNOWN;
}
