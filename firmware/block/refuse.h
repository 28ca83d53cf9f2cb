/* How a check refuses settings: it says which setting is wrong, and what would be right. */
#ifndef REFLUX_BLOCK_REFUSE_H
#define REFLUX_BLOCK_REFUSE_H

#include "block/block.h"

/* Fills *fault with member, field and wanted. Returns ERR_RANGE. */
enum err block_refuse(struct block_fault *fault, unsigned member, const char *field,
                      const char *wanted);

#endif
