/* Interrupts of the STM32F405's buses and inputs (RM0090 table 62), and their rows of a vector table: IO_VECTORS within the braces of a table that
 * begins with the core's sixteen. All have the priority PRIORITY_BUS.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F405_IO_INTERRUPTS_H
#define REFLUX_STM32F405_IO_INTERRUPTS_H

#include "bus.h"

#define EXTI0_IRQ     6u /* and the next four */
#define ADC_IRQ       18u
#define EXTI9_5_IRQ   23u
#define I2C1_EV_IRQ   31u
#define I2C1_ER_IRQ   32u
#define I2C2_EV_IRQ   33u
#define I2C2_ER_IRQ   34u
#define SPI1_IRQ      35u
#define SPI2_IRQ      36u
#define SPI3_IRQ      51u
#define EXTI15_10_IRQ 40u
#define UART4_IRQ     52u
#define USART6_IRQ    71u

void interrupt_exti0(void);
void interrupt_exti1(void);
void interrupt_exti2(void);
void interrupt_exti3(void);
void interrupt_exti4(void);
void interrupt_exti9_5(void);
void interrupt_exti15_10(void);
void interrupt_adc(void);
void interrupt_i2c1_event(void);
void interrupt_i2c1_error(void);
void interrupt_i2c2_event(void);
void interrupt_i2c2_error(void);
void interrupt_spi1(void);
void interrupt_spi2(void);
void interrupt_spi3(void);
void interrupt_uart4(void);
void interrupt_usart6(void);

#define IO_VECTORS                                                                                 \
    [16 + EXTI0_IRQ] = {.handler = interrupt_exti0},                                               \
          [16 + EXTI0_IRQ + 1] = {.handler = interrupt_exti1},                                     \
          [16 + EXTI0_IRQ + 2] = {.handler = interrupt_exti2},                                     \
          [16 + EXTI0_IRQ + 3] = {.handler = interrupt_exti3},                                     \
          [16 + EXTI0_IRQ + 4] = {.handler = interrupt_exti4},                                     \
          [16 + ADC_IRQ] = {.handler = interrupt_adc},                                             \
          [16 + EXTI9_5_IRQ] = {.handler = interrupt_exti9_5},                                     \
          [16 + EXTI15_10_IRQ] = {.handler = interrupt_exti15_10},                                 \
          [16 + I2C1_EV_IRQ] = {.handler = interrupt_i2c1_event},                                  \
          [16 + I2C1_ER_IRQ] = {.handler = interrupt_i2c1_error},                                  \
          [16 + I2C2_EV_IRQ] = {.handler = interrupt_i2c2_event},                                  \
          [16 + I2C2_ER_IRQ] = {.handler = interrupt_i2c2_error},                                  \
          [16 + SPI1_IRQ] = {.handler = interrupt_spi1},                                           \
          [16 + SPI2_IRQ] = {.handler = interrupt_spi2},                                           \
          [16 + SPI3_IRQ] = {.handler = interrupt_spi3},                                           \
          [16 + UART4_IRQ] = {.handler = interrupt_uart4},                                         \
          [16 + USART6_IRQ] = {.handler = interrupt_usart6}

#endif
