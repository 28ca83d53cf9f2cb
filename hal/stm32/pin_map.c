/* Pins for devices, buses and outputs: which are free, what they drive, and which are outputs that can be switched off at once. How a pin is set is
 * the port's own (pin_modes.c).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pin_map.h"

#include "board.h"
#include "board_pins.h"
#include "hal/output.h"
#include "registers.h"

/* Of each port, what GPIO_BSRR is given to switch its outputs off: a bit below 16 where off is high, above where it is low. */
static volatile uint32_t off_words[PIN_PORTS];

static uint32_t both(hal_pin pin)
{
    return BIT(PIN_NUMBER(pin)) | BIT(PIN_NUMBER(pin) + 16u);
}

/* The pin is no output of hal/output.h any more; one that is on goes off. */
static void forget_switched(hal_pin pin)
{
    uint32_t port = PIN_PORT(pin), before = mask_raise(PRIORITY_UART);
    uint32_t off = off_words[port] & both(pin);
    if (off != 0) {
        GPIO_BSRR(port) = off;
        off_words[port] &= ~off;
    }
    mask_restore(before);
}

bool hal_pin_is_free(hal_pin pin)
{
    static const uint16_t free_pins[PIN_PORTS] = {FREE_PINS};
    return pin < 16u * PIN_PORTS && (free_pins[PIN_PORT(pin)] >> PIN_NUMBER(pin) & 1u) != 0;
}

void hal_pin_use(hal_pin pin, enum hal_pin_use use)
{
    if (!hal_pin_is_free(pin)) {
        return;
    }
    if (use == HAL_PIN_OUTPUT) {
        pin_make_output(pin, PIN_PUSH_PULL, false);
        return;
    }
    forget_switched(pin);
    pin_set(pin, PIN_INPUT, 0, PIN_PUSH_PULL, use == HAL_PIN_INPUT_PULLED);
}

bool hal_pin_read(hal_pin pin)
{
    return (GPIO_IDR(PIN_PORT(pin)) >> PIN_NUMBER(pin) & 1u) != 0;
}

void hal_pin_write(hal_pin pin, bool high)
{
    GPIO_BSRR(PIN_PORT(pin)) = BIT(PIN_NUMBER(pin) + (high ? 0u : 16u));
}

void pin_give(hal_pin pin, unsigned function, enum pin_kind kind, bool pulled_up)
{
    forget_switched(pin);
    pin_set(pin, PIN_FUNCTION, function, kind, pulled_up);
}

void pin_make_analog(hal_pin pin)
{
    forget_switched(pin);
    pin_set(pin, PIN_ANALOG, 0, PIN_PUSH_PULL, false);
}

static void put_level(hal_pin pin, bool high)
{
    pin_start_clock(PIN_PORT(pin));
    hal_pin_write(pin, high);
}

void pin_make_output(hal_pin pin, enum pin_kind kind, bool high)
{
    forget_switched(pin);
    put_level(pin, high);
    pin_set(pin, PIN_OUTPUT, 0, kind, kind == PIN_OPEN_DRAIN);
}

/* The word that switches off is there before the pin drives. */
void pin_make_switched(hal_pin pin, bool off_high)
{
    forget_switched(pin);
    put_level(pin, off_high);
    uint32_t before = mask_raise(PRIORITY_UART);
    off_words[PIN_PORT(pin)] |= BIT(PIN_NUMBER(pin) + (off_high ? 0u : 16u));
    mask_restore(before);
    pin_set(pin, PIN_OUTPUT, 0, PIN_PUSH_PULL, false);
}

void pin_switch_all_off(void)
{
    for (uint32_t port = 0; port < PIN_PORTS; port++) {
        if (off_words[port] != 0) {
            GPIO_BSRR(port) = off_words[port];
        }
    }
}

void hal_output_set(hal_pin pin, bool on)
{
    uint32_t off = off_words[PIN_PORT(pin)];
    if ((off & both(pin)) != 0) {
        hal_pin_write(pin, on != ((off >> PIN_NUMBER(pin) & 1u) != 0));
    }
}
