/* The independent watchdog (RM0041 chapter 18, RM0090 chapter 21): it has a clock of its own that is good to
 * some ten percent, so that a time-out may come a third early. It stops while a debugger halts the core. */
#include "hal/watchdog.h"
#include "board.h"
#include "registers.h"

#define RELOAD_MAX 4095u
#define WAIT_TURNS 2000000u /* six periods of the slow clock */

bool hal_watchdog_start(uint32_t timeout_ms)
{
    uint32_t prescaler = 0; /* divides by 4 << prescaler, up to 256 */
    while (prescaler < 6u && timeout_ms > (RELOAD_MAX * (4u << prescaler)) / LSI_PER_MS) {
        prescaler++;
    }
    uint32_t longest = (RELOAD_MAX * (4u << prescaler)) / LSI_PER_MS;
    if (timeout_ms > longest) {
        timeout_ms = longest;
    }
    uint32_t reload = timeout_ms * LSI_PER_MS / (4u << prescaler);

    pins_freeze_watchdog();
    IWDG_KR = IWDG_KR_START;
    IWDG_KR = IWDG_KR_ACCESS;
    IWDG_PR = prescaler;
    IWDG_RLR = reload;
    for (uint32_t i = 0; i < WAIT_TURNS && IWDG_SR != 0; i++) {
    }
    IWDG_KR = IWDG_KR_RELOAD;
    /* In the emulator nothing was written anywhere. */
    return reload != 0 && IWDG_RLR == reload && IWDG_PR == prescaler;
}

void hal_watchdog_feed(void)
{
    IWDG_KR = IWDG_KR_RELOAD;
}
