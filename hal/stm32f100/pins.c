/* Pins of the STM32F100 (RM0041 chapters 6, 7 and 25), and its name. */
#include "board.h"
#include "hal/identity.h"
#include "hal/uart.h"
#include "registers.h"

#define PIN_OUT_ALTERNATE 0xAu /* push-pull, 2 MHz */
#define PIN_IN_PULLED     0x8u

void pins_start(void)
{
    RCC_APB2ENR |= RCC_APB2ENR_IOPA | RCC_APB2ENR_USART1;
    if (HAL_LINK) {
        RCC_APB1ENR |= RCC_APB1ENR_USART2;
    }
    (void)RCC_APB1ENR;
    /* PA9 and PA2 send, PA10 and PA3 receive, pulled up where a line may be left open. */
    GPIOA_BSRR = (HAL_LINK ? BIT(3) : 0) | BIT(10);
    if (HAL_LINK) {
        GPIOA_CRL = (GPIOA_CRL & ~0x0000FF00u) | (PIN_OUT_ALTERNATE << 8) | (PIN_IN_PULLED << 12);
    }
    GPIOA_CRH = (GPIOA_CRH & ~0x00000FF0u) | (PIN_OUT_ALTERNATE << 4) | (PIN_IN_PULLED << 8);
}

void pins_freeze_watchdog(void)
{
#ifdef NDEBUG
    DBGMCU_CR &=
        ~DBGMCU_CR_IWDG_STOP; /* a debugger may have set it, and a reset does not clear it */
#else
    DBGMCU_CR |= DBGMCU_CR_IWDG_STOP;
#endif
}

const char *hal_board_name(void)
{
    return "stm32f100";
}

const char *hal_board_text(void)
{
    return clock_is_model() ? "STM32F100, Cortex-M3, in an emulator" : "STM32F100, Cortex-M3, chip";
}
