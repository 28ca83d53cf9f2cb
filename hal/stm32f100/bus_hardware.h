/* SPI buses of the STM32F100, and serial ports of its 1-wire buses. Rows of the tables in hal/stm32/spi.c and onewire.c: base, bit of the clock,
 * interrupt, alternate function (which a pin has one of), whether it is on APB2, pins.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F100_BUS_HARDWARE_H
#define REFLUX_STM32F100_BUS_HARDWARE_H

#include "board_pins.h"
#include "io_interrupts.h"

#define SPI_BUSES 2u
#define SPI_HARDWARE                                                                               \
    {0x40013000u, BIT(12), SPI1_IRQ, 0, 1, {SPI1_PINS}},                                           \
    {                                                                                              \
        0x40003800u, BIT(14), SPI2_IRQ, 0, 0,                                                      \
        {                                                                                          \
            SPI2_PINS                                                                              \
        }                                                                                          \
    }

/* USART3 on PB10. */
#define WIRES           1u
#define WIRE_FUNCTION   0u
#define WIRE1_INTERRUPT interrupt_usart3
#define WIRE_HARDWARE                                                                              \
    {                                                                                              \
        USART3_BASE, BIT(18), USART3_IRQ, 0, WIRE1_PIN                                             \
    }

#endif
