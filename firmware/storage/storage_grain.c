/* Grains that begin and close a set. */
#include "base/crc32.h"
#include "storage/storage_parts.h"

uint32_t storage_grain(uint8_t *grain, uint32_t magic, uint32_t a, uint32_t b, uint32_t crc)
{
    put32(grain, magic);
    put32(grain + 4, a);
    put32(grain + 8, b);
    crc = crc32_update(crc, grain, 12);
    put32(grain + 12, crc);
    return crc;
}

uint32_t storage_renewal(const struct storage_set *set, uint8_t *grain, uint32_t crc)
{
    return storage_grain(grain, RENEWAL_MAGIC, set->sequence,
                         set->length | set->address / STORAGE_GRAIN << 16, crc);
}
