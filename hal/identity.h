/* Identity of the board, the reason of its start, and a new start. */
#ifndef REFLUX_HAL_IDENTITY_H
#define REFLUX_HAL_IDENTITY_H

#include <stdbool.h>
#include <stdint.h>

enum hal_reset {
    HAL_RESET_POWER_ON,
    HAL_RESET_REQUESTED, /* hal_reboot() */
    HAL_RESET_WATCHDOG,
    HAL_RESET_PIN,
    HAL_RESET_FAULT,
    HAL_RESET_CRYSTAL, /* it failed: from now on the internal oscillator */
    HAL_RESET_UNKNOWN
};

/* Record of the last fault since power-on; in memory that survives a reset. */
struct hal_fault {
    /* number of the exception: 3 hard, 4 memory, 5 bus, 6 usage; else unexpected */
    uint32_t exception;
    uint32_t pc, lr, psr;  /* where it happened; 0 when the stack was gone */
    uint32_t status, hard; /* CFSR and HFSR */
    uint32_t address;      /* that was reached for; 0 when the processor does not know */
    bool in_tick;          /* else in the main loop or an interrupt */
    uint32_t up_ms;        /* clock at the time, low word */
    uint32_t boots_ago;    /* 1 = it caused this start */
};

/* False: none. */
bool hal_last_fault(struct hal_fault *fault);

/* "power-on", "watchdog", ... */
static inline const char *hal_reset_name(enum hal_reset cause)
{
    static const char *const names[] = {"power-on", "requested", "watchdog", "reset-pin",
                                        "fault",    "crystal",   "unknown"};
    return cause <= HAL_RESET_UNKNOWN ? names[cause] : "?";
}

const char *hal_board_name(void); /* "stm32f405", "host" */
const char *hal_board_text(void); /* one line: processor, how recognised (chip or emulator) */
/* Describes the supply and its supervision in a few words for `version`. */
const char *hal_supply_text(void);
enum hal_reset hal_reset_cause(void);
/* Differs from one start of the board to the next: a counter kept over resets, or anything else that does.
 * The plant link uses it to notice a restarted controller. */
uint32_t hal_boot_id(void);
/* Restarts the board; the transmit rings are lost. Does not return. */
_Noreturn void hal_reboot(void);

#endif
