/* What a board finds out about itself beyond the check of its image at start, and how it is protected. A small board has none of this:
 * BOARD_CHECKS 0. */
#ifndef REFLUX_HAL_SELF_CHECK_H
#define REFLUX_HAL_SELF_CHECK_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/image.h"

#ifndef BOARD_CHECKS
#define BOARD_CHECKS 1
#endif

/* Reads the next piece of the image. HAL_IMAGE_DAMAGED when two passes in a row have found another checksum than the image's own, because
 * one could be a bit that was read wrong. For the main loop: some 1,200 cycles. */
enum hal_image hal_image_watch(void);

/* The first address at which the RAM failed its test at power-on; 0: it did not fail, or was not tested. */
uint32_t hal_ram_failed_at(void);

/* Which option bytes protect the board, in a few words for `version`; NULL where there are none. */
enum hal_protection { HAL_PROTECTION_WATCHDOG, HAL_PROTECTION_PROGRAM };
const char *hal_protection_text(enum hal_protection what);

/* Nothing holds the board in reset while its supply is too low to run: what it does then is not specified, and a write to the flash may
 * be cut anywhere. */
bool hal_brown_out_off(void);

#endif
