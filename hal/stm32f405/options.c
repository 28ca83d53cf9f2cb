/* The option bytes of the STM32F405 (RM0090 Rev 21 3.7 and 3.9.9): what protects the board. They are flash, whose writing must not be cut, so the
 * firmware tells them and leaves them to somebody with a programmer (tools/flash --protect). */
#include <stddef.h>

#include "board.h"
#include "hal/image.h"
#include "hal/self_check.h"
#include "registers.h"

/* Sectors that hold something of the image: four of 16 KiB, one of 64 KiB, then of 128 KiB (RM0090 table 5). */
static uint32_t program_sectors(void)
{
    uint32_t sectors = 0, end = 0;
    for (uint32_t s = 0; end < hal_image_bytes(); s++) {
        sectors |= BIT(s);
        end += s < 4u ? 0x4000u : s == 4u ? 0x10000u : 0x20000u;
    }
    return sectors;
}

const char *hal_protection_text(enum hal_protection what)
{
    uint32_t options = FLASH_OPTCR, program = program_sectors();
    if (clock_is_model()) {
        return NULL;
    }
    if (what == HAL_PROTECTION_WATCHDOG) {
        return (options & FLASH_OPTCR_WDG_SW) == 0 ? "watchdog from reset on"
                                                   : "watchdog only from start-up on";
    }
    uint32_t open = options >> FLASH_OPTCR_NWRP & program;
    return open == 0         ? "program write-protected"
           : open == program ? "program NOT write-protected"
                             : "program write-protected in part";
}

bool hal_brown_out_off(void)
{
    return !clock_is_model() && (FLASH_OPTCR & FLASH_OPTCR_BOR) == FLASH_OPTCR_BOR;
}
