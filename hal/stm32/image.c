/* The checksum behind the image: sections.ld makes room for it. */
#include "hal/image.h"

#include <stddef.h>

#include "base/crc32.h"

extern const uint8_t image_start[], image_crc[]; /* from the linker script */

uint32_t hal_image_bytes(void)
{
    return (uint32_t)(image_crc - image_start) + (uint32_t)sizeof(uint32_t);
}

/* volatile: what the file was linked with is not what is there. */
uint32_t hal_image_crc(void)
{
    return *(const volatile uint32_t *)(const void *)image_crc;
}

enum hal_image hal_image_check(void)
{
    uint32_t crc = crc32_update(0, image_start, (size_t)(image_crc - image_start));
    return crc == hal_image_crc() ? HAL_IMAGE_WHOLE : HAL_IMAGE_DAMAGED;
}
