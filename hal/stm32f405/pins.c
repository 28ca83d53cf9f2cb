/* Pins of the STM32F405 (RM0090 chapters 7, 8 and 38), and its name. */
#include "board.h"
#include "hal/identity.h"
#include "registers.h"

void pins_start(void)
{
    RCC_AHB1ENR |= RCC_AHB1ENR_GPIOA;
    RCC_APB1ENR |= RCC_APB1ENR_USART2;
    RCC_APB2ENR |= RCC_APB2ENR_USART1;
    (void)RCC_APB2ENR;
    /* Alternate function 7, and a pull-up where a line may be left open. */
    GPIOA_AFRL = (GPIOA_AFRL & ~0x0000FF00u) | 0x00007700u;
    GPIOA_AFRH = (GPIOA_AFRH & ~0x00000FF0u) | 0x00000770u;
    GPIOA_PUPDR = (GPIOA_PUPDR & ~((3u << 6) | (3u << 20))) | (1u << 6) | (1u << 20);
    GPIOA_MODER = (GPIOA_MODER & ~((15u << 4) | (15u << 18))) | (10u << 4) | (10u << 18);
}

void pins_freeze_watchdog(void)
{
#ifdef NDEBUG
    DBGMCU_APB1_FZ &=
        ~DBGMCU_APB1_FZ_IWDG; /* a debugger may have set it, and a reset does not clear it */
#else
    DBGMCU_APB1_FZ |= DBGMCU_APB1_FZ_IWDG;
#endif
}

const char *hal_board_name(void)
{
    return "stm32f405";
}

const char *hal_board_text(void)
{
    return clock_is_model() ? "STM32F405, Cortex-M4F, in an emulator"
                            : "STM32F405, Cortex-M4F, chip";
}
