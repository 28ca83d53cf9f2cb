/* A time-out of the independent watchdog as its registers hold it (RM0041 18.3, RM0090 21.3): its counter runs from
 * `reload` down to 0 at a 4 << prescaler th of the slow clock. Plain arithmetic, tried on the host. */
#ifndef REFLUX_STM32_WATCHDOG_TIME_H
#define REFLUX_STM32_WATCHDOG_TIME_H

#include <stdint.h>

#define WATCHDOG_RELOAD_MAX    4095u
#define WATCHDOG_PRESCALER_MAX 6u

struct watchdog_time {
    uint8_t prescaler;
    uint16_t reload;
};

/* The nearest below timeout_ms, with the finest steps; at most what the registers hold. slow_per_ms: kHz of the slow
 * clock. */
static inline struct watchdog_time watchdog_time(uint32_t timeout_ms, uint32_t slow_per_ms)
{
    uint32_t prescaler = 0;
    while (prescaler < WATCHDOG_PRESCALER_MAX &&
           timeout_ms > WATCHDOG_RELOAD_MAX * (4u << prescaler) / slow_per_ms)
        prescaler++;
    uint32_t longest = WATCHDOG_RELOAD_MAX * (4u << prescaler) / slow_per_ms;
    if (timeout_ms > longest)
        timeout_ms = longest;
    return (struct watchdog_time){(uint8_t)prescaler,
                                  (uint16_t)(timeout_ms * slow_per_ms / (4u << prescaler))};
}

/* Largest reload whose time-out is not above timeout_ms with this prescaler; at most what the register holds. */
static inline uint16_t watchdog_reload(uint32_t timeout_ms, uint32_t prescaler,
                                       uint32_t slow_per_ms)
{
    uint32_t reload = timeout_ms * slow_per_ms / (4u << prescaler);
    return (uint16_t)(reload < WATCHDOG_RELOAD_MAX ? reload : WATCHDOG_RELOAD_MAX);
}

#endif
