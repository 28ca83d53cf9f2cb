/* What a check of settings says where it refuses them. */
#ifndef REFLUX_BLOCK_REFUSE_H
#define REFLUX_BLOCK_REFUSE_H

#include "block/block.h"

/* ERR_RANGE. member, field, wanted: struct block_fault. */
static inline enum err block_refuse(struct block_fault *fault, unsigned member, const char *field,
                                    const char *wanted)
{
    *fault = (struct block_fault){.member = (uint8_t)member, .field = field, .wanted = wanted};
    return ERR_RANGE;
}

#endif
