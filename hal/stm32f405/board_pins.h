/* Which pins of the STM32F405 a device may have, and where its buses are. The host's buses are at the same pins (hal/host/buses.c).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F405_BOARD_PINS_H
#define REFLUX_STM32F405_BOARD_PINS_H

#include "hal/output.h"
#include "hal/pin.h"

#define PIN_PORTS 4u
/* pin_modes.c says what needs the others. */
#define FREE_A 0x01F3u /* PA0 PA1, PA4 to PA8 */
#define FREE_B 0xD3C3u /* PB0 PB1, PB6 to PB9, PB12, PB14 PB15 */
#define FREE_C 0x13FFu /* PC0 to PC9, PC12 */
#define FREE_D 0x0004u /* PD2 */

#define FREE_PINS FREE_A, FREE_B, FREE_C, FREE_D

/* Clock, in, out. */
#define SPI1_PINS HAL_PIN('A', 5), HAL_PIN('A', 6), HAL_PIN('A', 7)
#define SPI2_PINS HAL_PIN('B', 13), HAL_PIN('B', 14), HAL_PIN('B', 15)
#define SPI3_PINS HAL_PIN('C', 10), HAL_PIN('C', 11), HAL_PIN('C', 12)
/* Clock, data. */
#define I2C1_PINS HAL_PIN('B', 6), HAL_PIN('B', 7)
#define I2C2_PINS HAL_PIN('B', 10), HAL_PIN('B', 11)
/* Transmitters of USART6 and UART4. */
#define WIRE1_PIN HAL_PIN('C', 6)
#define WIRE2_PIN HAL_PIN('A', 0)

/* Port, number, timer and channel of the pins with a pulse width (RM0090 chapters 18 and 19), and their highest frequency. */
#define PWM_PINS(P)                                                                                \
    P('A', 0, 5, 1)                                                                                \
    P('A', 1, 5, 2)                                                                                \
    P('A', 6, 3, 1)                                                                                \
    P('A', 7, 3, 2)                                                                                \
    P('B', 0, 3, 3)                                                                                \
    P('B', 1, 3, 4)                                                                                \
    P('B', 6, 4, 1)                                                                                \
    P('B', 7, 4, 2)                                                                                \
    P('B', 8, 4, 3)                                                                                \
    P('B', 9, 4, 4)                                                                                \
    P('B', 14, 12, 1)                                                                              \
    P('B', 15, 12, 2)                                                                              \
    P('C', 6, 3, 1)                                                                                \
    P('C', 7, 3, 2)                                                                                \
    P('C', 8, 3, 3)                                                                                \
    P('C', 9, 3, 4)
#define PWM_HZ_MOST 100000u

/* Pulse widths: the timers' clock where the crystal runs, and counts of a period, so that one more fits a compare value of 16 bits. */
#define PWM_TIMER_HZ   84000000u
#define PWM_COUNT_MOST 65535u
static inline uint32_t pwm_divider(uint32_t timer_hz, uint32_t hz)
{
    return timer_hz / hz / PWM_COUNT_MOST + 1u;
}
static inline uint32_t pwm_counts(uint32_t timer_hz, uint32_t hz)
{
    return timer_hz / hz / pwm_divider(timer_hz, hz);
}
/* The compare value for a part of HAL_PWM_FULL. */
static inline uint32_t pwm_compare(uint32_t counts, uint16_t part)
{
    return part * counts / HAL_PWM_FULL;
}

#endif
