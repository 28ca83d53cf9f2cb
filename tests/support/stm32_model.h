/* Included before a file of an STM32's port that a test builds for the host: each register is a word that the model behind it
 * may change whenever it is looked at, and every write is noted in its order. What the core's instructions do beyond
 * barriers is a variable. Sections named in the tests are those of the chip's reference manual.
 */
#ifndef REFLUX_TESTS_STM32_MODEL_H
#define REFLUX_TESTS_STM32_MODEL_H

#include <stdint.h>

/* The word of that address; what was written before is noted first, then the model moves on. */
volatile uint32_t *stm32_register(uint32_t address);

#include "registers.h"

#undef REG32
#undef REG16
#undef REG8
#define REG32(address) (*stm32_register(address))
#define REG16(address) (*(volatile uint16_t *)stm32_register(address))
#define REG8(address)                                                                              \
    (((volatile uint8_t *)stm32_register((uint32_t)(address) & ~3u))[(address)&3u])

__asm(".ifndef stm32_macros\n"
      ".set stm32_macros, 1\n"
      ".macro dsb\n.endm\n.macro isb\n.endm\n.macro cpsid what\n.endm\n"
      ".macro cpsie what\n.endm\n.macro wfi\n.endm\n"
      ".macro mrs to, from\nmovl stm32_\\from(%rip), \\to\n.endm\n.macro msr to, from\n.endm\n"
      ".endif\n");

#endif
