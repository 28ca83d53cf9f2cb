/* The kinds of blocks of this build, found by name. */
#ifndef REFLUX_EXCHANGE_BLOCK_KINDS_H
#define REFLUX_EXCHANGE_BLOCK_KINDS_H

#include "block/block.h"

/* Returns the place in block_kinds[], or PLAN_NONE (0xFF) where this build has no such kind. */
uint8_t block_kind_find(const char *name);

#endif
