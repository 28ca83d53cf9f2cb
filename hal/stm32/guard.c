/* Address 0 is the flash once more, on the chip and in the emulator: what is read through a null pointer is the vector
 * table, and passes for data. With a protection unit (PM0214 4.2) nobody reaches there: the first mebibyte, which is all
 * of the alias, is forbidden, and everything else is as without the unit. The code itself runs at 0x08000000.
 */
#include "board.h"
#include "registers.h"

#define ALIAS_LOG2 20u

void guard_start(void)
{
    if ((MPU_TYPE & MPU_TYPE_DREGION) == 0) {
        return; /* the STM32F100 has none */
    }
    MPU_RNR = 0;
    MPU_RBAR = 0;
    MPU_RASR = MPU_RASR_XN | MPU_RASR_AP_NONE | MPU_RASR_SIZE(ALIAS_LOG2) | MPU_RASR_ENABLE;
    MPU_CTRL = MPU_CTRL_PRIVDEFENA | MPU_CTRL_ENABLE;
    __asm volatile("dsb\n\tisb" ::: "memory");
}
