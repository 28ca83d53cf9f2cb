/* The supply: a voltage detector for the flash (RM0041 4.2.2, RM0090 5.2.3), and what the brown-out reset is set to, which only the
 * STM32F405 has (RM0090 5.2.2). That is an option byte: flash, whose writing must not be cut, so it is told and left to
 * somebody with a programmer.
 */
#include "board.h"
#include "hal/identity.h"
#include "registers.h"

void supply_start(void)
{
    RCC_APB1ENR |= RCC_APB1ENR_PWR;
    (void)RCC_APB1ENR; /* a clock needs two cycles to arrive */
    PWR_CR = (PWR_CR & ~PWR_CR_PLS) | PWR_CR_PLS_CHOSEN | PWR_CR_PVDE;
}

bool supply_is_low(void)
{
    return (PWR_CSR & PWR_CSR_PVDO) != 0; /* 0 in the emulator */
}

const char *hal_supply_text(void)
{
    if (clock_is_model()) {
        return "not watched";
    }
    if (supply_is_low()) {
        return "TOO LOW for the flash, nothing is written";
    }
#ifdef FLASH_OPTCR
    static const char *const levels[] = {
        "brown-out reset level 3", "brown-out reset only level 2, set 3",
        "brown-out reset only level 1, set 3", "brown-out reset OFF, set level 3"};
    return levels[(FLASH_OPTCR & FLASH_OPTCR_BOR) >> 2];
#else
    return "enough for the flash";
#endif
}
