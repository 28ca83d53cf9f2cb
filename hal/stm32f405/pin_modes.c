/* Pins of the STM32F405 in its package of 64 pins (RM0090 chapter 8), and which of them a device may have.
 *
 * Not free are, with what needs them:
 *     PA13 PA14 PA15 PB3 PB4    the debugger, whose functions they have after a reset (RM0090 8.3.1)
 *     PA9 PA10 PA2 PA3          console and plant link
 *     PB2                       BOOT1, which the chip reads at a reset
 *     PH0 PH1 PC14 PC15         oscillators
 *     PA11 PA12 PB5 PB13        the boot loader in ROM: USB and CAN2
 *     PB10 PB11 PC10 PC11       the same: USART3 in both its places
 *     PC13                      it drives only 3 mA, and must not be a source of current
 * With BOOT0 high the boot loader runs instead of the firmware. It then drives the sending pins of these ports high, and pulls the others up. An
 * output there would be on, whatever the resistor on the board says. The lists of the boot loader and of PC13 are from memory (unverified).
 * Buses may lie on these pins all the same, because no chip listens while its select pin, a free one, is held high by its resistor, and
 * because a high level is the rest of an I2C bus.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "board.h"
#include "pin_map.h"
#include "registers.h"

#define PULL_UP 1u
/* Edges of a bus: the slowest ones are for 4 MHz at most into 50 pF, of DS8626 (unverified). */
#define MEDIUM_SPEED 1u

static void put_field(volatile uint32_t *word, unsigned number, unsigned bits, uint32_t value)
{
    uint32_t shift = number * bits;
    *word = (*word & ~(((1u << bits) - 1u) << shift)) | value << shift;
}

void pin_start_clock(uint32_t port)
{
    uint32_t before = mask_raise(PRIORITY_UART);
    RCC_AHB1ENR |= RCC_AHB1ENR_GPIO(port);
    (void)RCC_AHB1ENR; /* a clock needs two cycles to arrive */
    mask_restore(before);
}

void pin_set(hal_pin pin, enum pin_mode mode, unsigned function, enum pin_kind kind, bool pulled_up)
{
    uint32_t port = PIN_PORT(pin);
    unsigned number = PIN_NUMBER(pin);
    pin_start_clock(port);
    uint32_t before = mask_raise(PRIORITY_UART);
    if (mode != PIN_OUTPUT) { /* first what it drives: then nothing that follows is an edge */
        put_field(&GPIO_MODER(port), number, 2, mode == PIN_FUNCTION ? PIN_INPUT : mode);
    }
    put_field(&GPIO_OTYPER(port), number, 1, kind == PIN_OPEN_DRAIN ? 1u : 0u);
    put_field(&GPIO_PUPDR(port), number, 2, pulled_up ? PULL_UP : 0);
    put_field(&GPIO_OSPEEDR(port), number, 2,
              mode == PIN_FUNCTION && kind == PIN_PUSH_PULL ? MEDIUM_SPEED : 0);
    put_field(&GPIO_AFR(port, number / 8u), number % 8u, 4, function);
    put_field(&GPIO_MODER(port), number, 2, mode);
    mask_restore(before);
}

bool pin_is_given(hal_pin pin, unsigned function)
{
    uint32_t port = PIN_PORT(pin), number = PIN_NUMBER(pin);
    return (RCC_AHB1ENR & RCC_AHB1ENR_GPIO(port)) != 0 &&
           (GPIO_MODER(port) >> 2u * number & 3u) == (uint32_t)PIN_FUNCTION &&
           (GPIO_AFR(port, number / 8u) >> 4u * (number % 8u) & 15u) == function;
}
