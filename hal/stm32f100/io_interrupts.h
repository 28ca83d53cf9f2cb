/* Interrupts of the STM32F100's buses (RM0041 table 50).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F100_IO_INTERRUPTS_H
#define REFLUX_STM32F100_IO_INTERRUPTS_H

#include "bus.h"

#define SPI1_IRQ   35u
#define SPI2_IRQ   36u
#define USART3_IRQ 39u

void interrupt_spi1(void);
void interrupt_spi2(void);
void interrupt_usart3(void);

#endif
