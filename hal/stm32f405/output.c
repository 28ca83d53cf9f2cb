/* Outputs of the STM32F405: pins that switch, and pulse widths of the timers TIM3, TIM4, TIM5 and TIM12 (RM0090 chapters 18 and 19). A timer has
 * one frequency for all of its channels.
 *
 * A compare value has no preload, so that one that is written acts at once: hal_output_safe() need not wait for the end of a period, which
 * may be a second. The price is a pulse of another width where the value changes within one.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "hal/output.h"

#include <stddef.h>

#include "board.h"
#include "board_pins.h"
#include "hal/clock.h"
#include "pin_map.h"
#include "registers.h"

#define CHANNELS 4u

enum { TIMER_3, TIMER_4, TIMER_5, TIMER_12, TIMERS };

static const struct pwm_timer {
    uint32_t base, clock;
    uint8_t function;
} timers[TIMERS] = {
    [TIMER_3] = {0x40000400u, BIT(1), 2},
    [TIMER_4] = {0x40000800u, BIT(2), 2},
    [TIMER_5] = {0x40000C00u, BIT(3), 2},
    [TIMER_12] = {0x40001800u, BIT(6), 9},
};

static const struct pwm_pin {
    hal_pin pin;
    uint8_t timer, channel; /* channel: from 0 */
} pwm_pins[] = {
#define ROW(port, number, timer, channel) {HAL_PIN(port, number), TIMER_##timer, (channel)-1u},
    PWM_PINS(ROW)
#undef ROW
};

static struct pwm_run {
    uint32_t hz;                          /* 0: it has never run */
    const struct pwm_pin *used[CHANNELS]; /* NULL: free */
} pwm_runs[TIMERS];

enum err hal_output_open(hal_pin pin, bool low)
{
    if (!hal_pin_is_free(pin)) {
        return ERR_RANGE;
    }
    pin_make_switched(pin, low);
    return ERR_OK;
}

static const struct pwm_pin *find_pwm(hal_pin pin)
{
    for (size_t i = 0; i < sizeof(pwm_pins) / sizeof(pwm_pins[0]); i++) {
        if (pwm_pins[i].pin == pin) {
            return &pwm_pins[i];
        }
    }
    return NULL;
}

/* Whether a channel's pin is still the timer's: it may have been put to another use. */
static bool is_in_use(const struct pwm_pin *p)
{
    return p != NULL && pin_is_given(p->pin, timers[p->timer].function);
}

/* The timer may have this frequency, and the channel this pin. */
static bool is_available(const struct pwm_pin *wanted, uint32_t hz)
{
    const struct pwm_run *r = &pwm_runs[wanted->timer];
    for (unsigned channel = 0; channel < CHANNELS; channel++) {
        const struct pwm_pin *p = r->used[channel];
        if (p != wanted && is_in_use(p) && (r->hz != hz || channel == wanted->channel)) {
            return false;
        }
    }
    return true;
}

/* Timers of a bus that is divided run twice as fast as it (RM0090 7.2). */
static uint32_t timer_hz(void)
{
    return clock_apb1_hz() == hal_core_hz() ? clock_apb1_hz() : 2u * clock_apb1_hz();
}

static void set_frequency(const struct pwm_timer *t, uint32_t hz)
{
    uint32_t clock_hz = timer_hz();
    TIM_CR1(t->base) = 0;
    TIM_PSC(t->base) = pwm_divider(clock_hz, hz) - 1u;
    TIM_ARR(t->base) = pwm_counts(clock_hz, hz) - 1u;
    TIM_EGR(t->base) = TIM_EGR_UG;
    TIM_CR1(t->base) = TIM_CR1_CEN;
}

bool hal_pwm_find(hal_pin pin, uint32_t hz, struct hal_pwm_place *place)
{
    const struct pwm_pin *p = find_pwm(pin);
    if (p == NULL || !hal_pin_is_free(pin) || hz == 0 || hz > PWM_HZ_MOST) {
        return false;
    }
    *place = (struct hal_pwm_place){p->timer, p->channel};
    return true;
}

enum err hal_pwm_open(hal_pin pin, uint32_t hz, bool low)
{
    const struct pwm_pin *p = find_pwm(pin);
    struct hal_pwm_place found;
    if (!hal_pwm_find(pin, hz, &found)) {
        return ERR_RANGE;
    }
    if (!is_available(p, hz)) {
        return ERR_FULL;
    }
    const struct pwm_timer *t = &timers[p->timer];
    struct pwm_run *r = &pwm_runs[p->timer];
    unsigned shift = 8u * (p->channel % 2u), place = 4u * p->channel;
    uint32_t before = mask_raise(PRIORITY_UART);
    RCC_APB1ENR |= t->clock;
    (void)RCC_APB1ENR;
    mask_restore(before);
    TIM_CCR(t->base, p->channel) = 0;
    if (r->hz != hz) {
        r->hz = hz;
        set_frequency(t, hz);
    }
    volatile uint32_t *mode = &TIM_CCMR(t->base, p->channel / 2u);
    *mode = (*mode & ~(0xFFu << shift)) | TIM_CCMR_PWM1 << shift;
    TIM_CCER(t->base) =
        (TIM_CCER(t->base) & ~(15u << place)) | (TIM_CCER_E | (low ? TIM_CCER_P : 0)) << place;
    r->used[p->channel] = p;
    pin_give(pin, t->function, PIN_PUSH_PULL, false);
    return ERR_OK;
}

void hal_pwm_set(hal_pin pin, uint16_t part)
{
    const struct pwm_pin *p = find_pwm(pin);
    if (p == NULL || pwm_runs[p->timer].used[p->channel] != p) {
        return;
    }
    uint32_t base = timers[p->timer].base;
    TIM_CCR(base, p->channel) = pwm_compare(TIM_ARR(base) + 1u, part);
}

void hal_output_safe(void)
{
    pin_switch_all_off();
    for (unsigned i = 0; i < TIMERS; i++) {
        for (unsigned channel = 0; channel < CHANNELS; channel++) {
            if (pwm_runs[i].used[channel] != NULL) {
                TIM_CCR(timers[i].base, channel) = 0;
            }
        }
    }
}
