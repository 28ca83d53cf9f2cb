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
#include "pin_map.h"

#include "board.h"
#include "board_pins.h"
#include "hal/output.h"
#include "registers.h"

#define PULL_UP 1u
/* Edges of a bus: the slowest ones are for 4 MHz at most into 50 pF, of DS8626 (unverified). */
#define MEDIUM_SPEED 1u

/* Of each port, what GPIO_BSRR is given to switch its outputs off: a bit below 16 where off is high, above where it is low. */
static volatile uint32_t off_words[PIN_PORTS];

static uint32_t both(hal_pin pin)
{
    return BIT(PIN_NUMBER(pin)) | BIT(PIN_NUMBER(pin) + 16u);
}

static void put_field(volatile uint32_t *word, unsigned number, unsigned bits, uint32_t value)
{
    uint32_t shift = number * bits;
    *word = (*word & ~(((1u << bits) - 1u) << shift)) | value << shift;
}

static void start_clock_of(uint32_t port)
{
    uint32_t before = mask_raise(PRIORITY_UART);
    RCC_AHB1ENR |= RCC_AHB1ENR_GPIO(port);
    (void)RCC_AHB1ENR; /* a clock needs two cycles to arrive */
    mask_restore(before);
}

/* Sets all of a pin but its level. Interrupts that set pins of the same port are held off. */
static void set_pin(hal_pin pin, uint32_t mode, unsigned function, enum pin_kind kind,
                    uint32_t pull)
{
    uint32_t port = PIN_PORT(pin);
    unsigned number = PIN_NUMBER(pin);
    start_clock_of(port);
    uint32_t before = mask_raise(PRIORITY_UART);
    if (mode != GPIO_OUTPUT) { /* first what it drives: then nothing that follows is an edge */
        put_field(&GPIO_MODER(port), number, 2, mode == GPIO_FUNCTION ? GPIO_INPUT : mode);
    }
    put_field(&GPIO_OTYPER(port), number, 1, kind == PIN_OPEN_DRAIN ? 1u : 0u);
    put_field(&GPIO_PUPDR(port), number, 2, pull);
    put_field(&GPIO_OSPEEDR(port), number, 2,
              mode == GPIO_FUNCTION && kind == PIN_PUSH_PULL ? MEDIUM_SPEED : 0);
    put_field(&GPIO_AFR(port, number / 8u), number % 8u, 4, function);
    put_field(&GPIO_MODER(port), number, 2, mode);
    mask_restore(before);
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
    static const uint16_t free_pins[PIN_PORTS] = {FREE_A, FREE_B, FREE_C, FREE_D};
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
    set_pin(pin, GPIO_INPUT, 0, PIN_PUSH_PULL, use == HAL_PIN_INPUT_PULLED ? PULL_UP : 0);
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
    set_pin(pin, GPIO_FUNCTION, function, kind, pulled_up ? PULL_UP : 0);
}

bool pin_is_given(hal_pin pin, unsigned function)
{
    uint32_t port = PIN_PORT(pin), number = PIN_NUMBER(pin);
    return (RCC_AHB1ENR & RCC_AHB1ENR_GPIO(port)) != 0 &&
           (GPIO_MODER(port) >> 2u * number & 3u) == GPIO_FUNCTION &&
           (GPIO_AFR(port, number / 8u) >> 4u * (number % 8u) & 15u) == function;
}

void pin_make_analog(hal_pin pin)
{
    forget_switched(pin);
    set_pin(pin, GPIO_ANALOG, 0, PIN_PUSH_PULL, 0);
}

static void put_level(hal_pin pin, bool high)
{
    start_clock_of(PIN_PORT(pin));
    hal_pin_write(pin, high);
}

void pin_make_output(hal_pin pin, enum pin_kind kind, bool high)
{
    forget_switched(pin);
    put_level(pin, high);
    set_pin(pin, GPIO_OUTPUT, 0, kind, kind == PIN_OPEN_DRAIN ? PULL_UP : 0);
}

/* The word that switches off is there before the pin drives. */
void pin_make_switched(hal_pin pin, bool off_high)
{
    forget_switched(pin);
    put_level(pin, off_high);
    uint32_t before = mask_raise(PRIORITY_UART);
    off_words[PIN_PORT(pin)] |= BIT(PIN_NUMBER(pin) + (off_high ? 0u : 16u));
    mask_restore(before);
    set_pin(pin, GPIO_OUTPUT, 0, PIN_PUSH_PULL, 0);
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
