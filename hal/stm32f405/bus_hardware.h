/* SPI buses of the STM32F405, and serial ports of its 1-wire buses. Rows of the tables in hal/stm32/spi.c and onewire.c: base, bit of the clock,
 * interrupt, alternate function, whether it is on APB2, pins.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F405_BUS_HARDWARE_H
#define REFLUX_STM32F405_BUS_HARDWARE_H

#include "board_pins.h"
#include "io_interrupts.h"

#define SPI_BUSES 3u
#define SPI_HARDWARE                                                                               \
    {0x40013000u, BIT(12), SPI1_IRQ, 5, 1, {SPI1_PINS}},                                           \
        {0x40003800u, BIT(14), SPI2_IRQ, 5, 0, {SPI2_PINS}},                                       \
    {                                                                                              \
        0x40003C00u, BIT(15), SPI3_IRQ, 6, 0,                                                      \
        {                                                                                          \
            SPI3_PINS                                                                              \
        }                                                                                          \
    }

/* USART6 on PC6, UART4 on PA0. */
#define WIRES           2u
#define WIRE_FUNCTION   8u
#define WIRE1_INTERRUPT interrupt_usart6
#define WIRE2_INTERRUPT interrupt_uart4
#define WIRE_HARDWARE                                                                              \
    {USART6_BASE, BIT(5), USART6_IRQ, 1, WIRE1_PIN},                                               \
    {                                                                                              \
        UART4_BASE, BIT(19), UART4_IRQ, 0, WIRE2_PIN                                               \
    }

#endif
