/* Rows of the vector table behind the core's own, for hal/stm32/startup.c.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F100_VECTORS_H
#define REFLUX_STM32F100_VECTORS_H

#include "board.h"
#include "registers.h"

#define PORT_VECTORS                                                                               \
    [16 ... 16 + USART1_IRQ - 1] = {.handler = interrupt_unexpected},                              \
                              [16 + USART1_IRQ] = {.handler = interrupt_usart1},                   \
                              [16 + USART2_IRQ] = {.handler = interrupt_usart2},                   \
                              [16 + USART2_IRQ + 1 ... 16 + CHIP_INTERRUPTS -                      \
                                  1] = {.handler = interrupt_unexpected}

#endif
