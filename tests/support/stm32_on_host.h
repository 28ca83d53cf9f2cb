/* Included before a file of the STM32F405's port that a test builds for the host: registers are plain memory there but
 * for the flash's status, behind which the test does what flash does; barriers are no instructions. */
#ifndef REFLUX_TESTS_STM32_ON_HOST_H
#define REFLUX_TESTS_STM32_ON_HOST_H

#include "registers.h"

#undef FLASH_SR
#define FLASH_SR (*flash_status())
volatile uint32_t *flash_status(void);

/* The core's own registers lie where a sanitizer keeps its notes. */
#undef SYST_CSR
#define SYST_CSR core_registers[0]
#undef SCB_ICSR
#define SCB_ICSR core_registers[1]
#undef NVIC_ICPR
#define NVIC_ICPR(n) core_registers[2 + (n)]
extern volatile uint32_t core_registers[8];

__asm(".macro dsb\n.endm\n.macro isb\n.endm\n.macro wfi\n.endm\n"
      ".macro cpsid what\n.endm\n.macro cpsie what\n.endm");

#endif
