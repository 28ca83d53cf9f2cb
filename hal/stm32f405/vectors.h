/* Rows of the vector table behind the core's own (RM0090 table 62), for hal/stm32/startup.c.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F405_VECTORS_H
#define REFLUX_STM32F405_VECTORS_H

#include "board.h"
#include "hal/tick.h"
#include "io_interrupts.h"

#define VECTORS_UNEXPECTED(first, last)                                                            \
    [16 + (first)... 16 + (last)] = {.handler = interrupt_unexpected}
#define VECTORS_OF_LINES                                                                           \
    [16 + USART1_IRQ] = {.handler = interrupt_usart1},                                             \
          [16 + USART2_IRQ] = {.handler = interrupt_usart2}

#if HAL_BOARD_CLOCK
#define PORT_VECTORS                                                                               \
    VECTORS_OF_LINES, IO_VECTORS, VECTORS_UNEXPECTED(0, 5), VECTORS_UNEXPECTED(11, 17),            \
        VECTORS_UNEXPECTED(19, 22), VECTORS_UNEXPECTED(24, 30), VECTORS_UNEXPECTED(39, 39),        \
        VECTORS_UNEXPECTED(41, 50), VECTORS_UNEXPECTED(53, 70),                                    \
        VECTORS_UNEXPECTED(72, CHIP_INTERRUPTS - 1)
#else
#define PORT_VECTORS                                                                               \
    VECTORS_OF_LINES, VECTORS_UNEXPECTED(0, USART1_IRQ - 1),                                       \
        VECTORS_UNEXPECTED(USART2_IRQ + 1, CHIP_INTERRUPTS - 1)
#endif

#endif
