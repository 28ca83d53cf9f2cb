/* The independent watchdog (RM0041 chapter 18, RM0090 chapter 21): it has a clock of its own that is good to
 * some ten percent, so that a time-out may come a third early. In a debug build it stops while a debugger halts the core. */
#include "hal/watchdog.h"
#include "board.h"
#include "hal/tick.h"
#include "registers.h"
#include "watchdog_time.h"

#define WAIT_TURNS 2000000u /* six periods of the slow clock */

/* A written value takes some periods of the slow clock to arrive; until then it reads wrong and cannot be written. */
static void wait_arrived(void)
{
    for (uint32_t i = 0; i < WAIT_TURNS && IWDG_SR != 0; i++) {
    }
}

/* The prescaler has room for the longest time-out and stays, so that a change is one register. */
bool hal_watchdog_start(uint32_t timeout_ms)
{
    struct watchdog_time time = watchdog_time(2u * timeout_ms, LSI_PER_MS);
    time.reload = watchdog_reload(timeout_ms, time.prescaler, LSI_PER_MS);
    pins_freeze_watchdog();
    IWDG_KR = IWDG_KR_START;
    wait_arrived();
    hal_tick_lock(); /* a feeding in between would close the registers again */
    IWDG_KR = IWDG_KR_ACCESS;
    IWDG_PR = time.prescaler;
    IWDG_RLR = time.reload;
    hal_tick_unlock();
    wait_arrived();
    IWDG_KR = IWDG_KR_RELOAD;
    /* In the emulator nothing was written anywhere. */
    return time.reload != 0 && IWDG_RLR == time.reload && IWDG_PR == time.prescaler;
}

/* RM0090 21.4.3, RM0041 18.4.3: the register is written and read while nothing is on its way to it. */
bool hal_watchdog_change(uint32_t timeout_ms)
{
    if (IWDG_SR != 0) {
        return false;
    }
    uint16_t reload = watchdog_reload(timeout_ms, IWDG_PR, LSI_PER_MS);
    if (IWDG_RLR == reload) {
        return true;
    }
    IWDG_KR = IWDG_KR_ACCESS;
    IWDG_RLR = reload;
    return false;
}

void hal_watchdog_feed(void)
{
    IWDG_KR = IWDG_KR_RELOAD;
}
