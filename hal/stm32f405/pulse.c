/* Counts of falling edges, an interrupt each. Sixteen lines see a pin each, of one port: PA0, PB0, PC0 and PD0 share the line 0.
 *
 * A line with EDGES_MOST edges in a millisecond is muted until pulse_clock() begins the next one, because a wire that picks up noise could keep the
 * processor from everything below. That is four times as many as HAL_PULSE_HZ_MAX makes.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "hal/pulse.h"

#include "board.h"
#include "hal/clock.h"
#include "io_interrupts.h"
#include "pin_map.h"
#include "registers.h"

#define LINES      16u
#define EDGES_MOST 8u /* in a millisecond */
#define LINES_9_5  0x03E0u
#define LINES_OVER 0xFC00u /* 10 to 15 */

static struct pulse_line {
    bool open, seen; /* seen: there was an edge */
    hal_pin pin;
    uint8_t dead_ms, lately; /* lately: edges in this millisecond */
    volatile uint32_t edges;
    uint32_t last_ms, last_cycles; /* of the edge before, counted or not */
} lines[LINES];

/* Lines with edges in this millisecond, and those of them that are muted: a bit each. */
static uint32_t lively, muted;

static uint32_t irq_of(unsigned line)
{
    return line < 5u ? EXTI0_IRQ + line : line < 10u ? EXTI9_5_IRQ : EXTI15_10_IRQ;
}

enum err hal_pulse_open(hal_pin pin)
{
    if (!hal_pin_is_free(pin)) {
        return ERR_RANGE;
    }
    unsigned line = PIN_NUMBER(pin), shift = 4u * (line % 4u);
    struct pulse_line *p = &lines[line];
    if (p->open && p->pin != pin) {
        return ERR_FULL;
    }
    hal_pin_use(pin, HAL_PIN_INPUT_PULLED);
    uint32_t before = io_hold();
    RCC_APB2ENR |= RCC_APB2ENR_SYSCFG;
    (void)RCC_APB2ENR;
    EXTI_IMR &= ~BIT(line);
    muted &= ~BIT(line);
    SYSCFG_EXTICR(line / 4u) = (SYSCFG_EXTICR(line / 4u) & ~(15u << shift)) | PIN_PORT(pin)
                                                                                  << shift;
    EXTI_FTSR |= BIT(line);
    EXTI_PR = BIT(line);
    *p = (struct pulse_line){.open = true, .pin = pin};
    EXTI_IMR |= BIT(line);
    io_release(before);
    io_interrupt_on(irq_of(line));
    return ERR_OK;
}

uint32_t hal_pulse_count(hal_pin pin)
{
    const struct pulse_line *p = &lines[PIN_NUMBER(pin)];
    return p->open && p->pin == pin ? p->edges : 0;
}

void hal_pulse_set_dead_time(hal_pin pin, uint8_t dead_ms)
{
    struct pulse_line *p = &lines[PIN_NUMBER(pin)];
    if (p->open && p->pin == pin) {
        p->dead_ms = dead_ms;
    }
}

/* By the milliseconds where they are enough: the counter of cycles comes round in 25 s. */
static bool bounces(const struct pulse_line *p, uint32_t ms, uint32_t cycles)
{
    if (!p->seen || p->dead_ms == 0 || ms - p->last_ms > p->dead_ms + 1u) {
        return false;
    }
    return cycles - p->last_cycles < hal_core_hz() / 1000u * p->dead_ms;
}

static void serve_edges(uint32_t group)
{
    uint32_t pending = EXTI_PR & group & EXTI_IMR, ms = (uint32_t)hal_clock_ms(),
             cycles = hal_cycles();
    EXTI_PR = pending;
    lively |= pending;
    for (; pending != 0; pending &= pending - 1u) {
        struct pulse_line *p = &lines[__builtin_ctz(pending)];
        p->lately++;
        if (p->lately >= EDGES_MOST) {
            muted |= pending & -pending;
            EXTI_IMR &= ~muted;
        }
        if (!bounces(p, ms, cycles)) {
            p->edges = p->edges + 1u;
        }
        p->seen = true;
        p->last_ms = ms;
        p->last_cycles = cycles;
    }
}

void pulse_clock(void)
{
    uint32_t before = io_hold();
    for (; lively != 0; lively &= lively - 1u) {
        lines[__builtin_ctz(lively)].lately = 0;
    }
    if (muted != 0) {
        EXTI_PR = muted;
        EXTI_IMR |= muted;
        muted = 0;
    }
    io_release(before);
}

void interrupt_exti0(void)
{
    serve_edges(BIT(0));
}

void interrupt_exti1(void)
{
    serve_edges(BIT(1));
}

void interrupt_exti2(void)
{
    serve_edges(BIT(2));
}

void interrupt_exti3(void)
{
    serve_edges(BIT(3));
}

void interrupt_exti4(void)
{
    serve_edges(BIT(4));
}

void interrupt_exti9_5(void)
{
    serve_edges(LINES_9_5);
}

void interrupt_exti15_10(void)
{
    serve_edges(LINES_OVER);
}
