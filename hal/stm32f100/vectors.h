/* Rows of the vector table behind the core's own, for hal/stm32/startup.c.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F100_VECTORS_H
#define REFLUX_STM32F100_VECTORS_H

#include "board.h"
#include "hal/tick.h"
#include "io_interrupts.h"

#define VECTORS_UNEXPECTED(first, last)                                                            \
    [16 + (first)... 16 + (last)] = {.handler = interrupt_unexpected}

#if HAL_BOARD_CLOCK
#define PORT_VECTORS                                                                               \
    VECTORS_UNEXPECTED(0, SPI1_IRQ - 1),                                                           \
        [16 + SPI1_IRQ] = {.handler = interrupt_spi1},                                             \
              [16 + SPI2_IRQ] = {.handler = interrupt_spi2},                                       \
              [16 + USART1_IRQ] = {.handler = interrupt_usart1},                                   \
              VECTORS_UNEXPECTED(USART2_IRQ, USART2_IRQ),                                          \
              [16 + USART3_IRQ] = {.handler = interrupt_usart3},                                   \
              VECTORS_UNEXPECTED(USART3_IRQ + 1, CHIP_INTERRUPTS - 1)
#else
#define PORT_VECTORS                                                                               \
    [16 ... 16 + USART1_IRQ - 1] = {.handler = interrupt_unexpected},                              \
                              [16 + USART1_IRQ] = {.handler = interrupt_usart1},                   \
                              [16 + USART2_IRQ] = {.handler = interrupt_usart2},                   \
                              [16 + USART2_IRQ + 1 ... 16 + CHIP_INTERRUPTS -                      \
                                  1] = {.handler = interrupt_unexpected}
#endif

#endif
