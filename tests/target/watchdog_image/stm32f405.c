/* The STM32F405 with the clock that it has after a reset, and with the port's own watchdog and pins. */
#include "board.h"
#include "device.h"
#include "hal/tick.h"
#include "registers.h"

#define BAUD 115200u

const uint32_t device_hz = 16000000u;

/* The watchdog starts before the first tick. */
void hal_tick_lock(void) {}
void hal_tick_unlock(void) {}

void device_start(void)
{
    pins_start();
    USART_BRR(USART1_BASE) = (device_hz + BAUD / 2u) / BAUD;
    USART_CR1(USART1_BASE) = USART_CR1_UE | USART_CR1_TE;
}

void device_send(char byte)
{
    while ((USART_SR(USART1_BASE) & USART_SR_TXE) == 0) {
    }
    USART_DR(USART1_BASE) = (uint8_t)byte;
}
