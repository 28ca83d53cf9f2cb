/* What parameter_find.c and the file for blocks share. */
#ifndef REFLUX_SETTINGS_PARAMETER_FIND_H
#define REFLUX_SETTINGS_PARAMETER_FIND_H

#include "settings/parameters.h"

/* How many parameters there are without those of blocks. */
unsigned parameter_table_count(void);
/* parameter_find_id() for ids above 16 bits. */
MUST_CHECK enum err parameter_find_block_id(const struct config *config, uint32_t id,
                                            struct parameter *p);

#endif
