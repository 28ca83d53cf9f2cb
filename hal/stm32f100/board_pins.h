/* Which pins of the STM32F100 a device may have, and where its buses are: for boards whose plant is at their own pins, so that the link's pins are
 * free. Not free are, with what needs them:
 *     PA13 PA14 PA15 PB3 PB4    the debugger, whose functions they have after a reset (RM0041 7.3.5)
 *     PA9 PA10                  the console; also the boot loader in ROM, which has no other port on this chip (unverified)
 *     PB2                       BOOT1, which the chip reads at a reset
 *     PC13 PC14 PC15            PC13 drives only 3 mA, the others are the slow oscillator's (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_STM32F100_BOARD_PINS_H
#define REFLUX_STM32F100_BOARD_PINS_H

#include "hal/pin.h"

#define PIN_PORTS 3u
#define FREE_A    0x19FFu /* PA0 to PA8, PA11 PA12 */
#define FREE_B    0xFFE3u /* PB0 PB1, PB5 to PB15 */
#define FREE_C    0x1FFFu /* PC0 to PC12 */
#define FREE_PINS FREE_A, FREE_B, FREE_C

/* Clock, in, out. */
#define SPI1_PINS HAL_PIN('A', 5), HAL_PIN('A', 6), HAL_PIN('A', 7)
#define SPI2_PINS HAL_PIN('B', 13), HAL_PIN('B', 14), HAL_PIN('B', 15)
/* Transmitter of USART3. */
#define WIRE1_PIN HAL_PIN('B', 10)

#endif
