#include "block/refuse.h"

enum err block_refuse(struct block_fault *fault, unsigned member, const char *field,
                      const char *wanted)
{
    *fault = (struct block_fault){.member = (uint8_t)member, .field = field, .wanted = wanted};
    return ERR_RANGE;
}
