/* Who this board is, why it started, and how to start it again. */
#ifndef REFLUX_HAL_IDENTITY_H
#define REFLUX_HAL_IDENTITY_H

#include <stdint.h>

enum hal_reset {
    HAL_RESET_POWER_ON,
    HAL_RESET_REQUESTED, /* hal_reboot() */
    HAL_RESET_WATCHDOG,
    HAL_RESET_PIN,
    HAL_RESET_FAULT,
    HAL_RESET_UNKNOWN
};

const char *hal_board_name(void); /* "stm32f405", "host" */
const char *hal_board_text(void); /* one line: processor, how recognised (chip or emulator) */
enum hal_reset hal_reset_cause(void);
/* Differs from one start of the board to the next: a counter kept over resets, or anything else that does.
 * The plant link uses it to notice a restarted controller. */
uint32_t hal_boot_id(void);
/* Restarts the board; the transmit rings are lost. Does not return. */
_Noreturn void hal_reboot(void);

#endif
