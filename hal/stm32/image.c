/* The checksum behind the image: sections.ld makes room for it. */
#include "hal/image.h"

#include <stddef.h>

#include "base/crc32.h"
#include "hal/self_check.h"

#define WATCH_BYTES 64u /* 18 cycles each: 7 us at 168 MHz */

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
    if (BOARD_CHECKS && hal_ram_failed_at() != 0) {
        return HAL_IMAGE_RAM_FAILED;
    }
    uint32_t crc = crc32_update(0, image_start, (size_t)(image_crc - image_start));
    return crc == hal_image_crc() ? HAL_IMAGE_WHOLE : HAL_IMAGE_DAMAGED;
}

enum hal_image hal_image_watch(void)
{
    static uint32_t at, crc;
    static bool doubted;
    uint32_t size = (uint32_t)(image_crc - image_start);
    uint32_t n = size - at < WATCH_BYTES ? size - at : WATCH_BYTES;
    crc = crc32_update(crc, image_start + at, n);
    at += n;
    if (at < size) {
        return HAL_IMAGE_WHOLE;
    }
    bool differs = crc != hal_image_crc(), damaged = differs && doubted;
    at = crc = 0;
    doubted = differs;
    return damaged ? HAL_IMAGE_DAMAGED : HAL_IMAGE_WHOLE;
}
