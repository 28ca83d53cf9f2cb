/* How a pin of the STM32F100 is set (RM0041 7.1 and 7.2): four bits each, so that mode and kind change at once. A pull has no register of its own: it
 * is the output's level.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "board.h"
#include "pin_map.h"
#include "registers.h"

#define ANALOG      0x0u
#define FLOATING    0x4u
#define PULLED      0x8u
#define OUTPUT      0x2u /* 2 MHz */
#define FUNCTION    0x9u /* 10 MHz */
#define DRAIN       0x4u /* of an output */
#define FUNCTION_OD 0xEu /* 2 MHz */

void pin_start_clock(uint32_t port)
{
    uint32_t before = mask_raise(PRIORITY_UART);
    RCC_APB2ENR |= RCC_APB2ENR_IO(port);
    (void)RCC_APB2ENR; /* a clock needs two cycles to arrive */
    mask_restore(before);
}

static void put_setting(hal_pin pin, uint32_t setting)
{
    uint32_t number = PIN_NUMBER(pin), shift = 4u * (number % 8u);
    volatile uint32_t *word = &GPIO_CR(PIN_PORT(pin), number / 8u);
    *word = (*word & ~(15u << shift)) | setting << shift;
}

static uint32_t setting_of(enum pin_mode mode, enum pin_kind kind, bool pulled_up)
{
    if (mode == PIN_ANALOG) {
        return ANALOG;
    }
    if (mode == PIN_OUTPUT) {
        return kind == PIN_OPEN_DRAIN ? OUTPUT | DRAIN : OUTPUT;
    }
    if (mode == PIN_INPUT || kind == PIN_LISTENS) {
        return pulled_up ? PULLED : FLOATING;
    }
    return kind == PIN_OPEN_DRAIN ? FUNCTION_OD : FUNCTION;
}

void pin_set(hal_pin pin, enum pin_mode mode, unsigned function, enum pin_kind kind, bool pulled_up)
{
    (void)function;
    uint32_t setting = setting_of(mode, kind, pulled_up);
    pin_start_clock(PIN_PORT(pin));
    uint32_t before = mask_raise(PRIORITY_UART);
    if (setting == PULLED) { /* the level that becomes the pull must not be driven */
        put_setting(pin, FLOATING);
        hal_pin_write(pin, true);
    }
    put_setting(pin, setting);
    mask_restore(before);
}
