/* Checks that the firmware in the flash is the one that was built: a CRC-32 (base/crc32.h) over all that is flashed stands behind
 * it, put there by tools/cmake/image_crc.py. */
#ifndef REFLUX_HAL_IMAGE_H
#define REFLUX_HAL_IMAGE_H

#include <stdint.h>

enum hal_image {
    HAL_IMAGE_NO_CHECKSUM, /* a process of an operating system has none */
    HAL_IMAGE_WHOLE,
    HAL_IMAGE_DAMAGED,   /* this and the following: nothing may act */
    HAL_IMAGE_RAM_FAILED /* its test at power-on (hal/self_check.h) */
};

/* Reads the whole image: once, at start. Eleven instructions a byte, which a Cortex-M does in some 18 cycles where the
 * flash does not keep it waiting: 190 KB take 20 ms at 168 MHz, 92 KB 69 ms at 24 MHz. */
enum hal_image hal_image_check(void);

/* Bytes that are flashed, and the checksum in the last four of them; 0 where there is none. */
uint32_t hal_image_bytes(void);
uint32_t hal_image_crc(void);

#endif
