/* Arm MPS2 with the image AN386, emulated: CMSDK devices (DAI0386). Its watchdog bites. */
#include "device.h"
#include "hal/watchdog.h"

#define REG32(address) (*(volatile uint32_t *)(address))
#define UART0_DATA     REG32(0x40004000u)
#define UART0_STATE    REG32(0x40004004u)
#define UART0_CTRL     REG32(0x40004008u)
#define UART0_BAUD     REG32(0x40004010u)
#define WDOG_LOAD      REG32(0x40008000u)
#define WDOG_CTRL      REG32(0x40008008u)
#define WDOG_CLEAR     REG32(0x4000800Cu)
#define WDOG_LOCK      REG32(0x40008C00u)

const uint32_t device_hz = 25000000u;

bool hal_watchdog_start(uint32_t timeout_ms)
{
    WDOG_LOCK = 0x1ACCE551u;
    WDOG_LOAD =
        device_hz / 1000u * timeout_ms / 2u; /* it warns half-way, and resets the second time */
    WDOG_CTRL = 3u;
    return WDOG_CTRL == 3u;
}

void hal_watchdog_feed(void)
{
    WDOG_CLEAR = 1u;
}

void device_start(void)
{
    UART0_BAUD = 16u;
    UART0_CTRL = 1u;
}

void device_send(char byte)
{
    while (UART0_STATE & 1u) {
    }
    UART0_DATA = (uint8_t)byte;
}
